// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The page: views, toolbar and keys around the worker. */
import { Toolbar } from "./controls";
import { el } from "./dom";
import type { Command, Frame, Ready, Report, Saved, StepBy } from "./protocol";
import { decodeLink, decodeRun, encodeLink, encodeRun, type StoredRun } from "./run_file";
import { PLAIN_SESSION, stimulusCsv, type Session } from "./session";
import { Face } from "./view/face";
import { Floor } from "./view/floor";
import { Joystick } from "./view/joystick";
import { Motors } from "./view/motors";
import { Ports } from "./view/ports";
import { Scope } from "./view/scope";
import { Sound } from "./view/sound";
import { Surroundings } from "./view/surroundings";
import { Timeline } from "./view/timeline";
import type { Actions, View } from "./view/view";

/** The way to the worker. */
export interface Link {
  send(command: Command): void;
}

const BUTTON_KEYS: Record<string, string> = {
  ArrowLeft: "button.left",
  ArrowRight: "button.right",
  Enter: "button.orange",
  Escape: "button.grey",
};

export class App implements Actions {
  readonly toolbar: Toolbar;
  readonly scopeView = new Scope(this);
  readonly timeline = new Timeline();
  private readonly joystick = new Joystick(this);
  private readonly sound = new Sound();
  private readonly views: View[];
  private session: Session = PLAIN_SESSION;
  private elf: Uint8Array | null = null;
  private frames: Frame | null = null;
  private factor = 1;
  private saveAs: "file" | "link" | "inputs" = "file";

  constructor(
    private readonly page: HTMLElement,
    private readonly link: Link,
    options: { signal?: AbortSignal } = {},
  ) {
    this.toolbar = new Toolbar(
      {
        toggle: () => this.toggle(),
        reset: () => this.link.send({ kind: "reset" }),
        step: (by) => this.step(by),
        speed: (factor) => this.setSpeed(factor),
        save: (as) => this.save(as),
        open: (file) => void this.open(file),
      },
      this.sound.element,
    );
    const [face, floor] = [new Face(this), new Floor()];
    const surroundings = new Surroundings(this);
    const wide = [new Motors(this), new Ports(this), this.scopeView, this.timeline];
    this.views = [face, this.joystick, surroundings, floor, ...wide];
    const hand = el("div", { class: "stack" }, this.joystick.element, surroundings.element);
    const parts = [face.element, hand, floor.element, ...wide.map((view) => view.element)];
    const main = el("main", {}, ...parts);
    this.page.replaceChildren(this.toolbar.element, main);
    document.addEventListener("keydown", (event) => this.key(event, true), options);
    document.addEventListener("keyup", (event) => this.key(event, false), options);
  }

  /** Load what belongs to the page's address: the link's run, else the project beside the page. */
  async begin(fragment: string, fetched: typeof fetch): Promise<void> {
    try {
      const stored = await decodeLink(fragment);
      if (stored) return this.replay(stored);
    } catch (error) {
      return this.toolbar.say(`This link: ${(error as Error).message}`);
    }
    const session = await fetched("./session.json").catch(() => null);
    if (!session?.ok) {
      return this.toolbar.say("Open a program (.elf) or a saved run (.json) to begin.");
    }
    const image = await fetched("./image.elf");
    if (!image.ok) return this.toolbar.say("There is a session.json but no image.elf beside it.");
    this.load((await session.json()) as Session, new Uint8Array(await image.arrayBuffer()));
  }

  load(session: Session, elf: Uint8Array): void {
    this.elf = elf;
    this.link.send({ kind: "load", session, elf });
  }

  replay({ run, elf }: StoredRun): void {
    this.elf = elf;
    this.link.send({ kind: "replay", run, elf });
    this.setSpeed(Infinity);
    this.toolbar.setSpeed(Infinity);
    this.link.send({ kind: "run" });
  }

  receive(report: Report): void {
    switch (report.kind) {
      case "ready":
        return this.ready(report);
      case "frame":
        this.frame(report);
        return void requestAnimationFrame(() => this.link.send({ kind: "shown" }));
      case "saved":
        return void this.saved(report);
      case "replayed":
        return this.toolbar.say(
          report.expected === report.found
            ? `The same run again: trace digest ${report.found}`
            : `ANOTHER run: trace digest ${report.found}, saved was ${report.expected}`,
        );
      case "failure":
        if (report.of === "scope") this.scopeView.refused();
        return this.toolbar.say(report.message);
      case "started":
    }
  }

