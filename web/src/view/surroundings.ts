// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Battery and faults. */
import { el, panel } from "../dom";
import type { Frame, InputDescription, Ready } from "../protocol";
import { inputControl } from "./control";
import type { Actions, View } from "./view";

const LABELS: Record<string, string> = {
  "battery.voltage": "battery",
  "fault.coprocessor_checksum": "checksums to corrupt",
  "fault.coprocessor_torn_words": "answers with torn words",
  "fault.coprocessor_refuses": "co-processor refuses frames",
  "fault.twi_stuck": "co-processor bus stuck",
};

function label(name: string): string {
  const short = /^fault\.(\d)\.digital_(\d)_low$/.exec(name);
  return LABELS[name] ?? (short ? `port ${short[1]}: line ${short[2]} shorted` : name);
}

function shown(input: InputDescription): InputDescription {
  return input.highest > 1000 ? { ...input, highest: 20 } : input;
}

export class Surroundings implements View {
  readonly element: HTMLElement;
  private readonly controls = el("div", { class: "controls" });
  private readonly voltage = el("output", { id: "battery-voltage" });

  constructor(private readonly actions: Actions) {
    const now = el("span", { class: "note" }, "terminals: ", this.voltage);
    this.element = panel("surroundings", "Battery and faults", [now], this.controls);
  }

  ready({ inputs }: Ready): void {
    const mine = inputs.filter((i) => i.name === "battery.voltage" || i.name.startsWith("fault."));
    const set = (name: string) => (value: number) => this.actions.input(name, value);
    this.controls.replaceChildren(
      ...mine.map((input) => inputControl(shown(input), label(input.name), set(input.name))),
    );
  }

  frame({ signals }: Frame): void {
    const voltage = signals["battery.voltage"];
    this.voltage.value = voltage == null ? "–" : `${voltage.toFixed(2)} V`;
  }
}
