// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Four sensor ports: what is plugged in, and what it feels. */
import { el, panel } from "../dom";
import type { InputDescription, Ready } from "../protocol";
import { holdButton, inputControl } from "./control";
import type { Actions, View } from "./view";

const KINDS = ["nothing", "touch", "light", "sound", "ultrasonic", "color", "gyro", "analogue"];
const PORTS = ["1", "2", "3", "4"];

function belongs(input: InputDescription, port: string): boolean {
  return input.name.split(".")[1] === port && !input.name.startsWith("fault.");
}

function label(name: string): string {
  const [kind, , quantity] = name.split(".");
  if (name.endsWith(".plugged")) return "cable plugged";
  return quantity ?? kind ?? name;
}

/** What can happen to a sensor by hand, of all that the input takes. */
function byHand(input: InputDescription): InputDescription {
  if (input.name.startsWith("distance.")) return { ...input, highest: 2.6 };
  if (input.name.startsWith("gyro.")) return { ...input, lowest: -10, highest: 10 };
  return input;
}

export class Ports implements View {
  readonly element: HTMLElement;
  private readonly row = el("div", { class: "ports" });

  constructor(private readonly actions: Actions) {
    const note = el("p", { class: "note" }, "Another sensor begins the run again.");
    this.element = panel("ports", "Sensor ports", this.row, note);
  }

  ready({ session, inputs }: Ready): void {
    const sensors = session.configuration.sensors ?? {};
    this.row.replaceChildren(...PORTS.map((port) => this.port(port, sensors, inputs)));
  }

  frame(): void {}

  private port(
    port: string,
    sensors: Record<string, { kind: string }>,
    inputs: InputDescription[],
  ): HTMLElement {
    const plugged = sensors[port]?.kind ?? "nothing";
    const kinds = KINDS.includes(plugged) ? KINDS : [...KINDS, plugged];
    const options = kinds.map((kind) =>
      el("option", { value: kind, selected: kind === plugged }, kind),
    );
    const choice = el("select", { "aria-label": `Sensor at port ${port}` }, ...options);
    choice.addEventListener("change", () => {
      const changed = { ...sensors };
      if (choice.value === "nothing") delete changed[port];
      else changed[port] = { kind: choice.value };
      this.actions.sensors(changed);
    });
    const controls = inputs
      .filter((input) => belongs(input, port))
      .map((input) => this.control(input));
    return el("fieldset", {}, el("legend", {}, `Port ${port}`), choice, ...controls);
  }

  private control(input: InputDescription): HTMLElement {
    const set = (value: number) => this.actions.input(input.name, value);
    if (input.name.startsWith("touch.")) {
      const attributes = { "data-input": input.name, class: "touch" };
      return holdButton("press", attributes, (down) => set(down ? 1 : 0));
    }
    return inputControl(byHand(input), label(input.name), set);
  }
}
