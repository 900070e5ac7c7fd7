// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The project's files, and a field for the name of a new one. */
import { el } from "../../src/dom";
import type { Listed } from "./server";

export interface FileActions {
  openFile(path: string): void;
  newFile(path: string): void;
}

export class FileList {
  private readonly list = el("ul", { id: "file-list" });
  private readonly name = el("input", {
    type: "text",
    "aria-label": "Path of a new file",
    placeholder: "scenarios/new.toml",
  });
  readonly element: HTMLElement;
  private files: Listed[] = [];

  constructor(private readonly actions: FileActions) {
    const make = (event: Event) => {
      event.preventDefault();
      if (this.name.value) this.actions.newFile(this.name.value);
    };
    const form = el("form", { submit: make }, this.name, el("button", {}, "New file"));
    this.element = el(
      "nav",
      { id: "files", "aria-labelledby": "files-title", tabindex: -1 },
      el("h2", { id: "files-title" }, "Files"),
      this.list,
      form,
    );
  }

  /** The files that the project has now. */
  take(files: Listed[]): void {
    this.files = files;
  }

  show(current: string, dirty: ReadonlySet<string>): void {
    const focused = document.activeElement?.getAttribute("data-path");
    const rows = this.files.map((file) => el("li", {}, this.row(file, current, dirty)));
    this.list.replaceChildren(...rows);
    if (focused) this.rowOf(focused)?.focus();
  }

  known(path: string): Listed | undefined {
    return this.files.find((file) => file.path === path);
  }

  focus(): void {
    const current = this.list.querySelector<HTMLElement>("[aria-current]");
    (current ?? this.list.querySelector("button") ?? this.name).focus();
  }

  /** The name of the new file was taken. */
  taken(): void {
    this.name.value = "";
  }

  private rowOf(path: string): HTMLElement | null {
    return this.list.querySelector(`[data-path="${CSS.escape(path)}"]`);
  }

  private row(file: Listed, current: string, dirty: ReadonlySet<string>): HTMLElement {
    const note = dirty.has(file.path) ? " (not saved)" : file.read_only ? " (read-only)" : "";
    const attributes = {
      type: "button",
      "data-path": file.path,
      title: file.read_only,
      "aria-current": file.path === current ? "true" : false,
      click: () => this.actions.openFile(file.path),
    };
    return el("button", attributes, file.path, el("span", { class: "note" }, note));
  }
}
