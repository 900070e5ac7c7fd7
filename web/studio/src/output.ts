// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Below the editor: errors with their places, and the commands that were called. */
import { el } from "../../src/dom";
import type { Ended, Problem } from "./server";

export class Problems {
  private readonly list = el("ol", {});
  private readonly none = el("p", { class: "note" }, "No errors.");
  readonly element = el(
    "section",
    { id: "problems", "aria-labelledby": "problems-title", tabindex: -1 },
    el("h2", { id: "problems-title" }, "Errors"),
    this.none,
    this.list,
  );
  all: Problem[] = [];

  constructor(private readonly go: (problem: Problem) => void) {}

  show(problems: Problem[]): void {
    this.all = problems;
    this.none.hidden = problems.length > 0;
    this.list.replaceChildren(...problems.map((problem) => el("li", {}, this.row(problem))));
  }

  focus(): void {
    (this.list.querySelector("button") ?? this.element).focus();
  }

  private row(problem: Problem): HTMLElement {
    const { file, line, column, message } = problem;
    if (!file) return el("span", {}, message);
    const place = `${file}:${line}${column ? `:${column}` : ""}`;
    return el("button", { type: "button", click: () => this.go(problem) }, `${place}: ${message}`);
  }
}

/** Command lines in the order in which they were called; each can be copied. */
export class Commands {
  private readonly list = el("ol", {});
  readonly element = el(
    "section",
    { id: "commands", "aria-labelledby": "commands-title", tabindex: -1 },
    el("h2", { id: "commands-title" }, "Commands"),
    this.list,
  );
  private readonly outcomes = new Map<number, HTMLElement>();

  started(call: number, line: string): void {
    const outcome = el("span", { class: "note" }, "running …");
    this.outcomes.set(call, outcome);
    const copy = el(
      "button",
      { type: "button", "aria-label": `Copy ${line}`, click: () => void this.copy(line, copy) },
      "Copy",
    );
    this.list.prepend(el("li", {}, el("code", {}, line), copy, outcome));
  }

  ended({ call, ok, stopped, seconds, error }: Ended): void {
    const outcome = this.outcomes.get(call);
    if (!outcome) return;
    const said = ok ? "done" : stopped ? "stopped" : "failed";
    const why = ok || !error ? "" : `: ${error}`;
    outcome.textContent = `${said} after ${seconds.toFixed(2)} s${why}`;
    outcome.className = ok ? "note" : "failure";
  }

  private async copy(line: string, button: HTMLElement): Promise<void> {
    await navigator.clipboard?.writeText(line);
    button.textContent = "Copied";
    setTimeout(() => (button.textContent = "Copy"), 2000);
  }
}
