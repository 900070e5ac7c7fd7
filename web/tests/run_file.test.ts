// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { withoutDebugInformation } from "../src/elf";
import { decodeRun, encodeRun, RunFileError } from "../src/run_file";
import { PLAIN_SESSION, stimulusCsv, type Run } from "../src/session";

const RUN: Run = {
  ...PLAIN_SESSION,
  inputs: [{ at_cycles: 48_055, name: "touch.1", value: 1 }],
  until_ms: 20,
  until_cycles: 961_098,
  digest: "00ff",
};
const ELF = Uint8Array.from({ length: 70_000 }, (_, at) => at % 251);

function changed(edit: (value: Record<string, unknown>) => void): string {
  const value = JSON.parse(encodeRun({ run: RUN, elf: ELF })) as Record<string, unknown>;
  edit(value);
  return JSON.stringify(value);
}

describe("a run file", () => {
  it("gives back the run and every byte of the image", () => {
    const { run, elf } = decodeRun(encodeRun({ run: RUN, elf: ELF }));
    expect(run).toEqual(RUN);
    expect(Buffer.from(elf).equals(ELF)).toBe(true);
  });

  it.each([
    ["{", "no JSON"],
    ["null", '"format"'],
    ["[]", '"format"'],
    [changed((v) => (v["version"] = 2)), "version 2"],
    [changed((v) => delete v["inputs"]), '"inputs"'],
    [changed((v) => (v["until_cycles"] = 1.5)), '"until_cycles"'],
    [changed((v) => (v["elf"] = "*")), "base64"],
    [changed((v) => delete v["elf"]), '"elf"'],
  ])("that is wrong says where: %.20s", (text, named) => {
    expect(() => decodeRun(text)).toThrow(RunFileError);
    expect(() => decodeRun(text)).toThrow(named);
  });
});

describe("a stimulus", () => {
  it("has a column per input and exact instants", () => {
    const inputs = [
      { at_cycles: 5, name: "touch.1", value: 1 },
      { at_cycles: 9, name: "battery.voltage", value: 7.25 },
    ];
    expect(stimulusCsv(inputs)).toBe("at_cycles,battery.voltage,touch.1\n5,,1\n9,7.25,\n");
  });
});

describe("debug information", () => {
  it("of what is no ELF file stays as it is", () => {
    expect(Buffer.from(withoutDebugInformation(ELF)).equals(ELF)).toBe(true);
    const cut = Uint8Array.from([0x7f, 0x45, 0x4c, 0x46, 1]);
    expect(withoutDebugInformation(cut)).toEqual(cut);
    const wild = new Uint8Array(52).fill(0xff);
    wild.set([0x7f, 0x45, 0x4c, 0x46, 1]);
    expect(withoutDebugInformation(wild)).toEqual(wild);
  });
});
