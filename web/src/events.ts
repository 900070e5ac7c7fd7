// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Events of the trace: 24 packed bytes each; the numbers are those of docs/reference/trace.md. */
import trace from "../../catalogue/trace.json";

export const EVENT_BYTES = 24;
/** Subject of `thread_running` while none runs. */
export const IDLE = 0xffff_ffff;

/** The number of each kind of event. */
export const Kind = trace.events;

export interface TraceEvent {
  at: number;
  kind: number;
  subject: number;
  /** Cycles and other small numbers; the bits of inputs are not used here. */
  value: number;
}

/** The events in a piece of packed trace. */
export function* unpack(bytes: Uint8Array): Generator<TraceEvent> {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  for (let at = 0; at + EVENT_BYTES <= bytes.byteLength; at += EVENT_BYTES) {
    yield {
      at: Number(view.getBigUint64(at, true)),
      kind: view.getUint32(at + 8, true),
      subject: view.getUint32(at + 12, true),
      value: Number(view.getBigInt64(at + 16, true)),
    };
  }
}

const SOURCES: Record<string, string> = trace.interrupt_sources;

/** The name of an interrupt source in the chip's manual. */
export function sourceName(source: number): string {
  return SOURCES[source] ?? `source ${source}`;
}
