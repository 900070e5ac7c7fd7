// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** One brick and its run, steered by commands; knows neither the worker nor the page. */
import { CLOCK_HZ, cyclesOfMs, msAtOrAfter } from "./clock";
import { judgeOf, type Core, type CoreClass } from "./core";
import { withoutDebugInformation } from "./elf";
import { logPins, measure } from "./measuring";
import type { Frame, InputDescription, Measured, Place, Ready, Stop } from "./protocol";
import type { SourceLine, Thread } from "./protocol";
import type { Run, Session, TimedInput, Tunable } from "./session";

/** The wall clock is looked at after this many virtual milliseconds. */
const PIECE_MS = 1;
/** The same as fast as possible, where each look costs speed. */
const FAST_PIECE_MS = 5;
const RATE_WINDOW_MS = 500;
/** Whoever looks on waits no longer for a motor that turns: virtual time, and rad/s. */
const [MOTION_MS, TURNS] = [5000, 0.1];
const MOTORS = ["A", "B", "C"];
const SCOPE_PERIOD_MS = 1;
/** Before anybody sets them; the same inputs have no effect in a stimulus file. */
const INITIAL_VALUES: Record<string, number> = { touch: 0, button: 0, motor: 0 };

/** What a run depends on besides program and inputs. */
function environmentOf({ configuration, probes }: Session): Uint8Array {
  return new TextEncoder().encode(JSON.stringify([configuration, probes]));
}

export class Simulation {
  private core!: Core;
  private session!: Session;
  private elf!: Uint8Array;
  /** Inputs of the scenario or of a replayed run, scheduled at the beginning. */
  private scheduled: TimedInput[] = [];
  private applied: TimedInput[] = [];
  /** Those that the image has, as far as they were asked for. */
  private tunables = new Set<Tunable>();
  private stop: Stop | null = null;
  private lcd: Uint8Array | null = null;
  private eventsSeen = 0;
  private soundSeen = 0;
  private scope = { channels: [] as string[], period_ms: SCOPE_PERIOD_MS };
  private lag = 0;
  /** Where the run was to stop: an instruction that is under way there is finished. */
  private target_cycles = 0;
  private rate = { wall: 0, cycles: 0, value: 0 };
  private replay: Run | null = null;
  /** Of the scenario's end: later it is judged no more. */
  private judged: Measured | null = null;
  private replayLeft = false;
  running = false;
  /** Virtual seconds per second; infinite for as fast as possible. */
  factor = 1;

  constructor(private readonly coreClass: CoreClass) {}

  /** Begin a run; throws the core's sentence when the image or configuration is refused. */
  load(session: Session, elf: Uint8Array, replay: Run | null = null): Ready {
    const core = new this.coreClass(JSON.stringify(session.configuration), elf);
    logPins(core, this.coreClass, session);
    for (const probe of session.probes) core.add_probe(probe.symbol, probe.kind ?? "");
    for (const input of session.inputs) {
      core.schedule_input(input.at_cycles, input.name, input.value);
    }
    if (this.core) this.core.free();
    this.core = core;
    [this.session, this.elf, this.replay] = [session, elf, replay];
    this.scheduled = [...session.inputs].sort((a, b) => a.at_cycles - b.at_cycles);
    this.applied = [];
    this.tunables = new Set(session.tunables);
    [this.stop, this.lcd, this.judged] = [null, null, null];
    [this.running, this.replayLeft] = [false, false];
    [this.eventsSeen, this.soundSeen, this.lag, this.target_cycles] = [0, 0, 0, 0];
    this.restoreScope();
    return {
      kind: "ready",
      session,
      inputs: JSON.parse(core.inputs()) as InputDescription[],
      channels: JSON.parse(core.channels()) as Ready["channels"],
      unobserved: core.threads_unobserved() ?? null,
      image: this.coreClass.sha256(withoutDebugInformation(elf)),
      environment: this.coreClass.sha256(environmentOf(session)),
      judges: judgeOf(core) !== null,
    };
  }

