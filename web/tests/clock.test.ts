// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { cyclesOfMs, msAtOrAfter } from "../src/clock";

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
