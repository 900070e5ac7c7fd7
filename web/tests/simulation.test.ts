// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { cyclesOfMs } from "../src/clock";
import type { CoreClass } from "../src/core";
import { PLAIN_SESSION } from "../src/session";
import { Simulation } from "../src/simulation";

/** A core that only counts, to see how it is driven. */
class CountingCore {
  static sound_sample_cycles = () => 1000;
  static sha256 = (bytes: Uint8Array) => `digest of ${bytes.length}`;
  now = 0;
  /** The cycles by which the last instruction goes past the end of a run. */
  overrun = 0;
  /** Where the program ends. */
  halts_at = Infinity;
  scheduled: [number, string, number][] = [];
  limits: number[] = [];
  cycles = () => this.now;
  run_until(limit: number): string {
    this.limits.push(limit);
    this.now = Math.min(Math.max(this.now, limit + this.overrun), this.halts_at);
    const reason = limit > this.halts_at ? "halted" : "reached";
    return JSON.stringify({ reason, at_cycles: this.now, message: "" });
  }
  schedule_input(at: number, name: string, value: number): void {
    this.scheduled.push([at, name, value]);
  }
  inputs = () => "[]";
  channels = () => '{"signals": [], "symbols": []}';
  threads_unobserved = () => undefined;
  add_probe = () => undefined;
  choose_scope = () => undefined;
  digest = () => `at ${this.now}`;
  events = () => new Uint8Array();
  event_count = () => 0;
  lcd = () => new Uint8Array();
  signals = () => "{}";
  take_scope = () => new Float64Array();
  sound = () => new Int16Array();
  threads = () => "[]";
  place = () => "{}";
  calls = () => "[]";
  /** Variables that were asked for. */
  asked: string[] = [];
  variable(path: string): number {
    this.asked.push(path);
    if (path === "missing") throw new Error("no variable");
    return 1;
  }
  step(): string {
    this.now += 1;
    return JSON.stringify({ reason: "reached", at_cycles: this.now, message: "" });
  }
  free = () => undefined;
}

function begin(inputs = PLAIN_SESSION.inputs, halts_at = Infinity) {
  const cores: CountingCore[] = [];
  class Made extends CountingCore {
    constructor() {
      super();
      this.halts_at = halts_at;
      cores.push(this);
    }
  }
  const simulation = new Simulation(Made as unknown as CoreClass);
  simulation.load({ ...PLAIN_SESSION, inputs }, new Uint8Array());
  return { simulation, cores, core: cores[0] as CountingCore };
}

/** A wall clock that gains `step` with each look. */
function steppingClock(step: number): () => number {
  let now = 0;
  return () => (now += step);
}

describe("the pace", () => {
  it("follows the wall clock at the factor asked for", () => {
    const { simulation, core } = begin();
    simulation.factor = 0.5;
    simulation.running = true;
    for (let tick = 0; tick < 100; tick += 1) simulation.advance(20, 13, steppingClock(0));
    expect(core.now).toBeGreaterThan(cyclesOfMs(1000) - cyclesOfMs(1));
    expect(core.now).toBeLessThan(cyclesOfMs(1000) + cyclesOfMs(1));
  });

  it("gives up what a slow machine cannot do instead of piling it up", () => {
    const { simulation, core } = begin();
    simulation.running = true;
    simulation.advance(100, 13, steppingClock(5));
    const reached = core.now;
    expect(reached).toBeLessThan(cyclesOfMs(10));
    simulation.advance(1, 13, steppingClock(0));
    expect(core.now).toBeLessThan(reached + cyclesOfMs(3));
  });

  it("takes its whole budget when as fast as possible", () => {
    const { simulation, core } = begin();
    simulation.factor = Infinity;
    simulation.running = true;
    simulation.advance(16, 13, steppingClock(1));
    expect(core.limits.length).toBe(14);
    expect(core.now).toBe(core.limits.length * cyclesOfMs(5));
  });
});

describe("a run that begins by itself", () => {
  /** A core whose motor B turns from an instant on. */
  function turningFrom(ms: number) {
    const { simulation, core } = begin();
    core.signals = () =>
      JSON.stringify({ "motor.B.angular_velocity": core.now < cyclesOfMs(ms) ? 0 : -2 });
    return { simulation, core };
  }

  it("is shown from where a motor turns", () => {
    const { simulation, core } = turningFrom(1002);
    simulation.runToMotion();
    expect(core.now).toBeGreaterThanOrEqual(cyclesOfMs(1002));
    expect(core.now).toBeLessThanOrEqual(cyclesOfMs(1010));
  });

  it("is shown all the same when none turns within some seconds", () => {
    const { simulation, core } = turningFrom(60_000);
    simulation.runToMotion();
    expect(core.now).toBeLessThan(cyclesOfMs(5010));
  });
});

