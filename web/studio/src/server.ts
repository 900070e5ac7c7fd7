// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The studio's server: files, commands, and what happens. */

/** A file in the list; read_only says why, if it is. */
export interface Listed {
  path: string;
  language: string;
  read_only: string;
}

export interface FileText extends Listed {
  text: string;
  version: string;
}

export interface Project {
  name: string;
  files: Listed[];
  scenarios: string[];
  image: boolean;
}

/** An error with its place: line and column from 1; line 0 is none, column 0 the whole line. */
export interface Problem {
  file: string | null;
  line: number;
  column: number;
  message: string;
}

export type CommandName = "build" | "view" | "design" | "diagram" | "analyse" | "report";

export interface Ended {
  kind: "ended";
  call: number;
  task: CommandName;
  ok: boolean;
  stopped: boolean;
  seconds: number;
  error?: string;
  problems: Problem[];
  results: string[];
  figures?: Record<string, number>;
  memory?: { used: number; available: number };
}

export type Happening =
  | { kind: "started"; call: number; task: CommandName; line: string }
  | Ended
  /** There is a new image beside the page. */
  | { kind: "image" }
  | { kind: "idle"; task: CommandName }
  /** Files that any program changed, made or removed. */
  | { kind: "files"; changed: string[] };

/** A refusal; a conflict brings the file as it is on the disk. */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    message: string,
    readonly disk: { text: string; version: string | null } | null,
  ) {
    super(message);
  }
}

export class Server {
  project(): Promise<Project> {
    return ask("./api/project");
  }

  file(path: string): Promise<FileText> {
    return ask(`./api/file?path=${encodeURIComponent(path)}`);
  }

  /** The new version; rejects with a Refusal of status 409 when the file on disk is another one. */
  async save(path: string, text: string, version: string | null): Promise<string> {
    return (await post<{ version: string }>("save", { path, text, version })).version;
  }

  run(command: CommandName, scenario: string | null): Promise<unknown> {
    return post("run", { command, scenario });
  }

  stop(): Promise<unknown> {
    return post("stop", {});
  }

  /** Tell what happens; again and again, also after the connection was lost. */
  listen(tell: (happening: Happening) => void, connected: (yes: boolean) => void): void {
    const source = new EventSource("./api/events");
    source.onmessage = ({ data }: MessageEvent<string>) => tell(JSON.parse(data) as Happening);
    source.onopen = () => connected(true);
    source.onerror = () => connected(false);
  }
}

function post<Answer>(action: string, body: object): Promise<Answer> {
  const headers = { "Content-Type": "application/json" };
  return ask(`./api/${action}`, { method: "POST", headers, body: JSON.stringify(body) });
}

async function ask<Answer>(address: string, options: RequestInit = {}): Promise<Answer> {
  const answer = await fetch(address, options).catch(() => {
    throw new Refusal(0, "the server does not answer; start 'ravenbrick studio' again", null);
  });
  const content = (await answer.json().catch(() => ({}))) as Record<string, unknown>;
  if (answer.ok) return content as Answer;
  const { error, text, version } = content as Record<string, string | null>;
  const disk = typeof text === "string" ? { text, version: version ?? null } : null;
  throw new Refusal(answer.status, error ?? answer.statusText, disk);
}
