// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { CLOCK_HZ, cyclesOfMs, msAtOrAfter } from "../src/clock";

it("has a second of the crystal of 18.432 MHz times 73 by 14, halved", () => {
  expect(CLOCK_HZ).toBeCloseTo((18_432_000 * 73) / 14 / 2, 6);
});

describe("milliseconds", () => {
  it("are rounded up to whole cycles, as on the host", () => {
    for (const ms of [0, 1, 7, 999, 20_000, 86_400_000]) {
      const exact = (BigInt(ms) * 336_384n + 6n) / 7n;
      expect(cyclesOfMs(ms)).toBe(Number(exact));
    }
  });

  it("come back from cycles as the first whole one", () => {
    for (const ms of [0, 1, 7, 12_345, 86_400_000]) {
      expect(msAtOrAfter(cyclesOfMs(ms))).toBe(ms);
      expect(msAtOrAfter(cyclesOfMs(ms) + 1)).toBe(ms + 1);
    }
  });
});
