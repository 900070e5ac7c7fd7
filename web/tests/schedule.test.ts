// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { IDLE, Kind } from "../src/events";
import { Schedule } from "../src/schedule";
import { pack } from "./events";

const { release, completion } = Kind;
const { thread_running: threadRunning } = Kind;
const { interrupt_entered: interruptEntered, interrupt_left: interruptLeft } = Kind;

describe("the schedule", () => {
  it("gives the processor to one thread after the other", () => {
    const schedule = new Schedule();
    const events = pack([10, threadRunning, 0], [30, threadRunning, 1], [45, threadRunning, IDLE]);
    schedule.add(events, 50);
    expect(schedule.threads.get(0)?.intervals).toEqual([{ from: 10, to: 30 }]);
    expect(schedule.threads.get(1)?.intervals).toEqual([{ from: 30, to: 45 }]);
  });

  it("takes handlers out of the execution of the thread they interrupt", () => {
    const schedule = new Schedule();
    schedule.add(
      pack(
        [0, threadRunning, 0],
        [10, interruptEntered, 9],
        [12, interruptEntered, 1],
        [15, interruptLeft],
        [20, interruptLeft],
        [30, threadRunning, IDLE],
      ),
      30,
    );
    const thread = schedule.threads.get(0);
    expect(thread?.intervals).toEqual([
      { from: 0, to: 10 },
      { from: 20, to: 30 },
    ]);
    expect(thread?.busy).toBe(20);
    expect(schedule.interrupts.get(9)?.intervals).toEqual([
      { from: 10, to: 12 },
      { from: 15, to: 20 },
    ]);
    expect(schedule.interrupts.get(1)?.busy).toBe(3);
  });

  it("measures a response time from the nominal release", () => {
    const schedule = new Schedule();
    schedule.add(pack([105, release, 0, 100], [180, completion, 0, 100]), 200);
    const statistics = schedule.threads.get(0)?.statistics;
    expect(statistics).toMatchObject({ jobs: 1, worst: 80, last: 80, misses: 0 });
  });

  it("counts a missed deadline once, seen under way or at the completion", () => {
    const schedule = new Schedule();
    schedule.setLimits(0, { deadline: 50, bound: null, cyclic: true });
    schedule.add(pack([100, release, 0, 100]), 149);
    expect(schedule.threads.get(0)?.statistics.misses).toBe(0);
    schedule.add(pack(), 160);
    expect(schedule.threads.get(0)?.statistics.misses).toBe(1);
    schedule.add(pack([170, completion, 0, 100]), 170);
    expect(schedule.threads.get(0)?.statistics.misses).toBe(1);
    schedule.add(pack([200, release, 0, 200], [260, completion, 0, 200]), 300);
    expect(schedule.threads.get(0)?.statistics.misses).toBe(2);
  });

  it("holds jobs against their bound once all cyclic tasks have begun", () => {
    const schedule = new Schedule();
    schedule.setLimits(0, { deadline: null, bound: 30, cyclic: true });
    schedule.setLimits(1, { deadline: null, bound: null, cyclic: true });
    // The first jobs wait for the beginning of the cycle, and task 1 begins at 300.
    schedule.add(pack([10, release, 0, 10], [90, completion, 0, 10], [95, release, 1, 95]), 99);
    schedule.add(pack([200, release, 0, 200], [280, completion, 0, 200]), 290);
    schedule.add(pack([300, release, 1, 300], [300, release, 0, 300]), 310);
    schedule.add(pack([330, completion, 0, 300]), 340);
    const lane = schedule.threads.get(0);
    expect(lane?.statistics).toMatchObject({ jobs: 3, worst: 80, worstBounded: 30, aboveBound: 0 });
    schedule.add(pack([400, release, 0, 400], [431, completion, 0, 400]), 440);
    expect(lane?.statistics).toMatchObject({ worstBounded: 31, aboveBound: 1 });
    expect(lane?.jobs.at(-1)?.aboveBound).toBe(true);
  });

  it("shows the interval under way up to the present", () => {
    const schedule = new Schedule();
    schedule.add(pack([10, threadRunning, 0]), 25);
    const lane = schedule.threads.get(0);
    expect(lane).toBeUndefined();
    schedule.add(pack([26, release, 0, 26]), 40);
    const known = schedule.threads.get(0);
    expect(known && schedule.current(known)).toEqual({ from: 10, to: 40 });
  });
});
