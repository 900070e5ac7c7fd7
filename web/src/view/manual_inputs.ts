// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Controls of the drive: the joystick, and what the sensors feel. */
import { sensorInput } from "../catalogue";
import { el, panel } from "../dom";
import type { Frame, InputDescription, Ready } from "../protocol";
import { holdButton, inputControl } from "./control";
import { Joystick } from "./joystick";
import type { Actions, View } from "./view";

function label(name: string): string {
  const [kind, port, quantity] = name.split(".");
  return `${port}: ${quantity ?? kind}`;
}

/** The range that a hand reaches, of all that the input takes. */
function reachableRange(input: InputDescription): InputDescription {
  const [lowest, highest] = sensorInput(input.name)?.manual_range ?? [];
  return { ...input, lowest: lowest ?? input.lowest, highest: highest ?? input.highest };
}

export class ManualInputs implements View {
  readonly element: HTMLElement;
  readonly joystick: Joystick;
  private readonly sensors = el("div", { class: "controls" });

  constructor(private readonly actions: Actions) {
    this.joystick = new Joystick(actions);
    const hint = el("span", { class: "note keys-only" }, "keys a s d t, gamepad");
    this.element = panel("hand", "By hand", [hint], this.joystick.element, this.sensors);
  }

  ready(ready: Ready): void {
    this.joystick.ready(ready);
    const sensed = ready.inputs.filter((input) => sensorInput(input.name));
    this.sensors.replaceChildren(...sensed.map((input) => this.control(input)));
    this.element.hidden = sensed.length === 0 && this.joystick.element.hidden;
  }

  frame(frame: Frame): void {
    this.joystick.frame(frame);
  }

  private control(input: InputDescription): HTMLElement {
    const set = (value: number) => this.actions.input(input.name, value);
    if (input.name.startsWith("touch.")) {
      const attributes = { "data-input": input.name, class: "touch" };
      const title = `Press touch sensor ${input.name.split(".")[1]}`;
      return holdButton(title, attributes, (down) => set(down ? 1 : 0));
    }
    return inputControl(reachableRange(input), label(input.name), set);
  }
}
