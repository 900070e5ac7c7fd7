// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The joystick: a motor held by hand, turned by slider, keyboard (A and D) or gamepad. */
import { el, panel } from "../dom";
import type { Ready } from "../protocol";
import type { Actions, View } from "./view";

const DEGREES = 180 / Math.PI;
const LIMIT_DEGREES = 90;
const KEY_DEGREES = 5;
/** A stick at rest is not quite at 0. */
const DEAD_ZONE = 0.1;

export class Joystick implements View {
  readonly element: HTMLElement;
  private name: string | null = null;
  private touch: string | null = null;
  private readonly shown = el("output", {}, "0°");
  private readonly range = el("input", {
    type: "range",
    min: -LIMIT_DEGREES,
    max: LIMIT_DEGREES,
    step: 1,
    value: 0,
    "aria-label": "Joystick angle in degrees",
    input: () => this.turnTo(this.range.valueAsNumber),
  });
  private pad = { axis: 0, pressed: false };

  constructor(private readonly actions: Actions) {
    const centre = el("button", { type: "button", click: () => this.turnTo(0) }, "centre");
    const hint =
      "Keys A and D turn it, S centres it, T presses the first touch sensor; " +
      "a gamepad's stick and first button do the same.";
    this.element = panel(
      "joystick",
      "Joystick",
      el("div", { class: "slider" }, this.range, this.shown, centre),
      el("p", { class: "note" }, hint),
    );
  }

  ready({ inputs }: Ready): void {
    this.name = inputs.find((i) => i.name.endsWith(".hand_angle"))?.name ?? null;
    this.touch = inputs.find((i) => i.name.startsWith("touch."))?.name ?? null;
    this.element.hidden = this.name === null;
    this.range.value = "0";
    this.shown.value = "0°";
  }

  frame(): void {
    this.poll();
  }

  turnTo(degrees: number): void {
    if (!this.name) return;
    const angle = Math.max(-LIMIT_DEGREES, Math.min(LIMIT_DEGREES, degrees));
    this.range.value = String(angle);
    this.shown.value = `${angle.toFixed(0)}°`;
    this.actions.input(this.name, angle / DEGREES);
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
