// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Packed events for tests. */
import { EVENT_BYTES } from "../src/events";

export type Plain = [at: number, kind: number, subject?: number, value?: number];

export function pack(...events: Plain[]): Uint8Array {
  const bytes = new Uint8Array(events.length * EVENT_BYTES);
  const view = new DataView(bytes.buffer);
  events.forEach(([at, kind, subject = 0, value = 0], index) => {
    view.setBigUint64(index * EVENT_BYTES, BigInt(at), true);
    view.setUint32(index * EVENT_BYTES + 8, kind, true);
    view.setUint32(index * EVENT_BYTES + 12, subject, true);
    view.setBigInt64(index * EVENT_BYTES + 16, BigInt(value), true);
  });
  return bytes;
}
