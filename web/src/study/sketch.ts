// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** A signal over time as somebody expects it: drawn with a pointer, or entered point by point. */
import { seconds } from "../clock";
import { el } from "../dom";
import type { Measured } from "../protocol";
import type { Question } from "../session";
import { Chart, type Axis, type Curve, type Point } from "./chart";

type SketchQuestion = Extract<Question, { signal: string }>;

/** Points nearer than this share of the axis replace each other. */
const APART = 1 / 60;
/** Places at which sketch and signal are compared. */
const COMPARED = 100;

/** Value of the straight lines through the points; at the nearest end outside of them. */
export function valueAt(points: Point[], time: number): number {
  const after = points.findIndex(([x]) => x >= time);
  const [first, last] = [points[0], points.at(-1)];
  if (!first || !last) return Number.NaN;
  if (after === 0) return first[1];
  if (after < 0) return last[1];
  const [x0, y0] = points[after - 1] ?? first;
  const [x1, y1] = points[after] ?? last;
  return y0 + ((time - x0) / (x1 - x0)) * (y1 - y0);
}

/** Mean distance of sketch and signal, where both are. */
export function meanDifference(sketch: Point[], measured: Point[], from: number, until: number) {
  const end = Math.min(until, measured.at(-1)?.[0] ?? from);
  let sum = 0;
  for (let at = 0; at <= COMPARED; at += 1) {
    const time = from + ((end - from) * at) / COMPARED;
    sum += Math.abs(valueAt(sketch, time) - valueAt(measured, time));
  }
  return sum / (COMPARED + 1);
}

export class Sketch {
  readonly element: HTMLElement;
  private readonly chart = new Chart();
  private points: Point[] = [];
  private measured: Point[] = [];
  private fixed = false;
  private readonly x: Axis;
  private readonly y: Axis;
  private readonly list = el("ol", { class: "points", "aria-label": "Points of the sketch" });
  private readonly answer = el("p", { class: "answer", role: "status" });
  private readonly time: HTMLInputElement;
  private readonly value: HTMLInputElement;
  private readonly editor: HTMLElement;

  constructor(
    private readonly question: SketchQuestion,
    private readonly change: () => void,
  ) {
    const { from_ms, until_ms, lowest, highest, unit, text } = question;
    this.x = { lowest: from_ms / 1000, highest: until_ms / 1000, unit: "s" };
    this.y = { lowest, highest, unit };
    const field = ({ lowest: min, highest: max }: Axis) =>
      el("input", { type: "number", step: "any", min, max, required: true });
    [this.time, this.value] = [field(this.x), field(this.y)];
    this.editor = this.makeEditor();
    this.chart.element.classList.add("drawn");
    this.chart.element.addEventListener("pointerdown", (event) => this.draw(event));
    this.chart.element.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) this.draw(event);
    });
    const hint = el("p", { class: "note" }, "Draw in the plot, or add points with the fields.");
    const legend = el("legend", {}, text);
    const parts = [this.chart.element, this.editor, this.list, this.answer];
    this.element = el("fieldset", { class: "question" }, legend, hint, ...parts);
    this.redraw();
  }

  /** Compare with the signal, once the sketch is fixed. */
  show({ signals }: Measured): void {
    if (!this.fixed) return;
    const rows = signals[this.question.signal] ?? new Float64Array();
    const { lowest, highest } = this.x;
    const all = Array.from({ length: rows.length / 2 }, (_, row): Point => [
      seconds(rows[2 * row] ?? 0),
      rows[2 * row + 1] ?? 0,
    ]);
    const inside = all.filter(([time]) => time >= lowest && time <= highest);
    const stride = Math.max(1, Math.floor(inside.length / 500));
    this.measured = inside.filter((_, row) => row % stride === 0);
    if (this.measured.length > 1) {
      const difference = meanDifference(this.points, this.measured, lowest, highest);
      const text = `Mean difference: ${difference.toPrecision(3)} ${this.question.unit}.`;
      if (this.answer.textContent !== text) this.answer.textContent = text;
    }
    this.redraw();
  }

  private makeEditor(): HTMLElement {
    const add = el("button", { type: "submit" }, "Add point");
    const labels = [
      el("label", {}, "At ", this.time, " s"),
      el("label", {}, "value ", this.value, ` ${this.question.unit}`),
    ];
    const form = el("form", { class: "row" }, ...labels, add);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const point: Point = [this.time.valueAsNumber, this.value.valueAsNumber];
      if (point.every(Number.isFinite)) this.put(point, 0);
      this.time.focus();
    });
    const fix = el("button", { type: "button", click: () => this.fix() }, "Fix my sketch");
    const clear = el("button", { type: "button", click: () => this.clear() }, "Clear");
    return el("div", { class: "row" }, form, clear, fix);
  }

  private draw(event: PointerEvent): void {
    if (this.fixed) return;
    event.preventDefault();
    this.put(this.chart.at(event), (this.x.highest - this.x.lowest) * APART);
  }

  /** A point replaces those at its time. */
  private put(point: Point, apart: number): void {
    if (this.fixed) return;
    const others = this.points.filter(([time]) => Math.abs(time - point[0]) > apart);
    this.points = [...others, point].sort(([one], [other]) => one - other);
    this.redraw();
  }

  private clear(): void {
    this.points = [];
    this.redraw();
  }

  private fix(): void {
    if (this.points.length === 0) {
      this.answer.textContent = "The sketch has no point yet.";
      return;
    }
    this.fixed = true;
    this.editor.hidden = true;
    this.answer.textContent = "Now run the brick.";
    this.redraw();
    this.change();
  }

  private redraw(): void {
    const curves: Curve[] = [{ name: "my sketch", kind: "predicted", points: this.points }];
    if (this.measured.length > 0) {
      curves.push({ name: "measured", kind: "measured", points: this.measured });
    }
    const { signal, unit } = this.question;
    this.chart.draw(`${signal} in ${unit || "SI"} over time`, this.x, this.y, curves);
    this.list.replaceChildren(...this.points.map((point) => this.entry(point)));
  }

  private entry(point: Point): HTMLElement {
    const text = `${point[0].toFixed(3)} s: ${point[1].toPrecision(3)} ${this.question.unit}`;
    if (this.fixed) return el("li", {}, text);
    const remove = el("button", {
      ...{ type: "button", "aria-label": `Remove the point at ${point[0].toFixed(3)} s` },
      click: () => {
        this.points = this.points.filter((other) => other !== point);
        this.redraw();
      },
    });
    remove.textContent = "×";
    return el("li", {}, text, remove);
  }
}
