// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// @vitest-environment jsdom
import { describe, expect, it } from "vitest";
import { cyclesOfMs } from "../src/clock";
import type { Measured } from "../src/protocol";
import type { Session } from "../src/session";
import { Chart, ticks } from "../src/study/chart";
import { blockAt } from "../src/study/code";
import { meanDifference, Sketch, valueAt } from "../src/study/sketch";
import { WRITTEN_MS } from "../src/study/tuning";
import { app, FRAME, get, inputs, READY, sent } from "./page";
// After the page of the tests, which draws no plots.
import { App } from "../src/app";

const TUNABLE = {
  path: "functional_P.Kp",
  unit: "V/V",
  description: "proportional gain",
  ...{ value: 0.3, whole: false, lowest: 0, highest: 1.2 },
};
const SESSION: Session = {
  ...READY.session,
  duration_ms: 1000,
  checks: {
    ...{ setpoints: [], step: null, straight: null, expectations: ["deadlines met"] },
    criteria: [{ measure: "overshoot", maximum: 0.02 }],
  },
  questions: [{ text: "How much overshoot?", measure: "overshoot" }],
  tunables: [TUNABLE],
};
const MEASURED: Measured = {
  ...{ kind: "measured", cycles: 10, final: true, steps: {}, signals: {} },
  verdicts: [
    { measure: "overshoot", value: 0.05, met: false, label: "overshoot ≤ 0.02", shown: "0.05" },
    { measure: "overshoot", value: 0.05 },
    { expectation: "deadlines met", problem: "the run has no jobs" },
  ],
};
const set = (field: HTMLInputElement, value: string, event: string) => {
  field.value = value;
  field.dispatchEvent(new Event(event, { bubbles: true }));
};

describe("gains", () => {
  it("are written at once, and again at the beginning of another run", () => {
    app.receive({ ...READY, session: SESSION });
    app.receive({ ...FRAME, variables: { "functional_P.Kp": 0.3 } });
    expect(get("#tuning output").textContent).toBe("0.3 V/V");
    set(get('#tuning input[type="number"]'), "0.7", "change");
    expect(inputs()).toEqual([["variable.functional_P.Kp", 0.7]]);
    get("#tuning-again").click();
    const input = { name: "variable.functional_P.Kp", value: 0.7 };
    const reset = { kind: "reset", inputs: [{ at_cycles: cyclesOfMs(WRITTEN_MS), ...input }] };
    expect(sent.at(-1)).toEqual(reset);
  });

  it("stand beside set-points, which have names of their own", () => {
    const path = "NXT.Telemetry.In_Force:f32";
    const setPoint = { ...TUNABLE, path, name: "set-point B", unit: "V", lowest: -5, highest: 5 };
    app.receive({ ...READY, session: { ...SESSION, tunables: [setPoint, TUNABLE] } });
    app.receive({ ...FRAME, variables: { [path]: 4 } });
    const [name, value] = ["#tuning b", "#tuning output"].map((place) => get(place).textContent);
    expect([name, value]).toEqual(["set-point B", "4 V"]);
    set(get('#tuning input[type="range"]'), "-2", "input");
    expect(inputs()).toEqual([[`variable.${path}`, -2]]);
  });

  it("are not offered for a program without any", () => {
    expect(get("#tuning").hidden).toBe(true);
  });
});

describe("checks", () => {
  it("say which criterion is met, and that one cannot be judged yet", () => {
    app.receive({ ...READY, session: SESSION });
    app.receive(MEASURED);
    const entries = [...document.querySelectorAll("#check-list li")].map((li) => li.textContent);
    expect(entries[0]).toContain("overshoot ≤ 0.02: not met (0.05)");
    expect(entries[1]).toContain("deadlines met: not yet (the run has no jobs)");
    expect(get("#checks-state").textContent).toBe("not all met");
  });

  it("are not shown by a brick that cannot judge", () => {
    app.receive({ ...READY, session: SESSION, judges: false });
    expect(get("#checks").hidden && get("#prediction").hidden).toBe(true);
  });
});

describe("a prediction", () => {
  it("is asked for in a sheet before the controls that begin the run", () => {
    new App(get("#page"), { send: () => undefined }, { embedded: true });
    const order = get("#prediction").compareDocumentPosition(get("#run"));
    expect(order & Node.DOCUMENT_POSITION_FOLLOWING).toBeTruthy();
  });

  it("is fixed before the measured answer is shown over it", () => {
    app.receive({ ...READY, session: SESSION });
    app.receive(MEASURED);
    expect(get("#prediction .answer").textContent).toBe("");
    get<HTMLInputElement>("#prediction input").value = "3";
    get<HTMLFormElement>("#prediction form").requestSubmit();
    expect(get("#prediction .answer").textContent).toContain("Measured: 5.000 %");
    expect(get("#prediction .answer").textContent).toContain("Difference: 2.00 %");
  });

  it("that is fixed after a reset waits for the measures of the new run", () => {
    app.receive({ ...READY, session: SESSION });
    app.receive(MEASURED);
    app.receive({ ...READY, session: SESSION });
    get<HTMLInputElement>("#prediction input").value = "3";
    get<HTMLFormElement>("#prediction form").requestSubmit();
    expect(get("#prediction .answer").textContent).toBe("Now run the brick.");
  });

  it("as a sketch is compared where both curves are", () => {
    const line: [number, number][] = [
      [0, 0],
      [1, 2],
    ];
    expect([valueAt(line, -1), valueAt(line, 0.25), valueAt(line, 2)]).toEqual([0, 0.5, 2]);
    expect(meanDifference([[0, 1]], line, 0, 1)).toBeCloseTo(0.5, 1);
  });
});