  /** The same run from its beginning, without what was set by hand but with these inputs. */
  reset(inputs: TimedInput[] = []): Ready {
    const ready = this.load(this.session, this.elf, inputs.length > 0 ? null : this.replay);
    for (const input of inputs) this.core.schedule_input(input.at_cycles, input.name, input.value);
    this.scheduled = [...this.scheduled, ...inputs].sort((a, b) => a.at_cycles - b.at_cycles);
    return ready;
  }

  /** Judge the run, at the latest as it was at the scenario's end. */
  measure(signals: string[]): Measured {
    const measured = this.judged ?? {
      ...measure(this.core, this.session),
      final: this.ended,
    };
    const samples = signals.map((name) => [name, this.core.samples(name, 0)]);
    return { ...measured, signals: Object.fromEntries(samples) };
  }

  /** The scenario is over: what comes later is not judged. */
  private judge(): void {
    this.judged = { ...measure(this.core, this.session), final: true };
  }

  get ended(): boolean {
    return this.stop !== null && this.stop.reason !== "reached";
  }

  get cycles(): number {
    return this.core.cycles();
  }

  /** The run that is replayed, until somebody takes part in it or goes on after its end. */
  private get followed(): Run | null {
    return this.replayLeft || this.applied.length > 0 ? null : this.replay;
  }

  /** A replayed run ends where it was saved, or with its program. */
  get replayEnded(): boolean {
    const { followed } = this;
    return followed !== null && (this.ended || this.cycles >= followed.until_cycles);
  }

  leaveReplay(): void {
    this.replayLeft = true;
  }

  /** The end of the scenario; 0 without one. */
  private get overCycles(): number {
    return cyclesOfMs(this.session.duration_ms ?? 0);
  }

  digest(): string {
    return this.core.digest();
  }

  /** Set an input now; one that changes nothing is none. Throws when it is refused. */
  input(name: string, value: number): void {
    const before = this.pastInputs().findLast((input) => input.name === name)?.value;
    if (value === (before ?? INITIAL_VALUES[name.split(".")[0] ?? ""])) return;
    const at_cycles = this.core.cycles();
    this.target_cycles = at_cycles;
    this.core.schedule_input(at_cycles, name, value);
    this.applied.push({ at_cycles, name, value });
  }

  chooseScope(channels: string[], period_ms: number): void {
    this.core.choose_scope(channels, (period_ms * CLOCK_HZ) / 1000);
    this.scope = { channels, period_ms };
  }

  step(by: string, thread: number): void {
    this.running = false;
    if (this.ended) return;
    const before = this.cycles;
    this.stop = JSON.parse(this.core.step(by, thread)) as Stop;
    this.target_cycles = this.cycles;
    if (before < this.overCycles && this.overCycles <= this.cycles) this.judge();
  }

  /** Run to a cycle. */
  runTo(cycles: number): void {
    const end = this.followed ? Math.min(cycles, this.followed.until_cycles) : cycles;
    if (this.ended || end <= this.cycles) return;
    this.target_cycles = end;
    const over_cycles = this.overCycles;
    if (this.cycles < over_cycles && over_cycles <= end) {
      this.stop = JSON.parse(this.core.run_until(over_cycles)) as Stop;
      this.judge();
      if (this.ended) return;
    }
    this.stop = JSON.parse(this.core.run_until(end)) as Stop;
  }

  /** Run to where a motor turns, at most for some seconds. */
  runToMotion(): void {
    const end_cycles = this.cycles + cyclesOfMs(MOTION_MS);
    while (!this.turns && !this.ended && !this.replayEnded && this.cycles < end_cycles) {
      this.runTo(this.cycles + cyclesOfMs(FAST_PIECE_MS));
    }
  }

  private get turns(): boolean {
    const signals = JSON.parse(this.core.signals()) as Frame["signals"];
    return MOTORS.some((port) => Math.abs(signals[`motor.${port}.angular_velocity`] ?? 0) > TURNS);
  }

