// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** A control for an input of the brick, by its range. */
import { sensorInput } from "../catalogue";
import { el } from "../dom";
import type { InputDescription } from "../protocol";

/** Where an input is before anybody sets it. */
function initial(input: InputDescription): number {
  const start = input.name === "battery.voltage" ? 8 : sensorInput(input.name)?.start;
  return Math.min(Math.max(start ?? 0, input.lowest), input.highest);
}

/** A button that is down while it is held; toggles by `aria-pressed`. */
export function holdButton(
  label: string,
  attributes: Record<string, string>,
  set: (down: boolean) => void,
): HTMLButtonElement {
  const button = el("button", { type: "button", "aria-pressed": "false", ...attributes }, label);
  let down = false;
  const change = (wanted: boolean) => {
    if (wanted === down) return;
    down = wanted;
    button.setAttribute("aria-pressed", String(down));
    set(down);
  };
  button.addEventListener("pointerdown", (event) => {
    button.setPointerCapture?.(event.pointerId);
    change(true);
  });
  for (const end of ["pointerup", "pointercancel", "blur"]) {
    button.addEventListener(end, () => change(false));
  }
  button.addEventListener("keydown", (event) => {
    if (event.key === " " || event.key === "Enter") {
      event.preventDefault();
      change(true);
    }
  });
  button.addEventListener("keyup", (event) => {
    if (event.key === " " || event.key === "Enter") change(false);
  });
  return button;
}

/** A switch for 0 and 1. */
function toggle(input: InputDescription, label: string, set: (value: number) => void) {
  const box = el("input", {
    type: "checkbox",
    "data-input": input.name,
    change: () => set(box.checked ? 1 : 0),
  });
  box.checked = input.name.endsWith(".plugged");
  return el("label", { class: "switch" }, box, label);
}

/** A power of ten that divides the range into 200 to 2000 steps. */
function sliderStep({ lowest, highest }: InputDescription): number {
  return Number((10 ** Math.floor(Math.log10((highest - lowest) / 200))).toPrecision(1));
}

/** A slider with its value beside it. */
function slider(input: InputDescription, label: string, set: (value: number) => void) {
  const step = input.whole ? 1 : sliderStep(input);
  const shown = el("output", {});
  const show = (value: number) => {
    const long = input.whole || Math.abs(value) >= 1000;
    shown.value = `${long ? Math.round(value) : value.toPrecision(3)} ${input.unit}`;
  };
  const range = el("input", {
    type: "range",
    min: input.lowest,
    max: input.highest,
    step,
    value: initial(input),
    "data-input": input.name,
    input: () => {
      show(range.valueAsNumber);
      set(range.valueAsNumber);
    },
  });
  show(initial(input));
  return el("label", { class: "slider" }, el("span", {}, label), range, shown);
}

/** The control that fits the input. */
export function inputControl(
  input: InputDescription,
  label: string,
  set: (value: number) => void,
): HTMLElement {
  const binary = input.whole && input.lowest === 0 && input.highest === 1;
  return binary ? toggle(input, label, set) : slider(input, label, set);
}
