// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Messages between the page and the worker that runs the brick. */
import type { Run, Session, TimedInput } from "./session";

export type StepBy = "instruction" | "line" | "controller" | "job";

export type Command =
  | { kind: "load"; session: Session; elf: Uint8Array }
  | { kind: "replay"; run: Run; elf: Uint8Array }
  /** Go on; without the time before a motor turns, if one does soon. */
  | { kind: "run"; fromMotion?: boolean }
  | { kind: "pause" }
  /** The same run from its beginning; with these inputs besides those of the scenario. */
  | { kind: "reset"; inputs?: TimedInput[] }
  | { kind: "speed"; factor: number }
  | { kind: "step"; by: StepBy; thread: number }
  | { kind: "input"; name: string; value: number }
  | { kind: "scope"; channels: string[]; period_ms: number }
  | { kind: "save" }
  /** Judge the run so far, and give the samples of these signals. */
  | { kind: "measure"; signals: string[] }
  /** The last frame was shown: the next may come. */
  | { kind: "shown" };

/** What can be set from outside. */
export interface InputDescription {
  name: string;
  lowest: number;
  highest: number;
  whole: boolean;
  unit: string;
}

export interface Thread {
  name: string;
  priority: number;
  state: number;
  stack_size: number;
  stack_used: number;
}

export interface Stop {
  reason: "reached" | "power_off" | "fault" | "halted" | "trace_full";
  at_cycles: number;
  message: string;
}

export interface Place {
  pc: number;
  function: string | null;
  offset: number | null;
  file: string | null;
  line: number | null;
  /** The source line of the failure that ended the program. */
  raised: { file: string; line: number } | null;
}

/** A place in the sources. */
export interface SourceLine {
  file: string;
  line: number;
}

/** What a criterion or a sentence found; `problem` says why the run cannot show it (yet). */
export interface Verdict {
  measure?: string;
  expectation?: string;
  value?: number | null;
  met?: boolean;
  label?: string;
  shown?: string;
  sentence?: string;
  problem?: string;
}

/** Figures of a step response; rad/s, s, and shares of the set-point. */
export interface StepFigures {
  setpoint: number | null;
  final_value: number | null;
  settling_time: number | null;
  overshoot: number | null;
}

/** The run as it is judged. */
export interface Measured {
  kind: "measured";
  cycles: number;
  /** The scenario is over: nothing of this changes any more. */
  final: boolean;
  /** One per criterion, then one per sentence. */
  verdicts: Verdict[];
  /** By motor: rows of s after the step, fitted and true speed (rad/s), and their figures. */
  steps: Record<string, { rows: Float64Array; figures: StepFigures }>;
  /** By signal: rows of instant (cycles) and value. */
  signals: Record<string, Float64Array>;
}

/** A brick was made; its run is at its beginning. */
export interface Ready {
  kind: "ready";
  session: Session;
  inputs: InputDescription[];
  channels: { signals: string[]; symbols: { name: string; size: number }[] };
  unobserved: string | null;
  /** SHA-256 of the image without its debug information, and of the brick's environment. */
  image: string;
  environment: string;
  /** Whether this brick can judge a run. */
  judges: boolean;
}

/** What happened since the last frame. */
export interface Frame {
  kind: "frame";
  cycles: number;
  running: boolean;
  /** Virtual seconds per second, over the last half second; 0 while paused. */
  realTimeRatio: number;
  stop: Stop | null;
  lcd: Uint8Array | null;
  signals: Record<string, number | null>;
  events: Uint8Array;
  scope: Float64Array;
  sound: Int16Array;
  threads: Thread[];
  place: Place | null;
  /** While paused: the calls that lead to the next instruction, innermost first. */
  calls: SourceLine[];
  /** Tunable variables by their paths, as they are in memory. */
  variables: Record<string, number>;
  inputs: TimedInput[];
}

export type Report =
  /** The worker is there. */
  | { kind: "started" }
  | Ready
  | Frame
  | Measured
  | { kind: "saved"; run: Run; elf: Uint8Array }
  /** A replayed run reached its end; trace digests. */
  | { kind: "replayed"; expected: string; found: string }
  /** A command was refused. */
  | { kind: "failure"; of: Command["kind"]; message: string };
