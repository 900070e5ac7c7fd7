// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** What is run: program, surroundings, tasks and inputs. */
import { motors } from "../../catalogue/parts.json";

/** The configuration of the virtual brick; the core checks it and names what is wrong. */
export interface Configuration {
  seed?: number;
  motors?: Record<string, object>;
  body?: { kind: string; track?: number; wheel_radius?: number };
  sensors?: Record<string, { kind: string }>;
  surroundings?: Surroundings;
  [field: string]: unknown;
}

/** What is around the robot, in m. */
export interface Surroundings {
  /** Pixels from the top left, their share of reflected light in 1/255. */
  floor?: {
    pixel: number;
    corner: [number, number];
    width: number;
    reflectance: number[];
  } | null;
  walls?: { from: [number, number]; to: [number, number] }[];
}

/** A task as robot.toml declares it; `bound_cycles` is the proven response time, when known. */
export interface Task {
  name: string;
  release: "cyclic" | "sporadic" | "background";
  period_us: number | null;
  deadline_us: number | null;
  priority: number;
  bound_cycles?: number | null;
}

/** A scalar recorded with the signals. */
export interface Probe {
  symbol: string;
  kind?: string;
}

/** A variable of the program that may be changed during a run. */
export interface Tunable {
  path: string;
  /** What people call it, if that is not the end of its path. */
  name?: string;
  /** The variable that shows it in the program, if that is not the one that is written. */
  seen?: string;
  unit: string;
  description: string;
  value: number;
  whole: boolean;
  lowest: number;
  highest: number;
}

/** Bounds on a measure; null where there is none. */
export interface Criterion {
  measure: string;
  minimum?: number | null;
  maximum?: number | null;
}

/** The pass criteria of the scenario, and what they need. */
export interface Checks {
  setpoints: { port: string; symbol: string; factor: number }[];
  step: { from_ms: number; until_ms: number; motors: string[] } | null;
  straight: { from_ms: number; distance: number } | null;
  criteria: Criterion[];
  expectations: string[];
}

/** A question before the run: its answer is a measure, or a signal drawn over time. */
export type Question =
  | { text: string; measure: string }
  | {
      text: string;
      signal: string;
      from_ms: number;
      until_ms: number;
      lowest: number;
      highest: number;
      unit: string;
    };

/** An input at a cycle of the run. */
export interface TimedInput {
  at_cycles: number;
  name: string;
  value: number;
}

/** A program in its surroundings. */
export interface Session {
  project: string;
  scenario: string | null;
  configuration: Configuration;
  probes: Probe[];
  tasks: Task[];
  inputs: TimedInput[];
  /** Of the scenario: its end, where it is judged. */
  duration_ms?: number | null;
  checks?: Checks;
  questions?: Question[];
  tunables?: Tunable[];
  /** How to have the same project outside the browser: its template, or else its folder. */
  locally?: { template: string | null; folder: string; changed: boolean };
}

/** A run that replays exactly: the session, the inputs that were applied, and how far. */
export interface Run extends Session {
  until_ms: number;
  until_cycles: number;
  digest: string;
}

const { nxt } = motors;

/** The motor of the catalogue, with linear friction alone. */
const PARAMETERS = Object.fromEntries(
  (
    ["resistance", "torque_constant", "electric_constant", "viscous_friction", "inertia"] as const
  ).map((name) => [name, nxt[name].value]),
);

/** A brick with a touch sensor and three free motors, for a program without a project. */
export const PLAIN_SESSION: Session = {
  project: "brick",
  scenario: null,
  configuration: {
    seed: 1,
    battery: { kind: "li_ion", voltage: 8.0, internal_resistance: 0.0 },
    motors: Object.fromEntries(["A", "B", "C"].map((port) => [port, { parameters: PARAMETERS }])),
    body: { kind: "bench" },
    sensors: { "1": { kind: "touch" } },
  },
  probes: [],
  tasks: [],
  inputs: [],
};

/** Inputs as a stimulus for `ravenbrick run --stimulus`: exact, since instants are cycles. */
export function stimulusCsv(inputs: readonly TimedInput[]): string {
  const names = [...new Set(inputs.map((input) => input.name))].sort();
  const rows = inputs.map((input) => {
    const cells = names.map((name) => (name === input.name ? String(input.value) : ""));
    return [input.at_cycles, ...cells].join(",");
  });
  return [["at_cycles", ...names].join(","), ...rows].join("\n") + "\n";
}
