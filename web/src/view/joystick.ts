// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The joystick: a motor held by hand, turned by slider, keyboard (A and D) or gamepad. */
import { el } from "../dom";
import type { Frame, Ready } from "../protocol";
import type { TimedInput } from "../session";
import type { Actions, View } from "./view";

const DEGREES = 180 / Math.PI;
const LIMIT_DEGREES = 90;
const KEY_DEGREES = 5;
/** A stick at rest is not quite at 0. */
const DEAD_ZONE = 0.1;

export class Joystick implements View {
  readonly element: HTMLElement;
  private name: string | null = null;
  private scheduled: TimedInput[] = [];
  private touch: string | null = null;
  private readonly shown = el("output", {}, "0°");
  private readonly range = el("input", {
    type: "range",
    min: -LIMIT_DEGREES,
    max: LIMIT_DEGREES,
    step: 1,
    value: 0,
    "aria-label": "Joystick angle in degrees, positive to the left",
    input: () => this.turnTo(this.range.valueAsNumber),
  });
  private pad = { axis: 0, pressed: false };

  constructor(private readonly actions: Actions) {
    const centre = el("button", { type: "button", click: () => this.turnTo(0) }, "centre");
    this.element = el("div", { id: "joystick" }, this.range, this.shown, centre);
  }

  ready({ inputs, session }: Ready): void {
    this.name = inputs.find((i) => i.name.endsWith(".hand_angle"))?.name ?? null;
    this.touch = inputs.find((i) => i.name.startsWith("touch."))?.name ?? null;
    this.element.hidden = this.name === null;
    this.scheduled = session.inputs.filter((input) => input.name === this.name);
    this.scheduled.sort((a, b) => a.at_cycles - b.at_cycles);
    this.show(0);
  }

  /** The slider follows what the scenario or the saved run does. */
  frame({ cycles }: Frame): void {
    while (this.scheduled[0] && this.scheduled[0].at_cycles <= cycles) {
      this.show((this.scheduled.shift()?.value ?? 0) * DEGREES);
    }
    this.poll();
  }

  turnTo(degrees: number): void {
    if (!this.name) return;
    const angle = Math.max(-LIMIT_DEGREES, Math.min(LIMIT_DEGREES, degrees));
    this.show(angle);
    this.actions.input(this.name, angle / DEGREES);
  }

  private show(degrees: number): void {
    this.range.value = degrees.toFixed(0);
    this.shown.value = `${degrees.toFixed(0)}°`;
  }

  /** A key of the page; true when it was one of the joystick's. */
  key(key: string, down: boolean): boolean {
    const angle = this.range.valueAsNumber;
    const turns: Record<string, number> = { a: angle + KEY_DEGREES, d: angle - KEY_DEGREES, s: 0 };
    const wanted = turns[key];
    if (wanted !== undefined) {
      if (down) this.turnTo(wanted);
      return true;
    }
    if (key !== "t" || !this.touch) return false;
    this.actions.input(this.touch, down ? 1 : 0);
    return true;
  }

  private poll(): void {
    const pad = navigator.getGamepads?.().find((found) => found !== null);
    if (!pad) return;
    const raw = pad.axes[0] ?? 0;
    const axis = Math.abs(raw) < DEAD_ZONE ? 0 : raw;
    if (Math.abs(axis - this.pad.axis) > 0.01) {
      this.pad.axis = axis;
      // To the left is a positive turn.
      this.turnTo(-axis * LIMIT_DEGREES);
    }
    const pressed = pad.buttons[0]?.pressed ?? false;
    if (pressed !== this.pad.pressed) {
      this.pad.pressed = pressed;
      if (this.touch) this.actions.input(this.touch, pressed ? 1 : 0);
    }
  }
}
