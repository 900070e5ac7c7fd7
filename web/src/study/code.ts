// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Diagram, generated C, Ada and worst path side by side, with the line that is being executed. */
import { el, panel } from "../dom";
import type { Frame, SourceLine } from "../protocol";
import { Listing, nameOf, type Sources } from "../view/listing";
import type { View } from "../view/view";

/** A line of a task's worst path. */
export interface PathLine {
  place: string;
  times: number;
  cycles: number;
  run_cycles: number;
}

/** Lines by task. */
export type WorstPaths = Record<string, PathLine[]>;

/** As many lines of a worst path as somebody reads. */
const MOST_LINES = 60;

const isGenerated = (file: string) => /\/generated\/[^/]*\.c$/.test(file);
const isAda = (file: string) => /\.ad[bs]$/.test(file);

/** The block that a line of generated C belongs to, by the nearest comment above it. */
export function blockAt(text: string, line: number): string | null {
  const above = text.split("\n").slice(0, line).join("\n");
  const statements = above.slice(above.lastIndexOf("\n{"));
  const comments = [...statements.matchAll(/^ {2}\/\* .*'<Root>\/([^']+)' \*\/$/gm)];
  return comments.at(-1)?.[1] ?? null;
}

const pane = (title: string, ...children: (HTMLElement | string)[]) =>
  el("div", { class: "pane" }, el("h3", {}, title), ...children);

export class Code implements View {
  readonly element: HTMLElement;
  private sources: Sources = {};
  private paths: WorstPaths = {};
  private calls: SourceLine[] = [];
  private readonly picture = el("div", {
    class: "scrolled",
    role: "region",
    tabindex: 0,
    "aria-label": "Block diagram",
  });
  private readonly block = el("output", { id: "code-block" });
  private readonly generated = new Listing("code-c", "Generated C");
  private readonly ada = new Listing("code-ada", "Ada");
  private readonly task = el("select", {
    "aria-label": "Task whose worst path is shown",
    change: () => this.showPath(),
  });
  private readonly path = el("tbody", {});
  private readonly panes: Record<"diagram" | "c" | "ada" | "path", HTMLElement>;

  constructor(step: () => void) {
    const next = el(
      "button",
      { type: "button", id: "step-c", title: "To another line of the generated C", click: step },
      "Next line of the controller",
    );
    const names = ["Line", "Times", "Cycles", "Run"];
    const titles = names.map((text) => el("th", { scope: "col" }, text));
    const table = el("table", {}, el("thead", {}, el("tr", {}, ...titles)), this.path);
    const lines = el(
      "div",
      { class: "scrolled", role: "region", tabindex: 0, "aria-label": "Lines of the worst path" },
      table,
    );
    this.panes = {
      diagram: pane("Diagram", this.block, this.picture),
      c: pane("Generated C", this.generated.where, this.generated.text),
      ada: pane("Ada", this.ada.where, this.ada.text),
      path: pane("Worst path", this.task, lines),
    };
    const all = el("div", { class: "panes" }, ...Object.values(this.panes));
    this.element = panel("code", "Controller", [next], all);
    this.element.hidden = true;
  }

  /** What belongs to the image; nothing of an image from elsewhere. */
  provide(sources: Sources, diagram: string, paths: WorstPaths): void {
    [this.sources, this.paths] = [sources, paths];
    const parsed = new DOMParser().parseFromString(diagram, "image/svg+xml").documentElement;
    const drawn = parsed.localName === "svg";
    this.picture.replaceChildren(...(drawn ? [document.importNode(parsed, true)] : []));
    const first = Object.keys(sources).find(isGenerated);
    this.element.hidden = !first;
    this.panes.diagram.hidden = !drawn;
    const tasks = Object.keys(paths);
    this.panes.path.hidden = tasks.length === 0;
    this.task.replaceChildren(...tasks.map((task) => el("option", { value: task }, task)));
    if (tasks.includes("control_task")) this.task.value = "control_task";
    this.generated.provide(sources, first ?? null);
    this.ada.provide(sources, null);
    this.show();
  }

  ready(): void {
    this.calls = [];
    this.show();
  }

  frame({ running, calls }: Frame): void {
    this.element.classList.toggle("past", running);
    if (running || JSON.stringify(calls) === JSON.stringify(this.calls)) return;
    this.calls = calls;
    this.show();
  }

  private show(): void {
    const known = this.calls.filter(({ file }) => file in this.sources);
    const inC = known.find(({ file }) => isGenerated(file)) ?? null;
    this.generated.show(inC);
    this.ada.show(known.find(({ file }) => isAda(file)) ?? null);
    this.mark(inC ? blockAt(this.sources[inC.file] ?? "", inC.line) : null);
    this.showPath();
  }

  /** Mark the block that is being computed. */
  private mark(name: string | null): void {
    this.block.value = name ?? "";
    for (const block of this.picture.querySelectorAll("[data-blocks]")) {
      const names = block.getAttribute("data-blocks")?.split(" ") ?? [];
      const chosen = name !== null && names.includes(name);
      block.classList.toggle("chosen", chosen);
      if (chosen) this.bringIntoView(block);
    }
  }

  private bringIntoView(block: Element): void {
    const [seen, own] = [this.picture, block].map((element) => element.getBoundingClientRect());
    if (!seen || !own) return;
    this.picture.scrollLeft += (own.left + own.right - seen.left - seen.right) / 2;
    this.picture.scrollTop += (own.top + own.bottom - seen.top - seen.bottom) / 2;
  }

  private showPath(): void {
    const here = new Set(this.calls.map(({ file, line }) => `${nameOf(file)}:${line}`));
    const lines = (this.paths[this.task.value] ?? []).slice(0, MOST_LINES);
    const rows = lines.map(({ place, times, cycles, run_cycles }) => {
      const numbers = [times, cycles, run_cycles].map((value) => el("td", {}, String(value)));
      const current = here.has(place) ? { "aria-current": "true" } : {};
      return el("tr", current, el("th", { scope: "row" }, place), ...numbers);
    });
    this.path.replaceChildren(...rows);
  }
}
