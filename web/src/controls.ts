// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Run, pause, step, speed, reset, and files. */
import { seconds } from "./clock";
import { el } from "./dom";
import { keyHelp } from "./keys";
import type { Frame, StepBy } from "./protocol";

/** What the toolbar asks for. */
export interface ToolbarActions {
  toggle(): void;
  reset(): void;
  step(by: StepBy): void;
  speed(factor: number): void;
  save(as: "file" | "link" | "inputs"): void;
  open(file: File): Promise<void>;
}

const SPEEDS: [string, number][] = [
  ["1/100", 0.01],
  ["1/10", 0.1],
  ["1/4", 0.25],
  ["1×", 1],
  ["2×", 2],
  ["5×", 5],
  ["20×", 20],
  ["fastest", Infinity],
];

export class Toolbar {
  readonly element: HTMLElement;
  readonly thread = el("select", { "aria-label": "Task whose jobs are stepped" });
  private readonly runButton: HTMLButtonElement;
  private readonly time = el("output", { id: "time", "aria-label": "Virtual time" }, "0.000 s");
  private readonly rate = el("output", { id: "rate", "aria-label": "Times real speed" });
  private readonly place = el("output", { id: "place", "aria-label": "Next instruction" });
  private readonly status = el("p", { id: "status", role: "status" });
  /** How the program ended, as long as it has; and what the page could not do. */
  private readonly program = el("p", { id: "program", role: "status" });
  private readonly problem = el("p", { id: "problem", role: "alert" });
  private readonly speeds: HTMLSelectElement;
  private names = "";

  constructor(
    private readonly actions: ToolbarActions,
    sound: HTMLElement,
    locally: HTMLElement,
  ) {
    const button = (label: string, title: string, act: () => void, id: string) =>
      el("button", { type: "button", title, id, click: act }, label);
    this.runButton = button("Run", "Run or pause (space)", () => actions.toggle(), "run");
    const steps = [
      button("Instruction", "One instruction (.)", () => actions.step("instruction"), "step-i"),
      button("Line", "To another source line (,)", () => actions.step("line"), "step-l"),
      button("Job", "To the end of a job (j)", () => actions.step("job"), "step-j"),
    ];
    const options = SPEEDS.map(([label, factor]) =>
      el("option", { value: factor, selected: factor === 1 }, label),
    );
    this.speeds = el("select", { id: "speed", "aria-label": "Speed" }, ...options);
    this.speeds.addEventListener("change", () => actions.speed(Number(this.speeds.value)));
    const reset = button("Reset", "Begin again (r)", () => actions.reset(), "reset");
    const more = button("More", "Steps, sound, files", () => this.toggleMore(more), "more");
    more.setAttribute("aria-expanded", "false");
    const group = (...children: (Node | string)[]) => el("span", { class: "group" }, ...children);
    this.element = el(
      "header",
      {},
      el(
        "div",
        { class: "row", role: "toolbar", "aria-label": "Run" },
        el("h1", {}, "Ravenbrick"),
        group(this.runButton, reset, this.speeds, more, locally),
        el("div", { class: "more row" }, group("Step:", ...steps, this.thread), this.files(button)),
        el("div", { class: "more row" }, sound, keyHelp()),
      ),
      el(
        "div",
        { class: "row readings" },
        ...[this.status, this.time, this.rate, this.place, this.program, this.problem],
      ),
    );
  }

  /** On a small screen, all but the most important controls are folded. */
  private toggleMore(more: HTMLElement): void {
    const open = this.element.classList.toggle("unfolded");
    more.setAttribute("aria-expanded", String(open));
  }

  private files(
    button: (label: string, title: string, act: () => void, id: string) => HTMLButtonElement,
  ): HTMLElement {
    const { actions } = this;
    const input = el("input", {
      type: "file",
      id: "open",
      class: "unseen",
      tabindex: -1,
      "aria-label": "Program or saved run",
      change: () => {
        if (input.files?.[0]) void actions.open(input.files[0]);
        input.value = "";
      },
    });
    return el(
      "span",
      { class: "group" },
      input,
      button("Open …", "A program (.elf) or a saved run (.json)", () => input.click(), "open-file"),
      button(
        "Save run",
        "Program, inputs and seed as a file",
        () => actions.save("file"),
        "save-run",
      ),
      button(
        "Link",
        "The run as a link, in the clipboard",
        () => actions.save("link"),
        "save-link",
      ),
      button("Inputs", "Inputs as a stimulus (.csv)", () => actions.save("inputs"), "save-inputs"),
    );
  }

  frame({ cycles, running, realTimeRatio, stop, place }: Frame): void {
    const ended = stop !== null && stop.reason !== "reached";
    this.runButton.textContent = running ? "Pause" : ended ? "Run again" : "Run";
    this.time.value = running
      ? `${seconds(cycles).toFixed(3)} s`
      : `${seconds(cycles).toFixed(6)} s, cycle ${cycles}`;
    this.rate.value = realTimeRatio > 0 ? `${realTimeRatio.toPrecision(3)} × real time` : "";
    const how = ended ? `Program ended (${stop.reason.replace("_", " ")}): ${stop.message}` : "";
    set(this.program, how);
    this.program.classList.toggle("failed", ended && stop.reason !== "power_off");
    if (!place) {
      this.place.value = "";
      return;
    }
    const line = place.file ? `${place.file.split("/").pop()}:${place.line}` : "no source line";
    const at = place.pc.toString(16).padStart(8, "0").toUpperCase();
    this.place.value = `${at} ${place.function ?? ""} (${line})`;
  }

  setThreads(names: string[]): void {
    if (names.join() === this.names) return;
    this.names = names.join();
    const chosen = this.thread.value;
    const any = el("option", { value: "" }, "any task");
    const others = names.map((name) => el("option", { value: name }, name));
    this.thread.replaceChildren(any, ...others);
    if (names.includes(chosen)) this.thread.value = chosen;
  }

  setSpeed(factor: number): void {
    this.speeds.value = String(factor);
  }

  /** One notch slower (-1) or faster (1). */
  shift(by: number): void {
    const at = SPEEDS.findIndex(([, factor]) => factor === Number(this.speeds.value));
    const next = SPEEDS[at + by];
    if (!next) return;
    this.setSpeed(next[1]);
    this.actions.speed(next[1]);
  }

  /** The program, or news about it. */
  showStatus(text: string): void {
    set(this.status, text);
  }

  /** What the page could not do; the next action takes it away. */
  showError(text: string): void {
    set(this.problem, text);
  }
}

/** Only a change is read aloud. */
function set(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
