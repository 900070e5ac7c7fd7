// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// @vitest-environment jsdom
/** What is drawn on canvases, and where; in colours that are called by their names. */
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { cyclesOfMs } from "../src/clock";
import { Kind } from "../src/events";
import { Floor } from "../src/view/floor";
import { Timeline } from "../src/view/timeline";
import { pack, type Plain } from "./events";
import { FRAME, READY } from "./page";

const SIZE = 630;
const COLOURS = ["ink", "grid", "accent", "missed", "bound", "job", "interrupt"];

/** Remembers calls; those that draw with the width and colour of lines, or that of areas. */
class Pen {
  readonly calls: unknown[][] = [];
  [property: string]: unknown;
  lineWidth = 1;
  strokeStyle = "";
  fillStyle = "";
  of = (...names: string[]) => this.calls.filter(([name]) => names.includes(String(name)));
}

let pen: Pen;

beforeEach(() => {
  pen = new Pen();
  const drawn = new Proxy(pen, {
    get: (own, name: string) =>
      name in own
        ? own[name]
        : (...values: unknown[]) => {
            const line = /^stroke/.test(name) ? [own.lineWidth, own.strokeStyle] : [];
            const area = /^fill/.test(name) ? [own.fillStyle] : [];
            own.calls.push([name, ...values, ...line, ...area]);
          },
  });
  const context = drawn as unknown as CanvasRenderingContext2D;
  vi.spyOn(HTMLCanvasElement.prototype, "getContext").mockReturnValue(context as never);
  for (const side of ["clientWidth", "clientHeight"] as const) {
    vi.spyOn(HTMLCanvasElement.prototype, side, "get").mockReturnValue(SIZE);
  }
  for (const name of COLOURS) document.documentElement.style.setProperty(`--${name}`, name);
});

afterEach(() => vi.restoreAllMocks());

describe("the schedule", () => {
  // 500 pixels behind the names are the last 50 ms.
  const at = (ms: number) => 130 + 10 * ms;
  const ms = (time: number) => Math.round(cyclesOfMs(1000) * (time / 1000));
  const job = (from: number, until: number): Plain[] => [
    [ms(from), Kind.release, 0, ms(from)],
    [ms(from), Kind.thread_running, 0],
    [ms(until), Kind.thread_running, -1],
    [ms(until), Kind.completion, 0, ms(from)],
  ];
  const rounded = (calls: unknown[][]) =>
    calls.map((call) =>
      call.map((value) => (typeof value === "number" ? Math.round(10 * value) / 10 : value)),
    );

  function drawn(...events: Plain[]): Timeline {
    const timeline = new Timeline();
    timeline.ready(READY);
    timeline.frame({ ...FRAME, cycles: ms(50), events: pack(...events) });
    return timeline;
  }

  it("has each execution in its place, late jobs in a wide outline of another colour", () => {
    drawn(...job(10, 10.8), ...job(20, 22), ...job(30, 30.8));
    const [top, base] = [0, 20];
    const bars = rounded(pen.of("fillRect"));
    expect(bars).toEqual(
      [at(10), at(20), at(30)].map((left, number) => [
        ...["fillRect", left, top + 10, number === 1 ? 20 : 8, base - top - 10, "accent"],
      ]),
    );
    const outlines = rounded(pen.of("strokeRect"));
    expect(outlines).toEqual([
      ["strokeRect", at(10), top + 8, 8, 12, 1, "job"],
      ["strokeRect", at(20), top + 8, 20, 12, 2, "missed"],
      ["strokeRect", at(30), top + 8, 8, 12, 1, "job"],
    ]);
  });

  it("has an arrow up at a release, one down at the deadline and ┤ at the bound", () => {
    drawn(...job(20, 20.8));
    const [left, right, high, base] = [at(20), at(21), 2, 20];
    const paths = rounded(pen.of("moveTo", "lineTo"));
    const arrow = (x: number, from: number, to: number, head: number) => [
      ["moveTo", x, from],
      ["lineTo", x, to],
      ["moveTo", x - 3, head],
      ["lineTo", x, to],
      ["lineTo", x + 3, head],
    ];
    expect(paths).toEqual([
      ...arrow(left, base, high, high + 4),
      ...arrow(right, high, base, base - 4),
      ["moveTo", right, 6],
      ["lineTo", right, base + 2],
      ["moveTo", right - 4, 14],
      ["lineTo", right, 14],
    ]);
  });

  it("ends the border of one lane before the next one is drawn", () => {
    drawn([ms(30), Kind.interrupt_entered, 9], [ms(31), Kind.interrupt_left]);
    const borders = pen.of("save", "clip", "restore").map(([name]) => name);
    const one = ["save", "clip", "restore"];
    expect(borders).toEqual([...one, ...one]);
    expect(pen.of("fillRect").map((call) => call.at(-1))).toEqual(["interrupt"]);
  });

  it("knows no thread of the program before", () => {
    const timeline = drawn();
    expect([timeline.names, timeline.threadOf("control_task")]).toEqual([["control_task"], 0]);
    timeline.ready(READY);
    expect([timeline.names, timeline.threadOf("control_task")]).toEqual([[], -1]);
  });
});

describe("the floor", () => {
  function drawn(...ends: [number, number][]) {
    const floor = new Floor();
    const [from = [0, 0], to = from] = ends;
    const surroundings = ends.length > 0 ? { walls: [{ from, to }] } : {};
    const configuration = { ...READY.session.configuration, surroundings };
    floor.ready({ ...READY, session: { ...READY.session, configuration } as never });
    pen.calls.length = 0;
    floor.frame({ ...FRAME, signals: { "body.x": 0, "body.y": 0, "body.heading": 0 } });
    return pen.of("scale").map(([, x, y]) => [Number(x), Number(y)]);
  }

  it("has grid, walls and path in lines of 1, 4 and 2 pixels, each in its colour", () => {
    const [[scale = 0] = []] = drawn([-1, 0], [1, 0]);
    expect(scale).toBeCloseTo(SIZE / 2.6);
    const lines = pen.of("stroke").map(([, width, name]) => [Number(width) * scale, name]);
    expect(lines.map(([width]) => Math.round(Number(width)))).toEqual([1, 4, 2]);
    expect(lines.map(([, name]) => name)).toEqual(["grid", "ink", "accent"]);
  });

  it("has a vehicle in its size, but never narrower than 14 pixels", () => {
    const [near, far] = [drawn(), drawn([-20, 0], [20, 0])];
    const track = 0.115;
    expect(near[1]).toEqual([1, 1]);
    expect((far.at(-1)?.[0] ?? 0) * (far.at(-2)?.[0] ?? 0) * track).toBeCloseTo(14);
  });
});
