// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// @vitest-environment jsdom
/** Each sensor of the catalogue on the page. */
import { expect, it } from "vitest";
import catalogue from "../../catalogue/sensors.json";
import type { InputDescription } from "../src/protocol";
import { app, get, READY } from "./page";

interface CatalogueInput {
  name: string;
  range: number[];
  manual_range?: number[];
  start?: number;
  whole?: boolean;
  unit: string;
}

const KINDS = Object.entries(catalogue).map(([kind, { inputs }]) => ({
  kind,
  inputs: inputs as CatalogueInput[],
}));

/** The input at a port, as the core describes it. */
function described({ name, range, whole, unit }: CatalogueInput, port: number): InputDescription {
  const [lowest = NaN, highest = NaN] = range;
  return { name: name.replace("{port}", `${port}`), lowest, highest, whole: !!whole, unit };
}

/** The value that a slider, a switch or a button shows. */
function shown(control: HTMLElement): number {
  if (!(control instanceof HTMLInputElement))
    return Number(control.getAttribute("aria-pressed") === "true");
  return control.type === "checkbox" ? Number(control.checked) : control.valueAsNumber;
}

it("are offered at each port", () => {
  for (const port of [1, 2, 3, 4]) {
    const choice = get<HTMLSelectElement>(`[aria-label="Sensor at port ${port}"]`);
    const offered = [...choice.options].map(({ value }) => value);
    expect(offered).toEqual(["nothing", ...KINDS.map(({ kind }) => kind)]);
  }
});

it.each(KINDS)("of kind $kind have controls that start like the device", ({ inputs }) => {
  app.receive({ ...READY, inputs: inputs.map((input) => described(input, 2)) });
  for (const input of inputs) {
    const { name, unit } = described(input, 2);
    const control = get<HTMLInputElement>(`[data-input="${name}"]`);
    const [lowest = -Infinity, highest = Infinity] = input.manual_range ?? input.range;
    const start = Math.min(Math.max(input.start ?? 0, lowest), highest);
    expect(shown(control), name).toBe(start);
    if (control.type !== "range") continue;
    // A browser moves a slider to the next step.
    const steps = (start - Number(control.min)) / Number(control.step);
    expect(steps, name).toBeCloseTo(Math.round(steps));
    const [value, of] = control.parentElement?.querySelector("output")?.value.split(" ") ?? [];
    expect([value, of], name).toEqual([expect.stringMatching(/^\d+(\.\d+)?$/), unit]);
    expect(Number(value), name).toBe(start);
  }
});
