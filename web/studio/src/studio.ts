// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The page: files, editor, commands and views around one project. */
import { el } from "../../src/dom";
import type { Editor } from "./editor";
import { FileList } from "./file_list";
import { Commands, Problems } from "./output";
import {
  Refusal,
  type CommandName,
  type Ended,
  type Happening,
  type Problem,
  type Server,
} from "./server";
import { Views } from "./views";

const SAVE = "Save and build";
/** First of these that a project has. */
const FIRST_FILES = ["design.py", "src/tasks.adb", "robot.toml"];

export class Studio {
  private readonly files = new FileList({
    openFile: (path) => void this.attempt(() => this.openFile(path)),
    newFile: (path) => void this.attempt(() => this.newFile(path)),
  });
  private readonly problems = new Problems((problem) => {
    void this.attempt(() => this.goTo(problem));
  });
  private readonly commands = new Commands();
  private readonly views = new Views((command) => void this.attempt(() => this.run(command)));
  private readonly title = el("h1", {}, "Ravenbrick studio");
  private readonly status = el("p", { id: "status", role: "status" });
  private readonly error = el("p", { id: "error", role: "alert" });
  private readonly conflict = el("div", { id: "conflict", role: "alert", hidden: true });
  private readonly note = el("p", { id: "note", class: "note" });
  private readonly scenario = el("select", {
    id: "scenario",
    change: () => void this.attempt(() => this.run("view")),
  });
  private readonly save = el(
    "button",
    { id: "save", type: "button", title: "Ctrl+S", click: () => void this.saveAndBuild() },
    SAVE,
  );
  private readonly stop = el(
    "button",
    { id: "stop", type: "button", disabled: true, click: () => void this.server.stop() },
    "Stop",
  );
  private readonly editorPlace = el("section", { id: "editor", "aria-label": "Editor" });
  private editor!: Editor;
  /** Files on their way to the disk, whose change there is ours. */
  private readonly saving = new Set<string>();
  /** When the last save was asked for, until its image moves. */
  private askedAt: number | null = null;
  private built: Ended | null = null;

  constructor(
    private readonly page: HTMLElement,
    private readonly server: Server,
  ) {
    const choice = el("label", {}, "Scenario ", this.scenario);
    const keys =
      "Ctrl+S saves and builds · F6 next pane · Escape leaves the editor · F8 next error";
    // The brick's page in its frame has the same parts: names tell them apart.
    const header = el(
      "header",
      { "aria-label": "Studio" },
      el("div", { class: "row" }, this.title, choice, this.save, this.stop, this.status),
      el("p", { class: "note" }, keys),
      this.error,
    );
    const middle = el("div", { id: "middle" }, this.conflict, this.note, this.editorPlace);
    const below = el("div", { id: "below" }, this.problems.element, this.commands.element);
    middle.append(below);
    const panes = [this.files.element, middle, this.views.element];
    const main = el("main", { "aria-label": "Project" }, ...panes);
    this.page.replaceChildren(header, main);
    document.addEventListener("keydown", (event) => this.key(event));
    this.views.frame.addEventListener("load", () => {
      // Keys that are typed in the brick reach its page only.
      this.views.frame.contentDocument?.addEventListener("keydown", (event) => this.key(event));
    });
    addEventListener("message", (event) => this.hear(event));
    addEventListener("beforeunload", (event) => {
      if (this.editor.dirtyPaths().length > 0) event.preventDefault();
    });
  }

  /** Load project and editor, listen, and build when there is no image yet. */
  async begin(): Promise<void> {
    const { Editor } = await import("./editor");
    this.editor = new Editor(this.editorPlace, {
      save: () => void this.saveAndBuild(),
      leave: () => this.save.focus(),
      edited: () => this.showFiles(),
    });
    await this.attempt(async () => {
      const { name, scenarios, files, image } = await this.server.project();
      this.title.textContent = name;
      this.files.take(files);
      document.title = `${name} – Ravenbrick studio`;
      const none = el("option", { value: "" }, "none");
      this.scenario.replaceChildren(none, ...scenarios.map((one) => el("option", {}, one)));
      this.server.listen(
        (happening) => this.happen(happening),
        (yes) => this.connected(yes),
      );
      const paths = files.map(({ path }) => path);
      const first = FIRST_FILES.find((path) => paths.includes(path)) ?? paths[0];
      if (first) await this.openFile(first);
      if (!image) await this.run("build");
    });
  }

  private async attempt(act: () => Promise<unknown>): Promise<void> {
    this.error.textContent = "";
    try {
      await act();
    } catch (error) {
      this.error.textContent = (error as Error).message;
    }
  }

  private showFiles(): void {
    this.files.show(this.editor.path, new Set(this.editor.dirtyPaths()));
  }

  private async openFile(path: string): Promise<void> {
    if (!this.editor.has(path)) this.editor.put(await this.server.file(path));
    this.editor.show(path);
    this.conflict.hidden = true;
    this.showFiles();
    const reason = this.files.known(path)?.read_only;
    this.note.textContent = reason ? `${path}: read-only, since it ${reason}.` : "";
    this.editor.mark(this.problems.all);
    this.editor.focus();
  }

  private async newFile(path: string): Promise<void> {
    await this.server.save(path, "", null);
    this.files.taken();
    this.files.take((await this.server.project()).files);
    await this.openFile(path);
  }

  private async goTo({ file, line, column }: Problem): Promise<void> {
    if (!file) return;
    await this.openFile(file);
    this.editor.go(line, column);
  }

