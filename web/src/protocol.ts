// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Messages between the page and the worker that runs the brick. */
import type { Run, Session, TimedInput } from "./session";

export type StepBy = "instruction" | "line" | "job";

export type Command =
  | { kind: "load"; session: Session; elf: Uint8Array }
  | { kind: "replay"; run: Run; elf: Uint8Array }
  | { kind: "run" }
  | { kind: "pause" }
  | { kind: "reset" }
  | { kind: "speed"; factor: number }
  | { kind: "step"; by: StepBy; thread: number }
  | { kind: "input"; name: string; value: number }
  | { kind: "scope"; channels: string[]; period_ms: number }
  | { kind: "save" }
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

/** A brick was made; its run is at its beginning. */
export interface Ready {
  kind: "ready";
  session: Session;
  inputs: InputDescription[];
  channels: { signals: string[]; symbols: { name: string; size: number }[] };
  unobserved: string | null;
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
  inputs: TimedInput[];
}

export type Report =
  /** The worker is there. */
  | { kind: "started" }
  | Ready
  | Frame
  | { kind: "saved"; run: Run; elf: Uint8Array }
  /** A replayed run reached its end; trace digests. */
  | { kind: "replayed"; expected: string; found: string }
  /** A command was refused. */
  | { kind: "failure"; of: Command["kind"]; message: string };
