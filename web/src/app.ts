// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The page: views, toolbar and keys around the worker. */
import { Toolbar, type ToolbarActions } from "./controls";
import { el } from "./dom";
import { Keyboard, type KeyActions } from "./keys";
import type { Command, Frame, Ready, Report, StepBy } from "./protocol";
import { decodeLink, decodeRun, encodeLink, encodeRun, type StoredRun } from "./run_file";
import { PLAIN_SESSION, stimulusCsv, type Run, type Session } from "./session";
import { decodeShared, encodeShared, runOf, type Identity, type SharedRun } from "./share_link";
import { questionOfAddress } from "./study/prediction";
import { Study, type Companions } from "./study/study";
import { Face } from "./view/face";
import { Floor } from "./view/floor";
import { Locally, runFileName } from "./view/locally";
import { ManualInputs } from "./view/manual_inputs";
import { Motors } from "./view/motors";
import { Ports } from "./view/ports";
import { Scope } from "./view/scope";
import { Sound } from "./view/sound";
import type { Sources } from "./view/listing";
import { Source } from "./view/source";
import { Surroundings } from "./view/surroundings";
import { Timeline } from "./view/timeline";
import type { Actions, View } from "./view/view";

/** The way to the worker. */
export interface Link {
  send(command: Command): void;
}

const NO_COMPANIONS: Companions = { sources: {}, design: {}, paths: {} };

export class App implements Actions, ToolbarActions, KeyActions {
  readonly toolbar: Toolbar;
  readonly scopeView = new Scope(this);
  readonly timeline = new Timeline();
  private readonly source = new Source();
  private readonly floor = new Floor();
  private readonly motors = new Motors(this);
  private readonly manual = new ManualInputs(this);
  private readonly sound = new Sound();
  private readonly study = new Study(this, {
    again: (inputs) => this.send({ kind: "reset", inputs }),
    measure: (signals) => this.link.send({ kind: "measure", signals }),
    stepController: () => this.step("controller"),
  });
  private readonly views: View[];
  private readonly columns: [HTMLElement, HTMLElement];
  private session: Session = PLAIN_SESSION;
  private elf: Uint8Array | null = null;
  /** The image beside the page, which its sources belong to. */
  private served: Uint8Array | null = null;
  private companions: Companions = NO_COMPANIONS;
  /** Those that the views have. */
  private provided: Companions | null = null;
  /** The project beside the page, and its digests once it is loaded. */
  private servedSession: Session | null = null;
  private identity: Identity | null = null;
  /** A run of the project beside the page that is replayed when that is loaded. */
  private shared: SharedRun | null = null;
  private lastFrame: Frame | null = null;
  /** The brick was seen; one that begins by itself, under way. */
  private see!: () => void;
  private readonly seen = new Promise<void>((seen) => (this.see = seen));
  private begins = false;
  private factor = 1;
  /** Whom to tell when a new image runs: known when it is asked for, told after its first frame. */
  private renewed: (() => void) | null = null;
  private moving: (() => void) | null = null;
  private saveFormat: "file" | "link" | "inputs" = "file";

  constructor(
    private readonly page: HTMLElement,
    private readonly link: Link,
    private readonly options: {
      signal?: AbortSignal;
      name?: string;
      embedded?: boolean;
      asks?: boolean;
    } = {},
  ) {
    const locally = new Locally(options.name ?? "", () => this.save("file"));
    this.toolbar = new Toolbar(this, this.sound.element, locally.element);
    const drive = [new Face(this), this.manual, this.floor];
    const instruments = [this.scopeView, this.source, this.timeline];
    const hardware = [this.motors, new Ports(this), new Surroundings(this)];
    this.views = [...drive, ...instruments, ...this.study.views, ...hardware, locally];
    const column = (name: string, views: View[]) =>
      el("div", { class: `column ${name}` }, ...views.map((view) => view.element));
    this.columns = [column("drive", drive), column("hardware", hardware)];
    const [first, last] = this.columns;
    const middle = [column("instruments", instruments), this.study.element];
    const main = el("main", {}, first, ...middle, last);
    this.page.replaceChildren(this.toolbar.element, main);
    // A student in a sheet sees first what is above; a window shows drive and instruments whole.
    const asking = this.study.prediction.element;
    if (options.embedded) this.page.prepend(asking);
    else this.study.element.prepend(asking);
    addEventListener("resize", () => this.redraw(), options);
    new Keyboard(this, options);
  }

