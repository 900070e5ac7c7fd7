// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Set-points, and gains and limits of the controller, changed while it runs. */
import { cyclesOfMs } from "../clock";
import { el, panel } from "../dom";
import type { Frame, Ready } from "../protocol";
import type { TimedInput, Tunable } from "../session";
import type { Actions, View } from "../view/view";

/** When a run begins again with other values they are written here: start-up is over then. */
export const WRITTEN_MS = 50;
const STEPS = 400;

/** The name of the input that writes the variable. */
const inputOf = ({ path }: Tunable) => `variable.${path}`;

/** `functional_P.Kp` is `Kp` to people. */
const nameOf = ({ name, path }: Tunable) => name ?? path.split(".").pop() ?? path;

export class Tuning implements View {
  readonly element: HTMLElement;
  private readonly list = el("div", { class: "tunables" });
  private tunables: Tunable[] = [];
  /** What somebody set, by path. */
  private wanted = new Map<string, number>();
  private keep = false;
  private shown = new Map<string, HTMLOutputElement>();

  constructor(
    private readonly actions: Actions,
    again: (inputs: TimedInput[]) => void,
  ) {
    const button = (label: string, title: string, id: string, click: () => void) =>
      el("button", { type: "button", title, id, click }, label);
    const title = `Reset, and write these values at ${WRITTEN_MS} ms`;
    const rerun = button("Run again with these", title, "tuning-again", () => {
      this.keep = true;
      again(this.inputs());
    });
    const back = button("As designed", "Write the designed values", "tuning-designed", () => {
      for (const tunable of this.tunables) this.set(tunable, tunable.value);
      this.wanted.clear();
      this.build();
    });
    this.element = panel("tuning", "Gains", [rerun, back], this.list);
  }

  ready({ session }: Ready): void {
    if (!this.keep) this.wanted.clear();
    this.keep = false;
    this.tunables = session.tunables ?? [];
    this.element.hidden = this.tunables.length === 0;
    this.build();
  }

  frame({ variables }: Frame): void {
    for (const { path, unit } of this.tunables) {
      const [value, output] = [variables[path], this.shown.get(path)];
      if (output) output.value = value === undefined ? "–" : `${precise(value)} ${unit}`;
    }
  }

  /** What was set, as inputs of a run from its beginning. */
  private inputs(): TimedInput[] {
    const set = this.tunables.filter(({ path }) => this.wanted.has(path));
    return set.map((tunable) => ({
      at_cycles: cyclesOfMs(WRITTEN_MS),
      name: inputOf(tunable),
      value: this.wanted.get(tunable.path) ?? tunable.value,
    }));
  }

  private set(tunable: Tunable, value: number): void {
    this.wanted.set(tunable.path, value);
    this.actions.input(inputOf(tunable), value);
  }

  private build(): void {
    this.shown.clear();
    this.list.replaceChildren(...this.tunables.map((tunable) => this.control(tunable)));
  }

  /** Slider, number and the value in memory, which the program may have set itself. */
  private control(tunable: Tunable): HTMLElement {
    const { path, unit, lowest, highest, whole, description } = tunable;
    const start = this.wanted.get(path) ?? tunable.value;
    const step = whole ? 1 : Number(((highest - lowest) / STEPS).toPrecision(1));
    const label = `${nameOf(tunable)} (${unit})`;
    const limits = { min: lowest, max: highest };
    const range = el("input", {
      ...{ type: "range", ...limits, step, value: start, "data-tunable": path },
      "aria-label": `${label}: ${description}`,
      input: () => {
        number.value = range.value;
        this.set(tunable, range.valueAsNumber);
      },
    });
    const number = el("input", {
      ...{ type: "number", step: "any", value: Number(start.toPrecision(6)) },
      "aria-label": `${label}, as a number`,
      change: () => {
        const value = number.valueAsNumber;
        if (!Number.isFinite(value) || (whole && !Number.isInteger(value))) return;
        range.value = String(value);
        this.set(tunable, value);
      },
    });
    const output = el("output", { "aria-label": `${nameOf(tunable)} in the program` }, "–");
    this.shown.set(path, output);
    const name = el("span", {}, el("b", {}, nameOf(tunable)), ` ${description}`);
    return el("div", { class: "tunable" }, name, range, number, output);
  }
}

const precise = (value: number) => String(Number(value.toPrecision(4)));