describe("a frame", () => {
  it("has the picture when it changed", () => {
    const { simulation, core } = begin();
    core.lcd = () => Uint8Array.of(0, 1);
    expect(simulation.frame(0).lcd).toEqual(Uint8Array.of(0, 1));
    expect(simulation.frame(16).lcd).toBeNull();
    core.lcd = () => Uint8Array.of(0, 0);
    expect(simulation.frame(32).lcd).toEqual(Uint8Array.of(0, 0));
  });

  it("has the sound from the first sample on, each once", () => {
    const { simulation, core } = begin();
    const from: number[] = [];
    core.sound = ((begin: number) => (from.push(begin), new Int16Array(9).fill(1))) as never;
    simulation.runTo(3500);
    expect(simulation.frame(0).sound.length).toBe(3);
    simulation.runTo(5000);
    expect(simulation.frame(16).sound.length).toBe(2);
    expect(from).toEqual([0, 3000]);
  });

  it("has the ratio of virtual to real time over the last half second", () => {
    const { simulation } = begin();
    simulation.running = true;
    expect(simulation.frame(0).realTimeRatio).toBe(0);
    simulation.runTo(cyclesOfMs(600));
    expect(simulation.frame(600).realTimeRatio).toBeCloseTo(1, 6);
    simulation.runTo(cyclesOfMs(900));
    expect(simulation.frame(1200).realTimeRatio).toBeCloseTo(0.5, 6);
  });

  it("of a step is that of a brick that stands", () => {
    const { simulation } = begin();
    simulation.running = true;
    simulation.step("line", -1);
    expect([simulation.running, simulation.frame(0).running]).toEqual([false, false]);
  });
});

describe("tunable variables", () => {
  it("are read for each frame; those that the image lacks are asked for once", () => {
    const { simulation, cores } = begin();
    const common = { unit: "", description: "", value: 0, whole: false, lowest: 0, highest: 1 };
    const tunables = ["there", "missing"].map((path) => ({ ...common, path }));
    simulation.load({ ...PLAIN_SESSION, tunables }, new Uint8Array());
    for (const wall of [0, 16, 32]) {
      expect(simulation.frame(wall).variables).toEqual({ there: 1 });
    }
    expect(cores.at(-1)?.asked).toEqual(["there", "missing", "there", "there"]);
  });
});

describe("inputs", () => {
  it("are applied now and kept; one that changes nothing is none", () => {
    const { simulation, core } = begin();
    simulation.runTo(500);
    simulation.input("touch.1", 0);
    simulation.input("touch.1", 1);
    simulation.input("touch.1", 1);
    simulation.input("battery.voltage", 8);
    expect(core.scheduled).toEqual([
      [500, "touch.1", 1],
      [500, "battery.voltage", 8],
    ]);
    expect(simulation.save().run.inputs).toEqual([
      { at_cycles: 500, name: "touch.1", value: 1 },
      { at_cycles: 500, name: "battery.voltage", value: 8 },
    ]);
  });

  it("of the scenario that are still to come are no part of the saved run", () => {
    const { simulation } = begin([
      { at_cycles: 10, name: "touch.1", value: 1 },
      { at_cycles: cyclesOfMs(50), name: "touch.1", value: 0 },
    ]);
    simulation.runTo(cyclesOfMs(20));
    expect(simulation.save().run.inputs).toEqual([{ at_cycles: 10, name: "touch.1", value: 1 }]);
  });

  it("are gone after a reset, those of the scenario come again", () => {
    const { simulation } = begin([{ at_cycles: 10, name: "touch.1", value: 1 }]);
    simulation.runTo(500);
    simulation.input("touch.1", 0);
    simulation.reset();
    simulation.runTo(500);
    expect(simulation.save().run.inputs).toEqual([{ at_cycles: 10, name: "touch.1", value: 1 }]);
  });
});

describe("a saved run", () => {
  it("is the same when it is saved again, though its last instruction goes past the end", () => {
    const { simulation, core } = begin();
    core.overrun = 3;
    simulation.runTo(cyclesOfMs(3) + 1);
    const { run } = simulation.save();
    expect(run.until_ms).toBe(4);
    expect(simulation.save().run).toEqual(run);
  });

  it("ends at a whole millisecond, where its replay ends too", () => {
    const { simulation } = begin();
    simulation.runTo(cyclesOfMs(3) + 1);
    const { run, elf } = simulation.save();
    expect([run.until_ms, run.until_cycles, run.digest]).toEqual([
      4,
      cyclesOfMs(4),
      `at ${cyclesOfMs(4)}`,
    ]);
    simulation.load(run, elf, run);
    simulation.factor = Infinity;
    simulation.running = true;
    simulation.advance(16, 1e9, steppingClock(0));
    expect(simulation.cycles).toBe(run.until_cycles);
    expect([simulation.running, simulation.replayEnded]).toEqual([false, true]);
  });

  it("ends with its program, whose last instruction is a part of it", () => {
    const { simulation } = begin(PLAIN_SESSION.inputs, cyclesOfMs(3) + 1);
    simulation.runTo(cyclesOfMs(9));
    const { run, elf } = simulation.save();
    expect(run.until_cycles).toBeGreaterThan(simulation.cycles);
    simulation.load(run, elf, run);
    simulation.factor = Infinity;
    simulation.running = true;
    simulation.advance(16, 1e9, steppingClock(0));
    expect([simulation.ended, simulation.replayEnded]).toEqual([true, true]);
    expect(simulation.digest()).toBe(run.digest);
  });
});
