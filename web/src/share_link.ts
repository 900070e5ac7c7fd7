// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** A run as a short link for the same page: its inputs, and which program it is of. */
import { pack, RunFileError, unpack } from "./run_file";
import type { Configuration, Run, Session, TimedInput } from "./session";

const MARK = "#replay=";
const VERSION = 1;

/** The program beside the page and its environment, by their digests. */
export interface Identity {
  image: string;
  environment: string;
}

/** What a link says; `sensors` only when somebody chose other ones. */
export interface SharedRun extends Identity {
  version: number;
  project: string;
  scenario: string | null;
  sensors?: Configuration["sensors"];
  /** Cycle, name and value. */
  inputs: [number, string, number][];
  until_ms: number;
  until_cycles: number;
  digest: string;
}

/** The fragment for a run of the program beside the page. */
export async function encodeShared(
  run: Run,
  identity: Identity,
  served: Session,
): Promise<string> {
  const { project, scenario, until_ms, until_cycles, digest } = run;
  const { sensors } = run.configuration;
  const others = JSON.stringify(sensors) !== JSON.stringify(served.configuration.sensors);
  const shared: SharedRun = {
    ...{ version: VERSION, project, scenario, ...identity },
    ...(others && sensors ? { sensors } : {}),
    inputs: run.inputs.map(({ at_cycles, name, value }) => [at_cycles, name, value]),
    ...{ until_ms, until_cycles, digest },
  };
  return MARK + (await pack(JSON.stringify(shared)));
}

/** What a fragment says; null when it is of another kind. Throws `RunFileError`. */
export async function decodeShared(fragment: string): Promise<SharedRun | null> {
  if (!fragment.startsWith(MARK)) return null;
  let shared: Partial<SharedRun>;
  try {
    shared = JSON.parse(await unpack(fragment.slice(MARK.length))) as Partial<SharedRun>;
  } catch {
    throw new RunFileError("is damaged or cut off; ask for it again, or for the file of the run");
  }
  const numbers = [shared.until_ms, shared.until_cycles];
  if (shared.version !== VERSION || !numbers.every(Number.isSafeInteger)) {
    throw new RunFileError(`has version ${String(shared.version)}; expected ${VERSION}`);
  }
  if (!Array.isArray(shared.inputs) || typeof shared.digest !== "string") {
    throw new RunFileError("has no inputs or no digest; ask for it again");
  }
  return shared as SharedRun;
}

/** The run to replay on the program beside the page; throws when it is of another one. */
export function runOf(shared: SharedRun, identity: Identity, served: Session): Run {
  const [theirs, ours] = [describe(shared), describe(served)];
  if (shared.image !== identity.image) {
    throw new RunFileError(
      `is a run of another program: ${theirs} with image ${short(shared.image)}; here is ${ours} ` +
        `with image ${short(identity.image)}. Open it where that program is, or ask for the file.`,
    );
  }
  if (shared.environment !== identity.environment) {
    throw new RunFileError(
      `is a run of ${theirs} in another environment (body, battery, seed or motors) than here, ` +
        `${ours}. Open it where that scenario is, or ask for the file.`,
    );
  }
  const { sensors, until_ms, until_cycles, digest } = shared;
  const configuration = { ...served.configuration, ...(sensors ? { sensors } : {}) };
  const inputs = shared.inputs.map(([at_cycles, name, value]): TimedInput => {
    return { at_cycles, name, value };
  });
  return { ...served, configuration, inputs, until_ms, until_cycles, digest };
}

const short = (digest: string) => String(digest).slice(0, 12);

function describe({ project, scenario }: { project: string; scenario: string | null }): string {
  return scenario ? `${project}, scenario ${scenario}` : project;
}
