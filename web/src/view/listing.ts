// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The text of a source file with one line marked. */
import { el } from "../dom";
import type { SourceLine } from "../protocol";

/** Text of each source file by its path in the image's debug information. */
export type Sources = Record<string, string>;

export const nameOf = (path: string) => path.split("/").pop() ?? path;

export class Listing {
  readonly where: HTMLOutputElement;
  readonly text: HTMLElement;
  private sources: Sources = {};
  /** The file whose lines are there. */
  private shown: string | null = null;

  constructor(id: string, label: string) {
    this.where = el("output", { id: `${id}-place` });
    this.text = el("pre", {
      ...{ id: `${id}-text`, class: "listing", role: "region", tabindex: 0 },
      "aria-label": label,
    });
  }

  /** Sources of an image, and the file that is there before a line is shown. */
  provide(sources: Sources, first: string | null): void {
    this.sources = sources;
    this.fill(first);
  }

  /** Mark a line; false when its text is not there. Without a place the text stays unmarked. */
  show(place: SourceLine | null): boolean {
    this.text.querySelector("[aria-current]")?.removeAttribute("aria-current");
    this.where.value = place ? `${nameOf(place.file)}:${place.line}` : "";
    if (!place || !(place.file in this.sources)) return false;
    if (place.file !== this.shown) this.fill(place.file);
    const here = this.text.children[place.line - 1];
    if (!(here instanceof HTMLElement)) return true;
    here.setAttribute("aria-current", "true");
    this.text.scrollTop = here.offsetTop - (this.text.clientHeight - here.offsetHeight) / 2;
    return true;
  }

  /** A sentence instead of a text. */
  explain(sentence: string): void {
    this.shown = null;
    this.text.replaceChildren(sentence);
  }

  private fill(file: string | null): void {
    this.shown = file;
    const text = file === null ? "" : (this.sources[file] ?? "");
    const lines = text === "" ? [] : text.trimEnd().split("\n");
    this.text.style.setProperty("--digits", `${String(lines.length).length}ch`);
    this.text.replaceChildren(...lines.map((line) => el("span", { class: "line" }, `${line}\n`)));
  }
}
