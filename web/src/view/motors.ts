// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Three motors: the hub turns, figures beside it, a load to turn against. */
import { el, panel, svg } from "../dom";
import type { Frame, Ready } from "../protocol";
import { inputControl } from "./control";
import type { Actions, View } from "./view";

const DEGREES = 180 / Math.PI;
const SPOKES = [0, 60, 120, 180, 240, 300];

class Motor {
  readonly element: HTMLElement;
  private readonly hub: SVGGElement;
  private readonly figures = el("dl", {});
  private readonly cells: Record<string, HTMLElement> = {};

  constructor(readonly port: string) {
    const spokes = SPOKES.map((angle) =>
      svg("line", { x1: 0, y1: -6, x2: 0, y2: -34, transform: `rotate(${angle})` }),
    );
    const mark = svg("circle", { cx: 0, cy: -26, r: 5, class: "mark" });
    this.hub = svg("g", { class: "hub" }, svg("circle", { r: 36 }), ...spokes, mark);
    const label = `Motor ${port}`;
    const picture = svg("svg", { viewBox: "-40 -40 80 80", role: "img", "aria-label": label });
    picture.append(this.hub);
    for (const name of ["angle", "speed", "duty", "current"]) {
      this.cells[name] = el("dd", { "data-figure": `${port}.${name}` }, "–");
      this.figures.append(el("dt", {}, name), this.cells[name]);
    }
    this.element = el("div", { class: "motor" }, el("h3", {}, label), picture, this.figures);
  }

  show(signals: Frame["signals"]): void {
    const read = (name: string) => signals[`motor.${this.port}.${name}`] ?? 0;
    // The hub is seen from its free side: a growing angle turns it counter-clockwise.
    this.hub.setAttribute("transform", `rotate(${(-read("angle") * DEGREES) % 360})`);
    this.set("angle", `${(read("angle") * DEGREES).toFixed(0)}°`);
    this.set("speed", `${(read("angular_velocity") * DEGREES).toFixed(0)} °/s`);
    this.set("duty", `${(read("duty") * 100).toFixed(0)} %`);
    this.set("current", `${(read("current") * 1000).toFixed(0)} mA`);
  }

  private set(name: string, text: string): void {
    const cell = this.cells[name];
    if (cell && cell.textContent !== text) cell.textContent = text;
  }
}

export class Motors implements View {
  readonly element: HTMLElement;
  private readonly row = el("div", { class: "motors" });
  private motors: Motor[] = [];

  constructor(private readonly actions: Actions) {
    this.element = panel("motors", "Motors", [], this.row);
  }

  ready({ channels, inputs }: Ready): void {
    const ports = ["A", "B", "C"].filter((p) => channels.signals.includes(`motor.${p}.angle`));
    this.motors = ports.map((port) => new Motor(port));
    for (const motor of this.motors) {
      const load = inputs.find((input) => input.name === `motor.${motor.port}.load_torque`);
      if (!load) continue;
      // A stall takes about 0.4 N m: the slider shows what matters.
      const range = { ...load, lowest: -0.4, highest: 0.4 };
      const set = (value: number) => this.actions.input(load.name, value);
      motor.element.append(inputControl(range, "load", set));
    }
    this.row.replaceChildren(...this.motors.map((motor) => motor.element));
  }

  frame({ signals }: Frame): void {
    for (const motor of this.motors) motor.show(signals);
  }
}
