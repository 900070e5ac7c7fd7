// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The measured step response over the designed one. */
import { el, panel } from "../dom";
import type { Measured, Ready, StepFigures } from "../protocol";
import { Chart, type Curve, type Point } from "./chart";
import type { View } from "../view/view";

/** A response to a unit step. */
interface Response {
  times_s: number[];
  values: number[];
}

/** What design.py left: see docs/reference/run-files.md. */
export interface Design {
  responses?: { continuous: Response; sampled: Response };
  diagram?: string;
}

type Step = Measured["steps"][string];

const SHOWN_S = 0.8;
const DEGREES = 180 / Math.PI;
/** As many points as the drawing can tell apart. */
const POINTS = 500;

/** Fitted speed in degrees/s over s after the step. */
function pointsOf({ rows }: Step): Point[] {
  const count = rows.length / 3;
  const stride = Math.max(1, Math.floor(count / POINTS));
  const points: Point[] = [];
  for (let row = 0; row < count; row += stride) {
    points.push([rows[3 * row] ?? 0, (rows[3 * row + 1] ?? 0) * DEGREES]);
  }
  return points;
}

export class StepResponse implements View {
  readonly element: HTMLElement;
  private readonly chart = new Chart();
  private readonly figures = el("p", { id: "step-figures" });
  private readonly motor = el("select", {
    "aria-label": "Motor whose step response is shown",
    change: () => this.show(),
  });
  private design: Design = {};
  private steps: Measured["steps"] = {};
  /** Of the run before this one. */
  private before: Measured["steps"] = {};

  constructor() {
    const text = "Shown from the step of the set-point on.";
    const waiting = el("p", { class: "note", id: "step-waiting" }, text);
    const figure = this.chart.element as unknown as HTMLElement;
    this.element = panel("step", "Step response", [this.motor], figure, this.figures, waiting);
  }

  provide(design: Design): void {
    this.design = design;
    this.show();
  }

  ready({ session, judges }: Ready): void {
    if (Object.keys(this.steps).length > 0) this.before = this.steps;
    this.steps = {};
    const motors = session.checks?.step?.motors ?? [];
    this.element.hidden = motors.length === 0 || !judges;
    const chosen = this.motor.value;
    const options = motors.map((port) => el("option", { value: port }, `motor ${port}`));
    this.motor.replaceChildren(...options);
    if (motors.includes(chosen)) this.motor.value = chosen;
    this.show();
  }

  frame(): void {}

  measured({ steps }: Measured): void {
    this.steps = steps;
    this.show();
  }

  private show(): void {
    const port = this.motor.value;
    const [step, before] = [this.steps[port], this.before[port]];
    const figures = (step ?? before)?.figures;
    const height = (figures?.setpoint ?? figures?.final_value ?? 0) * DEGREES || 1;
    const curves = this.designed(height);
    if (before) curves.push({ name: "run before", kind: "before", points: pointsOf(before) });
    if (step) curves.push({ name: "this run", kind: "measured", points: pointsOf(step) });
    const [low, high] = [-0.08 * height, 1.45 * height].sort((a, b) => a - b);
    const y = { lowest: low ?? 0, highest: high ?? 1, unit: "°/s" };
    const text = step ? sentence(step.figures) : "No step of the set-point yet.";
    const x = { lowest: 0, highest: SHOWN_S, unit: "s after the step" };
    this.chart.draw(`Speed of motor ${port}. ${text}`, x, y, curves);
    this.figures.textContent = text;
    const waiting = this.element.querySelector<HTMLElement>("#step-waiting");
    if (waiting) waiting.hidden = step !== undefined;
  }

  private designed(height: number): Curve[] {
    const { responses } = this.design;
    if (!responses) return [];
    const scaled = ({ times_s, values }: Response) =>
      times_s.map((time, at): Point => [time, (values[at] ?? 0) * height]);
    return [
      { name: "continuous design", kind: "designed", points: scaled(responses.continuous) },
      { name: "sampled design", kind: "sampled", points: scaled(responses.sampled) },
    ];
  }
}

function sentence({ setpoint, settling_time, overshoot }: StepFigures): string {
  const parts = [
    setpoint === null ? "" : `Set-point ${(setpoint * DEGREES).toFixed(0)} °/s`,
    settling_time === null
      ? "not settled"
      : `settled after ${(settling_time * 1000).toFixed(1)} ms`,
    overshoot === null ? "" : `overshoot ${(overshoot * 100).toFixed(2)} %`,
  ];
  return `${parts.filter(Boolean).join(", ")}.`;
}