  private ready(ready: Ready): void {
    this.session = ready.session;
    this.frames = null;
    const { project, scenario } = ready.session;
    document.title = `${project} – Ravenbrick`;
    this.toolbar.say(scenario ? `${project}, scenario ${scenario}` : project);
    for (const view of this.views) view.ready(ready);
  }

  private frame(frame: Frame): void {
    this.frames = frame;
    for (const view of this.views) view.frame(frame);
    this.toolbar.setThreads(this.timeline.names);
    this.toolbar.frame(frame);
    this.sound.frame(frame, this.factor);
  }

  input(name: string, value: number): void {
    this.link.send({ kind: "input", name, value });
  }

  scope(channels: string[], period_ms: number): void {
    this.link.send({ kind: "scope", channels, period_ms });
  }

  sensors(sensors: Record<string, { kind: string }>): void {
    if (!this.elf) return;
    const configuration = { ...this.session.configuration, sensors };
    const known = (name: string) => !/^(touch|light|sound|distance|color|sensor)\./.test(name);
    const inputs = this.session.inputs.filter((input) => known(input.name));
    this.load({ ...this.session, configuration, inputs }, this.elf);
  }

  private toggle(): void {
    this.link.send({ kind: this.frames?.running ? "pause" : "run" });
  }

  private step(by: StepBy): void {
    const thread = by === "job" ? this.timeline.threadOf(this.toolbar.thread.value) : -1;
    this.link.send({ kind: "step", by, thread });
  }

  private setSpeed(factor: number): void {
    this.factor = factor;
    this.link.send({ kind: "speed", factor });
  }

  private save(as: "file" | "link" | "inputs"): void {
    this.saveAs = as;
    this.link.send({ kind: "pause" });
    this.link.send({ kind: "save" });
  }

  private async saved({ run, elf }: Saved): Promise<void> {
    const name = `${run.project}${run.scenario ? `-${run.scenario}` : ""}`;
    if (this.saveAs === "file") {
      download(`${name}.run.json`, "application/json", encodeRun({ run, elf }));
    } else if (this.saveAs === "inputs") {
      download(`${name}.csv`, "text/csv", stimulusCsv(run.inputs));
    } else {
      const link = location.href.split("#")[0] + (await encodeLink({ run, elf }));
      history.replaceState(null, "", link);
      await navigator.clipboard?.writeText(link).catch(() => undefined);
      const kilobytes = (link.length / 1024).toFixed(0);
      this.toolbar.say(`The address of this page is the link now (${kilobytes} KB), also copied.`);
    }
  }

  private async open(file: File): Promise<void> {
    try {
      if (file.name.endsWith(".json")) return this.replay(decodeRun(await file.text()));
      const elf = new Uint8Array(await file.arrayBuffer());
      const same = this.elf !== null;
      this.load(same ? this.session : PLAIN_SESSION, elf);
    } catch (error) {
      this.toolbar.say(`${file.name}: ${(error as Error).message}`);
    }
  }

  private key(event: KeyboardEvent, down: boolean): void {
    const target = event.target as HTMLElement | null;
    const typing = target?.closest("input, select, textarea, button") !== null;
    if ((target && target !== document.body && typing) || event.ctrlKey || event.metaKey) return;
    const name = BUTTON_KEYS[event.key];
    if (name) {
      event.preventDefault();
      if (!event.repeat) this.input(name, down ? 1 : 0);
      return;
    }
    if (event.repeat && event.key === "t") return;
    if (this.joystick.key(event.key.toLowerCase(), down) || !down) return;
    const acts: Record<string, () => void> = {
      " ": () => this.toggle(),
      ".": () => this.step("instruction"),
      ",": () => this.step("line"),
      j: () => this.step("job"),
      r: () => this.link.send({ kind: "reset" }),
      "+": () => this.toolbar.shift(1),
      "-": () => this.toolbar.shift(-1),
    };
    const act = acts[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }
}

function download(name: string, type: string, text: string): void {
  const address = URL.createObjectURL(new Blob([text], { type }));
  el("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
