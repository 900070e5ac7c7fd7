// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Four sensor ports: the sensor at each, and its cable. */
import { SENSOR_KINDS } from "../catalogue";
import { el, panel } from "../dom";
import type { InputDescription, Ready } from "../protocol";
import { inputControl } from "./control";
import type { Actions, View } from "./view";

const KINDS = ["nothing", ...SENSOR_KINDS];
const PORTS = ["1", "2", "3", "4"];

export class Ports implements View {
  readonly element: HTMLElement;
  private readonly row = el("div", { class: "ports" });

  constructor(private readonly actions: Actions) {
    const note = el("span", { class: "note" }, "a change restarts the run");
    this.element = panel("ports", "Sensor ports", [note], this.row);
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
    const cable = inputs.filter(({ name }) => name === `sensor.${port}.plugged`);
    const set = (name: string) => (value: number) => this.actions.input(name, value);
    const switches = cable.map((input) => inputControl(input, "plugged", set(input.name)));
    return el("fieldset", {}, el("legend", {}, `Port ${port}`), choice, ...switches);
  }
}
