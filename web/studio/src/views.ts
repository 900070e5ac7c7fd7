// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Beside the editor: the brick, and what commands wrote about design, bounds and runs, as tabs. */
import { el } from "../../src/dom";
import type { CommandName, Ended } from "./server";

interface Tab {
  id: string;
  title: string;
  /** What fills it; none for the brick. */
  command: CommandName | null;
  button: string;
  about: string;
}

const TABS: Tab[] = [
  { id: "brick", title: "Brick", command: null, button: "", about: "" },
  {
    id: "design",
    title: "Design",
    command: "design",
    button: "Draw the design",
    about: "Bode, Nyquist, root locus, gain family, discretisations and tolerances.",
  },
  {
    id: "diagram",
    title: "Diagram",
    command: "diagram",
    button: "Draw the diagram",
    about: "The designed controller as a block diagram, beside its C.",
  },
  {
    id: "bounds",
    title: "Bounds",
    command: "analyse",
    button: "Analyse",
    about: "Bounds of execution and response times; the brick's schedule shows them, too.",
  },
  {
    id: "report",
    title: "Report",
    command: "report",
    button: "Run and report",
    about: "The scenario is run and measured: step response beside the design, verdicts.",
  },
];

export class Views {
  readonly frame = el("iframe", { id: "brick-frame", title: "The virtual brick", hidden: true });
  private readonly empty = el("p", { id: "no-brick" }, "There is no image yet: save and build.");
  private readonly tabs: HTMLButtonElement[];
  private readonly panels: HTMLElement[];
  private readonly results = new Map<string, HTMLElement>();
  readonly element: HTMLElement;
  private loaded = false;

  constructor(run: (command: CommandName) => void) {
    this.tabs = TABS.map(({ id, title }) => this.tab(id, title));
    this.panels = TABS.map((tab) => this.panel(tab, run));
    const list = el("div", { role: "tablist", "aria-label": "Views" }, ...this.tabs);
    list.addEventListener("keydown", (event) => this.arrows(event));
    this.element = el("section", { id: "views", "aria-label": "Views" }, list, ...this.panels);
    this.select("brick");
    this.frame.addEventListener("load", () => (this.loaded = this.frame.src !== ""));
  }

  /** There is a brick now: its page is loaded at the first time. */
  showBrick(): boolean {
    const first = this.frame.hidden !== false;
    this.frame.hidden = false;
    this.empty.hidden = true;
    if (first) this.frame.src = "./brick/";
    return first;
  }

  /** Show what a command wrote. */
  ended({ task, call, ok, error, results, figures }: Ended): void {
    const tab = TABS.find(({ command }) => command === task);
    const place = tab && this.results.get(tab.id);
    if (!tab || !place) return;
    const failure = ok ? null : el("p", { class: "failure" }, error ?? "The command failed.");
    const reports = results.filter((name) => name.endsWith(".html"));
    const drawn = tab.id === "design" ? results.filter((name) => name.endsWith(".svg")) : [];
    if (ok && reports.length + drawn.length === 0) return;
    const address = (name: string) => `./results/${name}?call=${call}`;
    place.replaceChildren(
      ...(failure ? [failure] : []),
      ...(figures && tab.id === "design" ? [table(figures)] : []),
      ...drawn.map((name) => el("img", { src: address(name), alt: pictureOf(name) })),
      ...reports.map((name) => el("iframe", { src: address(name), title: tab.title })),
    );
  }

  /** The focus on the brick, or on what is shown instead. */
  focus(): void {
    const shown = this.tabs.findIndex((tab) => tab.ariaSelected === "true");
    if (shown === 0 && this.loaded) this.frame.focus();
    else this.tabs[shown]?.focus();
  }

  private select(id: string): void {
    this.tabs.forEach((tab, at) => {
      const chosen = TABS[at]?.id === id;
      tab.ariaSelected = String(chosen);
      tab.tabIndex = chosen ? 0 : -1;
      this.panels[at]!.hidden = !chosen;
    });
  }

  private arrows(event: KeyboardEvent): void {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    const at = this.tabs.findIndex((tab) => tab.ariaSelected === "true");
    const next = (at + by + TABS.length) % TABS.length;
    this.select(TABS[next]!.id);
    this.tabs[next]!.focus();
  }

  private tab(id: string, title: string): HTMLButtonElement {
    const attributes = {
      role: "tab",
      type: "button",
      id: `${id}-tab`,
      "aria-controls": `${id}-panel`,
      click: () => this.select(id),
    };
    return el("button", attributes, title);
  }

  private panel(tab: Tab, run: (command: CommandName) => void): HTMLElement {
    const { id, command, button, about } = tab;
    const attributes = { role: "tabpanel", id: `${id}-panel`, "aria-labelledby": `${id}-tab` };
    if (!command) return el("div", attributes, this.empty, this.frame);
    const results = el("div", { class: "results" });
    this.results.set(id, results);
    const start = el("button", { type: "button", click: () => run(command) }, button);
    return el("div", attributes, el("p", { class: "row" }, start, about), results);
  }
}

const pictureOf = (name: string) =>
  `${name.split("/").at(-1)?.replace(".svg", "").replaceAll("-", " ")} of the design`;

function table(figures: Record<string, number>): HTMLElement {
  const rows = Object.entries(figures).map(([name, value]) =>
    el(
      "tr",
      {},
      el("th", { scope: "row" }, name),
      el("td", {}, String(Number(value.toPrecision(6)))),
    ),
  );
  return el("table", {}, el("caption", {}, "Figures of the design"), ...rows);
}
