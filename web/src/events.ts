// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Events of the trace: 24 packed bytes each; the numbers are those of docs/reference/trace.md. */

export const EVENT_BYTES = 24;
/** Subject of `threadRunning` while none runs. */
export const IDLE = 0xffff_ffff;

export const Kind = {
  threadRunning: 1,
  threadState: 2,
  release: 3,
  completion: 4,
  interruptEntered: 5,
  interruptLeft: 6,
  displayChanged: 7,
  motorCommand: 8,
  input: 9,
  processorStopped: 10,
  processorResumed: 11,
  powerOff: 12,
  click: 13,
} as const;

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

/** Names of the interrupt sources (AT91SAM7S256 datasheet, table of peripheral identifiers). */
const SOURCES: Record<number, string> = {
  0: "FIQ",
  1: "system",
  2: "PIOA",
  4: "ADC",
  5: "SPI",
  6: "USART 0",
  7: "USART 1",
  8: "SSC",
  9: "TWI",
  10: "PWMC",
  11: "UDP",
  12: "TC0",
  13: "TC1",
  14: "TC2",
  30: "IRQ0",
  31: "IRQ1",
};

export function sourceName(source: number): string {
  return SOURCES[source] ?? `source ${source}`;
}
