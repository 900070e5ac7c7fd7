// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Time base: cycles of the master clock, 336 384 000 / 7 Hz. */
const NUMERATOR_PER_MS = 336_384;
const DENOMINATOR = 7;

/** Cycles per second. */
export const CLOCK_HZ = (NUMERATOR_PER_MS * 1000) / DENOMINATOR;

/** Whole cycles of a whole number of milliseconds, rounded up. */
export function cyclesOfMs(ms: number): number {
  return Math.floor((ms * NUMERATOR_PER_MS + DENOMINATOR - 1) / DENOMINATOR);
}

/** The first whole millisecond at or after a cycle. */
export function msAtOrAfter(cycles: number): number {
  let ms = Math.floor((cycles * DENOMINATOR) / NUMERATOR_PER_MS);
  while (cyclesOfMs(ms) < cycles) ms += 1;
  return ms;
}

export function seconds(cycles: number): number {
  return cycles / CLOCK_HZ;
}