describe("the code", () => {
  it("knows the block of a line, and none outside of the statements", () => {
    const text = ["void f(void)", "{", "  /* Sum: '<Root>/Error' */", "  e = u;", "}"].join("\n");
    expect([blockAt(text, 4), blockAt(text, 1)]).toEqual(["Error", null]);
  });

  it("has round numbers on the axes of its plots", () => {
    expect(ticks({ lowest: 0, highest: 0.8, unit: "s" })).toEqual([0, 0.2, 0.4, 0.6, 0.8]);
  });
});

describe("a chart", () => {
  it("draws what lies within its axes, both ends too, and knows where a pointer is", () => {
    const chart = new Chart();
    const points: [number, number][] = [[-0.1, 1], [0, 0], [0.5, 5], [1, 20], [1.1, 3]];
    const [x, y] = [{ lowest: 0, highest: 1, unit: "s" }, { lowest: 0, highest: 10, unit: "V" }];
    chart.draw("a step", x, y, [{ name: "step", kind: "measured", points }]);
    const line = chart.element.querySelector("polyline");
    // 360 by 140 from (44, 38) on; a value above the axis is at its end.
    expect(line?.getAttribute("points")).toBe("44.0,178.0 224.0,108.0 404.0,38.0");
    // Lines along the axis end with it, and so does the name of its unit.
    const ends = [...chart.element.querySelectorAll("line.grid")].map((l) => l.getAttribute("x2"));
    expect(Math.max(...ends.map(Number))).toBe(404);
    const [unit] = [...chart.element.querySelectorAll("text")].filter((t) => t.textContent === "s");
    expect(unit?.getAttribute("x")).toBe("404");
    const [time, value] = chart.at({ clientX: 224, clientY: 108 });
    expect(time).toBeCloseTo(0.5, 9);
    expect(value).toBeCloseTo(5, 9);
    expect(chart.at({ clientX: 0, clientY: 300 })).toEqual([0, 0]);
  });

  it("names its curves above the plot, two in a row", () => {
    const chart = new Chart();
    const axis = { lowest: 0, highest: 1, unit: "s" };
    const names = ["continuous design", "sampled design", "run before"];
    const curves = names.map((name) => ({ name, kind: "before" as const, points: [] }));
    chart.draw("a step", axis, axis, curves);
    const texts = [...chart.element.querySelectorAll("text")];
    const places = names.map((name) => {
      const text = texts.find(({ textContent }) => textContent === name);
      return [Number(text?.getAttribute("x")), Number(text?.getAttribute("y"))];
    });
    expect(places).toEqual([[71, 14], [251, 14], [71, 30]]);
  });
});

describe("a sketch", () => {
  it("takes points at other times, replaces those of its time, and stays when it is fixed", () => {
    let fixed = 0;
    const question = { text: "Which speed?", signal: "motor.B.angular_velocity", unit: "rad/s" };
    const range = { from_ms: 0, until_ms: 1000, lowest: 0, highest: 10 };
    const sketch = new Sketch({ ...question, ...range }, () => (fixed += 1));
    const fields = sketch.element.querySelectorAll("input");
    const add = (...point: [number, number]) => {
      fields.forEach((field, at) => (field.value = String(point[at])));
      sketch.element.querySelector("form")?.dispatchEvent(new Event("submit"));
    };
    const limits = [...fields].map(({ min, max }) => [Number(min), Number(max)]);
    expect(limits).toEqual([
      [0, 1],
      [0, 10],
    ]);
    const points = () => [...sketch.element.querySelectorAll("li")].map((li) => li.textContent);
    const press = (name: string) =>
      [...sketch.element.querySelectorAll("button")].find((b) => b.textContent === name)?.click();
    press("Fix my sketch");
    expect(sketch.element.textContent).toContain("no point yet");
    [[0.6, 2], [0.5, 1], [0.5, 3]].forEach(([time, value]) => add(time ?? 0, value ?? 0));
    expect(points()).toEqual(["0.500 s: 3.00 rad/s×", "0.600 s: 2.00 rad/s×"]);
    press("×");
    press("Fix my sketch");
    add(0.7, 9);
    expect([points(), fixed]).toEqual([["0.600 s: 2.00 rad/s"], 1]);
    const rows = Float64Array.of(0, 5, cyclesOfMs(500), 5, cyclesOfMs(1000), 5);
    sketch.show({ ...MEASURED, signals: { [question.signal]: rows } });
    expect(sketch.element.textContent).toContain("Mean difference: 3.00 rad/s.");
  });
});
