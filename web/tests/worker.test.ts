// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// @vitest-environment jsdom
/** The worker's loop, with a simulation that only notes what it is asked. */
import { beforeAll, describe, expect, it, vi } from "vitest";
import type { Command } from "../src/protocol";

const simulation = vi.hoisted(() => ({
  ...{ running: false, factor: 1, ended: false, replayEnded: false },
  elapsed: [] as number[],
  load: () => ({ kind: "ready" }),
  frame: () => ({ kind: "frame", events: new Uint8Array(), scope: new Float64Array() }),
  measure: (signals: string[]) => ({ kind: "measured", signals }),
  advance(elapsed_ms: number) {
    this.elapsed.push(elapsed_ms);
  },
}));
const initialise = vi.hoisted(() => vi.fn());
vi.mock("../generated/virtual_brick", () => ({
  default: initialise,
  VirtualBrick: vi.fn(),
}));
vi.mock("../src/simulation", () => ({
  Simulation: function () {
    return simulation;
  },
}));

const core = new WebAssembly.Module(Uint8Array.of(0, 0x61, 0x73, 0x6d, 1, 0, 0, 0));
let wall = 0;
const reports: { kind: string }[] = [];
const timers: [() => void, number][] = [];
const posted: null[] = [];

const told = (command: object) =>
  self.dispatchEvent(new MessageEvent("message", { data: command as Command }));

/** The next tick, `later` milliseconds after the last one. */
function tick(later: number): void {
  wall += later;
  timers.splice(0).forEach(([next]) => next());
}

beforeAll(async () => {
  vi.spyOn(performance, "now").mockImplementation(() => wall);
  vi.stubGlobal("postMessage", (report: { kind: string }) => reports.push(report));
  vi.stubGlobal("setTimeout", (next: () => void, ms: number) => timers.push([next, ms]));
  vi.stubGlobal(
    "MessageChannel",
    class {
      port1 = {};
      port2 = { postMessage: (nothing: null) => posted.push(nothing) };
    },
  );
  await import("../src/worker");
  expect(initialise).not.toHaveBeenCalled();
  told(core);
  await vi.waitFor(() => expect(reports).toEqual([{ kind: "started" }]));
});

describe("the worker", () => {
  it("begins with the core that the page has compiled", () => {
    expect(initialise).toHaveBeenCalledWith({ module_or_path: core });
  });

  it("does nothing for a brick that is not there yet", () => {
    told({ kind: "measure", signals: [] });
    expect(reports.length).toBe(1);
  });

  it("answers each command with what is asked for and a frame", () => {
    told({ kind: "load" });
    told({ kind: "measure", signals: ["body.x"] });
    expect(reports.slice(1)).toMatchObject([
      ...[{ kind: "ready" }, { kind: "frame" }],
      ...[{ kind: "measured", signals: ["body.x"] }, { kind: "frame" }],
    ]);
  });

  it("catches up with the wall clock, a quarter of a second at most, each 16 ms", () => {
    tick(16);
    expect(simulation.elapsed).toEqual([]);
    told({ kind: "run" });
    tick(20);
    tick(3000);
    expect(simulation.elapsed).toEqual([20, 250]);
    expect(timers.map(([, ms]) => ms)).toEqual([16]);
    expect(posted).toEqual([]);
  });

  it("goes on without a timer when it runs as fast as possible", () => {
    told({ kind: "speed", factor: Infinity });
    simulation.factor = Infinity;
    tick(16);
    expect([posted, timers]).toEqual([[null], []]);
  });
});
