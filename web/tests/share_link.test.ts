// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { cyclesOfMs } from "../src/clock";
import { PLAIN_SESSION, type Run } from "../src/session";
import { decodeShared, encodeShared, runOf } from "../src/share_link";

describe("a short link", () => {
  const identity = { image: "a".repeat(64), environment: "b".repeat(64) };
  const run: Run = {
    ...PLAIN_SESSION,
    inputs: [{ at_cycles: 7, name: "variable.functional_P.Kp", value: 0.7 }],
    ...{ until_ms: 20, until_cycles: cyclesOfMs(20), digest: "00ff" },
  };

  it("gives back the run of the program beside the page", async () => {
    const link = await encodeShared(run, identity, PLAIN_SESSION);
    const shared = await decodeShared(link);
    expect(shared && runOf(shared, identity, PLAIN_SESSION)).toEqual(run);
  });

  it("is refused by another program or environment, and when it is cut off", async () => {
    const link = await encodeShared(run, identity, PLAIN_SESSION);
    const shared = await decodeShared(link);
    if (!shared) throw new Error("no link");
    const other = { ...identity, image: "c".repeat(64) };
    expect(() => runOf(shared, other, PLAIN_SESSION)).toThrow(/another program: brick/);
    const elsewhere = { ...identity, environment: "d".repeat(64) };
    expect(() => runOf(shared, elsewhere, PLAIN_SESSION)).toThrow(/another environment/);
    await expect(decodeShared(link.slice(0, 40))).rejects.toThrow(/cut off/);
    expect(await decodeShared("#run=x")).toBe(null);
  });
});