  /** Catch up with `elapsed_ms` of wall time, but take no longer than `budget_ms` for it. */
  advance(elapsed_ms: number, budget_ms: number, wall: () => number): void {
    const began = wall();
    const start = this.cycles;
    const wanted = elapsed_ms * this.factor * (CLOCK_HZ / 1000) + this.lag;
    const target = Number.isFinite(wanted) ? start + wanted : Infinity;
    const piece_cycles = cyclesOfMs(Number.isFinite(target) ? PIECE_MS : FAST_PIECE_MS);
    while (this.cycles < target && !this.ended && !this.replayEnded) {
      this.runTo(Math.min(this.cycles + piece_cycles, Math.ceil(target)));
      if (wall() - began > budget_ms) break;
    }
    // What a slow machine could not do is given up: the run gets slower than asked for.
    const late = target - this.cycles;
    this.lag = late < cyclesOfMs(PIECE_MS) && Number.isFinite(late) ? late : 0;
    if (this.ended || this.replayEnded) this.running = false;
  }

  private realTimeRatio(wall: number): number {
    const { cycles } = this;
    if (!this.running || cycles < this.rate.cycles || wall - this.rate.wall > 4 * RATE_WINDOW_MS) {
      this.rate = { wall, cycles, value: 0 };
    } else if (wall - this.rate.wall >= RATE_WINDOW_MS) {
      const virtual_ms = ((cycles - this.rate.cycles) / CLOCK_HZ) * 1000;
      this.rate = { wall, cycles, value: virtual_ms / (wall - this.rate.wall) };
    }
    return this.rate.value;
  }

  /** What happened since the last frame. */
  frame(wall: number): Frame {
    const events = this.core.events(this.eventsSeen);
    this.eventsSeen = this.core.event_count();
    return {
      kind: "frame",
      cycles: this.cycles,
      running: this.running,
      realTimeRatio: this.realTimeRatio(wall),
      stop: this.stop,
      lcd: this.changedPicture(),
      signals: JSON.parse(this.core.signals()) as Frame["signals"],
      events,
      scope: this.core.take_scope(),
      sound: this.newSound(),
      threads: JSON.parse(this.core.threads()) as Thread[],
      place: this.running ? null : (JSON.parse(this.core.place()) as Place),
      calls: this.running ? [] : (JSON.parse(this.core.calls()) as SourceLine[]),
      variables: this.variables(),
      inputs: this.pastInputs(),
    };
  }

  /** Run on to a whole millisecond and describe the run up to there; twice is the same run. */
  save(): { run: Run; elf: Uint8Array } {
    const until_ms = msAtOrAfter(this.ended ? this.cycles : this.target_cycles);
    const until_cycles = cyclesOfMs(until_ms);
    this.runTo(until_cycles);
    const inputs = this.pastInputs();
    const run = { ...this.session, inputs, until_ms, until_cycles, digest: this.digest() };
    return { run, elf: this.elf };
  }

  private pastInputs(): TimedInput[] {
    const due = this.scheduled.filter((input) => input.at_cycles <= this.cycles);
    return [...due, ...this.applied].sort((a, b) => a.at_cycles - b.at_cycles);
  }

  /** Tunable variables that the image has: another image may lack some. */
  private variables(): Record<string, number> {
    const found: Record<string, number> = {};
    for (const tunable of this.tunables) {
      const { path, seen } = tunable;
      try {
        found[path] = this.core.variable(seen ?? path);
      } catch {
        this.tunables.delete(tunable);
      }
    }
    return found;
  }

  private changedPicture(): Uint8Array | null {
    const lcd = this.core.lcd();
    if (this.lcd?.every((pixel, at) => pixel === lcd[at])) return null;
    this.lcd = lcd;
    return lcd.slice();
  }

  private newSound(): Int16Array {
    const sample = this.coreClass.sound_sample_cycles();
    const whole = Math.floor(this.cycles / sample);
    if (whole <= this.soundSeen) return new Int16Array();
    const samples = this.core.sound(this.soundSeen * sample);
    const wanted = samples.slice(0, whole - this.soundSeen);
    this.soundSeen = whole;
    return wanted.some((value) => value !== 0) ? wanted : new Int16Array();
  }

  /** Channels that the new brick does not have are left out. */
  private restoreScope(): void {
    const known = this.scope.channels.filter((channel) => {
      try {
        this.core.choose_scope([channel], 1);
        return true;
      } catch {
        return false;
      }
    });
    this.chooseScope(known, this.scope.period_ms);
  }
}
