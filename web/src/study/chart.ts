// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Curves over time with axes, as SVG; a pointer's place on them in their units. */
import { svg } from "../dom";

export type Point = [number, number];

export interface Curve {
  name: string;
  points: Point[];
  /** Class of the line, which decides colour and dashes. */
  kind: "designed" | "sampled" | "measured" | "before" | "predicted";
}

export interface Axis {
  lowest: number;
  highest: number;
  unit: string;
}

/** About as wide as a phone and as a column of the page, so that its letters have their size. */
const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [420, 210, 44, 16, 38, 32];
/** Two names stand beside each other. */
const [NAMES, NAME_WIDE, NAME_HIGH] = [2, 180, 16];
const TICKS = 5;

/** About five round numbers in an axis' range. */
export function ticks({ lowest, highest }: Axis): number[] {
  const rough = (highest - lowest) / TICKS;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5, 10].find((factor) => factor * power >= rough) ?? 10) * power;
  const found: number[] = [];
  for (let at = Math.ceil(lowest / step); at * step <= highest + step / 1000; at += 1) {
    found.push(Number((at * step).toPrecision(6)));
  }
  return found;
}

export class Chart {
  readonly element = svg("svg", {
    class: "chart",
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
    role: "img",
  });
  private x: Axis = { lowest: 0, highest: 1, unit: "s" };
  private y: Axis = { lowest: 0, highest: 1, unit: "" };

  /** Draw the curves; `label` says what a reader sees who does not see it. */
  draw(label: string, x: Axis, y: Axis, curves: Curve[]): void {
    [this.x, this.y] = [x, y];
    this.element.setAttribute("aria-label", label);
    const lines = curves.map(({ kind, points }) =>
      svg("polyline", { class: `curve ${kind}`, points: this.places(points) }),
    );
    this.element.replaceChildren(...this.grid(), ...lines, ...this.legend(curves));
  }

  /** Where on the axes an event's pointer is. */
  at(event: { clientX: number; clientY: number }): Point {
    const box = this.element.getBoundingClientRect();
    const [wide, high] = [box.width || WIDTH, box.height || HEIGHT];
    const across = ((event.clientX - box.left) / wide) * WIDTH - LEFT;
    const down = ((event.clientY - box.top) / high) * HEIGHT - TOP;
    const [x, y] = [across / (WIDTH - LEFT - RIGHT), 1 - down / (HEIGHT - TOP - BOTTOM)];
    const on = (axis: Axis, share: number) =>
      axis.lowest + Math.min(1, Math.max(0, share)) * (axis.highest - axis.lowest);
    return [on(this.x, x), on(this.y, y)];
  }

  private left(value: number): number {
    const { lowest, highest } = this.x;
    return LEFT + ((value - lowest) / (highest - lowest)) * (WIDTH - LEFT - RIGHT);
  }

  private top(value: number): number {
    const { lowest, highest } = this.y;
    const shown = Math.min(highest, Math.max(lowest, value));
    return TOP + ((highest - shown) / (highest - lowest)) * (HEIGHT - TOP - BOTTOM);
  }

  private places(points: Point[]): string {
    const inside = points.filter(([x]) => x >= this.x.lowest && x <= this.x.highest);
    return inside.map(([x, y]) => `${this.left(x).toFixed(1)},${this.top(y).toFixed(1)}`).join(" ");
  }

  private grid(): SVGElement[] {
    const [bottom, end] = [HEIGHT - BOTTOM, WIDTH - RIGHT];
    const across = ticks(this.x).flatMap((value) => {
      const x = this.left(value);
      const line = svg("line", { x1: x, x2: x, y1: TOP, y2: bottom, class: "grid" });
      return [line, svg("text", { x, y: bottom + 14, "text-anchor": "middle" }, String(value))];
    });
    const up = ticks(this.y).flatMap((value) => {
      const y = this.top(value);
      const line = svg("line", { x1: LEFT, x2: end, y1: y, y2: y, class: "grid" });
      const place = { x: LEFT - 4, y: y + 4, "text-anchor": "end" };
      return [line, svg("text", place, String(value))];
    });
    const unit = svg("text", { x: 2, y: 12 }, this.y.unit);
    const time = { x: end, y: HEIGHT - 3, "text-anchor": "end" };
    return [...across, ...up, unit, svg("text", time, this.x.unit)];
  }

  private legend(curves: Curve[]): SVGElement[] {
    return curves.flatMap(({ kind, name }, index) => {
      const x = LEFT + (index % NAMES) * NAME_WIDE;
      const y = 10 + Math.floor(index / NAMES) * NAME_HIGH;
      const line = svg("line", { x1: x, x2: x + 22, y1: y, y2: y, class: `curve ${kind}` });
      const text = svg("text", { x: x + 27, y: y + 4 }, name);
      return [line, text];
    });
  }
}