  /** Load what belongs to the page's address: the link's run, else the project beside the page. */
  async begin(
    fragment: string,
    fetched: (address: string) => Promise<Response>,
    folder = "./",
  ): Promise<void> {
    try {
      const stored = await decodeLink(fragment);
      if (stored) return this.replay(stored);
      this.shared = await decodeShared(fragment);
    } catch (error) {
      return this.toolbar.showError(`This link: ${(error as Error).message}`);
    }
    const asked = ["session.json", "image.elf"].map((name) =>
      fetched(`${folder}${name}`).catch(() => null),
    );
    const [session, image] = await Promise.all(asked);
    if (!session?.ok) {
      return this.toolbar.showStatus("Open a program (.elf) or a saved run (.json) to begin.");
    }
    if (!image?.ok) {
      return this.toolbar.showError("There is a session.json but no image.elf beside it.");
    }
    this.served = new Uint8Array(await image.arrayBuffer());
    const own = (await session.json()) as Session | Run;
    const { asks = true } = this.options;
    const questions = [...questionOfAddress(location.search), ...(own.questions ?? [])];
    const described = { ...own, questions: asks ? questions : [] };
    this.servedSession = described;
    if ("digest" in described) this.loadRun({ run: described, elf: this.served });
    else this.load(described, this.served);
    void this.accompany(this.served, (name) => fetched(`${folder}${name}`));
  }

  /** Load what is read beside a run: the brick does not wait for it. */
  private async accompany(
    served: Uint8Array,
    fetched: (name: string) => Promise<Response>,
  ): Promise<void> {
    this.companions = NO_COMPANIONS;
    await this.seen;
    await idle();
    const read = async <Content>(name: string, other: Content): Promise<Content> => {
      const answer = await fetched(name).catch(() => null);
      return answer?.ok ? ((await answer.json()) as Content) : other;
    };
    const companions = {
      sources: await read<Sources>("sources.json", {}),
      design: await read("design.json", {}),
      paths: await read("worst_paths.json", {}),
    };
    // Meanwhile there may be a newer image.
    if (served !== this.served) return;
    this.companions = companions;
    this.updateSources();
  }

  /**
   * Load the image that is beside the page now, and run it unless the one before was paused;
   * `moving` is called when it runs.
   */
  async renew(
    fetched: (address: string) => Promise<Response>,
    moving: () => void,
  ): Promise<void> {
    const last = this.lastFrame;
    const paused = last && !last.running && last.stop?.reason === "reached";
    this.renewed = moving;
    await this.begin("", fetched);
    if (!paused) this.send({ kind: "run" });
  }

  /** An image from elsewhere has other lines. */
  private updateSources(): void {
    const companions = this.runsServed() ? this.companions : NO_COMPANIONS;
    if (companions === this.provided) return;
    this.provided = companions;
    this.source.provide(companions.sources);
    this.study.provide(companions);
  }

  /** Whether the image is the one beside the page. */
  private runsServed(): boolean {
    const [elf, served] = [this.elf, this.served];
    if (elf && elf === served) return true;
    if (!elf || elf.length !== served?.length) return false;
    return elf.every((byte, at) => byte === served[at]);
  }

  /** The project beside the page is loaded: replay the run of the link, if it is one of it. */
  private identify({ image, environment }: Ready): void {
    if (this.identity || !this.servedSession || !this.served) return;
    this.identity = { image, environment };
    const { shared } = this;
    if (!shared) return;
    try {
      const run = runOf(shared, this.identity, this.servedSession);
      this.replay({ run, elf: this.served });
    } catch (error) {
      this.toolbar.showError(`This link ${(error as Error).message}`);
    }
  }

  /** Send what somebody did: an error of what was done before is over. */
  private send(command: Command): void {
    this.toolbar.showError("");
    this.link.send(command);
  }

  load(session: Session, elf: Uint8Array): void {
    this.elf = elf;
    this.send({ kind: "load", session, elf });
  }

  /** Load a run that was made before; its digest is compared at its end. */
  private loadRun({ run, elf }: StoredRun): void {
    this.elf = elf;
    this.send({ kind: "replay", run, elf });
  }