  /** Save every changed file, then build; a file that another program changed stays as it is. */
  private async saveAndBuild(): Promise<void> {
    this.askedAt = performance.now();
    await this.attempt(async () => {
      for (const path of this.editor.dirtyPaths()) {
        if (!(await this.saveFile(path))) return;
      }
      this.status.textContent = "building …";
      await this.run("build");
    });
  }

  private async saveFile(path: string): Promise<boolean> {
    const { text, version, doc } = this.editor.text(path);
    this.saving.add(path);
    try {
      this.editor.saved(path, doc, await this.server.save(path, text, version));
      return true;
    } catch (error) {
      if (!(error instanceof Refusal && error.disk)) throw error;
      if (path !== this.editor.path) await this.openFile(path);
      this.showConflict(path, error.message, error.disk);
      return false;
    } finally {
      this.saving.delete(path);
      this.showFiles();
    }
  }

  /** Two versions: somebody has to choose. */
  private showConflict(path: string, sentence: string, disk: NonNullable<Refusal["disk"]>): void {
    const end = () => {
      this.conflict.hidden = true;
      this.editor.focus();
    };
    const take = async () => {
      this.editor.put(await this.server.file(path));
      end();
      this.showFiles();
    };
    const keep = async () => {
      this.editor.supersede(path, disk.version);
      end();
      await this.saveAndBuild();
    };
    const choice = (title: string, act: () => Promise<void>) =>
      el("button", { type: "button", click: () => void this.attempt(act) }, title);
    this.conflict.replaceChildren(
      el("p", {}, `${sentence}. Nothing was saved.`),
      choice("Take the file on disk", take),
      choice("Save mine over it", keep),
    );
    this.conflict.hidden = false;
    this.conflict.querySelector("button")?.focus();
  }

  private run(command: CommandName): Promise<unknown> {
    return this.server.run(command, this.scenario.value || null);
  }

  private happen(happening: Happening): void {
    switch (happening.kind) {
      case "started":
        this.stop.disabled = false;
        return this.commands.started(happening.call, happening.line);
      case "ended":
        return this.ended(happening);
      case "image":
        if (!this.views.showBrick()) {
          this.views.frame.contentWindow?.postMessage("new image", location.origin);
        }
        return;
      case "idle":
        this.stop.disabled = true;
        return;
      case "files":
        void this.changedOnDisk(happening.changed);
    }
  }

  private ended(ended: Ended): void {
    this.commands.ended(ended);
    this.views.ended(ended);
    if (ended.task !== "build" && ended.ok) return;
    if (ended.stopped) return;
    this.problems.show(ended.problems);
    this.editor.mark(ended.problems);
    if (!ended.ok) {
      const count = ended.problems.length;
      const errors = count === 1 ? "error" : "errors";
      this.status.textContent = `${ended.task} failed: ${count} ${errors}`;
    } else if (ended.memory) {
      this.built = ended;
      const share = (100 * ended.memory.used) / ended.memory.available;
      this.status.textContent =
        `built in ${ended.seconds.toFixed(2)} s, ${share.toFixed(0)} % of the memory`;
    }
  }

  /** The brick's page says that the new image moves. */
  private hear({ origin, source, data }: MessageEvent): void {
    const ours = origin === location.origin && source === this.views.frame.contentWindow;
    if (!ours || data !== "moving") return;
    const built = this.built ? `built in ${this.built.seconds.toFixed(2)} s; ` : "";
    const moved = this.askedAt === null ? "" : (performance.now() - this.askedAt) / 1000;
    this.askedAt = null;
    if (moved !== "") {
      this.status.textContent = `${built}runs ${moved.toFixed(2)} s after saving`;
    }
  }

  /** Files without changes of ours follow the disk. */
  private async changedOnDisk(changed: string[]): Promise<void> {
    for (const path of this.editor.openPaths().filter((one) => changed.includes(one))) {
      if (this.saving.has(path)) continue;
      const file = await this.server.file(path).catch(() => null);
      const { version } = this.editor.text(path);
      if (!file || file.version === version) continue;
      if (!this.editor.dirty(path)) this.editor.put(file);
      else this.status.textContent = `${path} was changed by another program, too`;
    }
    this.files.take((await this.server.project()).files);
    this.showFiles();
  }

  private connected(yes: boolean): void {
    this.page.classList.toggle("lost", !yes);
    this.error.textContent = yes ? "" : "The server does not answer; what you type is kept here.";
  }

  /** Keys of the whole page; F6 and Shift+F6 go from pane to pane. */
  private key(event: KeyboardEvent): void {
    if (!this.editor) return;
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "s") {
      event.preventDefault();
      // In the editor, its own key has done it.
      if (!event.composedPath().includes(this.editorPlace)) void this.saveAndBuild();
    } else if (event.key === "F6") {
      event.preventDefault();
      this.nextPane(event.shiftKey ? -1 : 1);
    } else if (event.key === "F8" && !this.editorPlace.contains(document.activeElement)) {
      event.preventDefault();
      const first = this.problems.all.find(({ file }) => file);
      if (first) void this.attempt(() => this.goTo(first));
    }
  }

  private nextPane(by: number): void {
    const panes: [Element, () => void][] = [
      [this.files.element, () => this.files.focus()],
      [this.editorPlace, () => this.editor.focus()],
      [this.problems.element, () => this.problems.focus()],
      [this.commands.element, () => this.commands.element.focus()],
      [this.views.element, () => this.views.focus()],
    ];
    const here = panes.findIndex(([element]) => element.contains(document.activeElement));
    const next = here < 0 ? 1 : (here + by + panes.length) % panes.length;
    panes[next]?.[1]();
  }
}
