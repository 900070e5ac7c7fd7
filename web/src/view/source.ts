// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The source text around the place where the program is paused. */
import { el, panel } from "../dom";
import type { Frame, Place } from "../protocol";
import type { View } from "./view";

/** Text of each source file by its path in the image's debug information. */
export type Sources = Record<string, string>;

const nameOf = (path: string) => path.split("/").pop() ?? path;

export class Source implements View {
  readonly element: HTMLElement;
  private sources: Sources = {};
  private place: Place | null = null;
  /** The file whose lines are there. */
  private shown: string | null = null;
  private readonly where = el("output", { id: "source-place" });
  private readonly text = el("pre", {
    id: "source-text",
    role: "region",
    tabindex: 0,
    "aria-label": "Source text",
  });

  constructor() {
    this.element = panel("source", "Source", [this.where], this.text);
  }

  /** Sources of the image that is loaded; none for an image from elsewhere. */
  provide(sources: Sources): void {
    this.sources = sources;
    this.show();
  }

  ready(): void {
    this.place = null;
    this.show();
  }

  frame({ running, place }: Frame): void {
    this.element.classList.toggle("past", running);
    if (running || JSON.stringify(place) === JSON.stringify(this.place)) return;
    this.place = place;
    this.show();
  }

  private show(): void {
    const { file, line } = this.place?.raised ?? this.place ?? { file: null, line: null };
    const text = file === null ? undefined : this.sources[file];
    this.where.value = file === null ? "" : `${nameOf(file)}:${line}`;
    if (text === undefined || file === null || line === null) {
      this.shown = null;
      this.text.replaceChildren(this.reason(file));
      return;
    }
    if (file !== this.shown) this.fill(file, text);
    this.text.querySelector("[aria-current]")?.removeAttribute("aria-current");
    const here = this.text.children[line - 1];
    if (!(here instanceof HTMLElement)) return;
    here.setAttribute("aria-current", "true");
    this.text.scrollTop = here.offsetTop - (this.text.clientHeight - here.offsetHeight) / 2;
  }

  private fill(file: string, text: string): void {
    const lines = text.trimEnd().split("\n");
    this.text.style.setProperty("--digits", `${String(lines.length).length}ch`);
    this.text.replaceChildren(...lines.map((line) => el("span", { class: "line" }, `${line}\n`)));
    this.shown = file;
  }

  private reason(file: string | null): string {
    if (!this.place) return "Paused, the program shows its source line here.";
    const name = this.place.function;
    if (file !== null) return `${file} is not in the project, the drivers or the run-time.`;
    return `The code ${name ? `of ${name} ` : ""}has no source line.`;
  }
}