  replay(stored: StoredRun): void {
    this.loadRun(stored);
    this.speed(Infinity);
    this.toolbar.setSpeed(Infinity);
    this.send({ kind: "run" });
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
      case "measured":
        return this.study.measured(report);
      case "replayed":
        if (report.expected === report.found) {
          return this.toolbar.showStatus(`The same run again: trace digest ${report.found}`);
        }
        return this.toolbar.showError(
          `ANOTHER run: trace digest ${report.found}, saved was ${report.expected}`,
        );
      case "failure":
        if (report.of === "scope") this.scopeView.undo();
        return this.toolbar.showError(report.message);
      case "started":
    }
  }

  private ready(ready: Ready): void {
    this.session = ready.session;
    this.lastFrame = null;
    [this.moving, this.renewed] = [this.renewed, null];
    const { project, scenario } = ready.session;
    document.title = `${project} – Ravenbrick`;
    this.toolbar.showStatus(scenario ? `${project}, scenario ${scenario}` : project);
    for (const view of this.views) view.ready(ready);
    // A robot that stays where it is has motors to look at instead of a path.
    const [drive, hardware] = this.columns;
    if (this.floor.element.hidden) drive.append(this.motors.element);
    else hardware.prepend(this.motors.element);
    this.updateSources();
    this.identify(ready);
  }

  private frame(frame: Frame): void {
    this.lastFrame = frame;
    if (frame.cycles > 0 || !this.begins) this.see();
    if (frame.cycles > 0 && this.moving) {
      this.moving();
      this.moving = null;
    }
    for (const view of this.views) view.frame(frame);
    this.study.follow(frame);
    this.toolbar.setThreads(this.timeline.names);
    this.toolbar.frame(frame);
    this.sound.frame(frame, this.factor);
  }

  /** Draw the last frame again, in another size. */
  private redraw(): void {
    if (!this.lastFrame) return;
    const frame = { ...this.lastFrame, events: new Uint8Array(), scope: new Float64Array() };
    for (const view of this.views) view.frame(frame);
  }

  input(name: string, value: number): void {
    this.send({ kind: "input", name, value });
  }

  scope(channels: string[], period_ms: number): void {
    this.send({ kind: "scope", channels, period_ms });
  }

  sensors(sensors: Record<string, { kind: string }>): void {
    if (!this.elf) return;
    const configuration = { ...this.session.configuration, sensors };
    const known = (name: string) => !/^(touch|light|sound|distance|color|sensor)\./.test(name);
    const inputs = this.session.inputs.filter((input) => known(input.name));
    this.load({ ...this.session, configuration, inputs }, this.elf);
  }

  joystick(key: string, down: boolean): boolean {
    return this.manual.joystick.key(key, down);
  }

  reset(): void {
    this.send({ kind: "reset" });
  }

  /** Run by itself, from where the robot begins to move. */
  show(): void {
    this.begins = true;
    this.send({ kind: "run", fromMotion: true });
  }

  toggle(): void {
    const { stop, running } = this.lastFrame ?? { stop: null, running: false };
    if (stop && stop.reason !== "reached") this.reset();
    this.send({ kind: running ? "pause" : "run" });
  }

  step(by: StepBy): void {
    const thread = by === "job" ? this.timeline.threadOf(this.toolbar.thread.value) : -1;
    this.send({ kind: "step", by, thread });
  }

  speed(factor: number): void {
    this.factor = factor;
    this.send({ kind: "speed", factor });
  }

  save(as: "file" | "link" | "inputs"): void {
    this.saveFormat = as;
    this.send({ kind: "pause" });
    this.send({ kind: "save" });
  }

  private async saved({ run, elf }: StoredRun): Promise<void> {
    const name = runFileName(run.project, run.scenario);
    if (this.saveFormat === "file") {
      download(name, "application/json", encodeRun({ run, elf }));
    } else if (this.saveFormat === "inputs") {
      download(name.replace(/\.run\.json$/, ".csv"), "text/csv", stimulusCsv(run.inputs));
    } else {
      const [identity, served] = [this.identity, this.servedSession];
      const short = identity && served && this.runsServed();
      const fragment = await (short
        ? encodeShared(run, identity, served)
        : encodeLink({ run, elf }));
      const link = location.href.split("#")[0] + fragment;
      history.replaceState(null, "", link);
      await navigator.clipboard?.writeText(link).catch(() => undefined);
      const kilobytes = (link.length / 1024).toFixed(1);
      this.toolbar.showStatus(
        `The address of this page is the link now (${kilobytes} KB), also copied.`,
      );
    }
  }

  async open(file: File): Promise<void> {
    try {
      if (file.name.endsWith(".json")) return this.replay(decodeRun(await file.text()));
      const elf = new Uint8Array(await file.arrayBuffer());
      const same = this.elf !== null;
      this.load(same ? this.session : PLAIN_SESSION, elf);
    } catch (error) {
      this.toolbar.showError(`${file.name}: ${(error as Error).message}`);
    }
  }

  command(key: string): boolean {
    const actions: Record<string, () => void> = {
      " ": () => this.toggle(),
      ".": () => this.step("instruction"),
      ",": () => this.step("line"),
      j: () => this.step("job"),
      r: () => this.reset(),
      "+": () => this.toolbar.shift(1),
      "-": () => this.toolbar.shift(-1),
    };
    actions[key]?.();
    return key in actions;
  }
}

/** The page has shown what it has; at the latest after a second. */
function idle(): Promise<unknown> {
  if (!("requestIdleCallback" in globalThis)) return Promise.resolve();
  return new Promise((done) => requestIdleCallback(done, { timeout: 1000 }));
}

function download(name: string, type: string, text: string): void {
  const address = URL.createObjectURL(new Blob([text], { type }));
  el("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
