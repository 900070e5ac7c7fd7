// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The keyboard: keys drive the brick unless a text field is edited or a control needs them. */
import { el } from "./dom";

/** Receivers of keys; a method that returns `boolean` says whether the key was one of its own. */
export interface KeyActions {
  input(name: string, value: number): void;
  joystick(key: string, down: boolean): boolean;
  command(key: string): boolean;
}

const BUTTON_KEYS: Record<string, string> = {
  ArrowLeft: "button.left",
  ArrowRight: "button.right",
  Enter: "button.orange",
  Escape: "button.grey",
};

const HELP: [string, string][] = [
  ["Space", "run, pause"],
  [".  ,  j", "step an instruction, a source line, a job"],
  ["r", "reset"],
  ["+  −", "faster, slower"],
  ["←  →  Enter  Esc", "the brick's left, right, orange and grey button"],
  ["a  d  s", "joystick to the left, to the right, centred"],
  ["t", "first touch sensor, down while the key is"],
];

/** Keys that a focused control needs for itself. */
const OWN_KEYS: [string, string[]][] = [
  ["input[type='range']", ["ArrowLeft", "ArrowRight"]],
  ["input[type='checkbox']", [" "]],
  ["button, summary, select", [" ", "Enter"]],
];

const TEXT_FIELDS =
  "input:not([type]), input[type='text'], input[type='number'], textarea, [contenteditable]";

/** The list of keys, folded. */
export function keyHelp(): HTMLElement {
  const rows = HELP.flatMap(([keys, meaning]) => [
    el("dt", {}, ...keys.split("  ").map((key) => el("kbd", {}, key))),
    el("dd", {}, meaning),
  ]);
  const note =
    "Keys work unless a text field is being edited; Escape leaves it. On a control chosen with " +
    "Tab, Space and Enter use the control, and arrows move a slider.";
  const list = el("div", {}, el("dl", {}, ...rows), el("p", { class: "note" }, note));
  return el("details", { id: "keys" }, el("summary", {}, "Keys"), list);
}

export class Keyboard {
  /** What the keys hold that are down: each callback releases one, wherever the focus is then. */
  private readonly held = new Map<string, () => void>();
  private byPointer = false;

  constructor(
    private readonly actions: KeyActions,
    options: { signal?: AbortSignal },
  ) {
    const on = <Name extends keyof DocumentEventMap>(
      name: Name,
      act: (event: DocumentEventMap[Name]) => void,
    ) => document.addEventListener(name, act, { ...options, capture: name === "pointerdown" });
    on("keydown", (event) => this.handleDown(event));
    on("keyup", (event) => this.release(event.key));
    on("pointerdown", () => (this.byPointer = true));
    on("change", ({ target }) => this.releaseFocus(target, "select, input"));
    on("click", ({ target }) => this.releaseFocus(target, "button, summary"));
    addEventListener(
      "blur",
      () => [...this.held.keys()].forEach((key) => this.release(key)),
      options,
    );
  }

  /** A control that was used by pointer does not keep the keyboard. */
  private releaseFocus(target: EventTarget | null, controls: string): void {
    const control = target instanceof Element ? target.closest<HTMLElement>(controls) : null;
    if (this.byPointer && control === document.activeElement) control?.blur();
  }

  private handleDown(event: KeyboardEvent): void {
    this.byPointer = false;
    const { key } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const target = event.target instanceof HTMLElement ? event.target : document.body;
    if (target.matches(TEXT_FIELDS)) {
      if (key === "Escape") target.blur();
      return;
    }
    if (OWN_KEYS.some(([controls, keys]) => keys.includes(key) && target.matches(controls))) return;
    if (this.press(key, event.repeat)) event.preventDefault();
  }

  private press(key: string, repeat: boolean): boolean {
    const button = BUTTON_KEYS[key];
    const letter = key.toLowerCase();
    if (repeat && (button || key === " " || letter === "t")) return true;
    if (button) {
      this.actions.input(button, 1);
      this.held.set(letter, () => this.actions.input(button, 0));
      return true;
    }
    if (!this.actions.joystick(letter, true)) return this.actions.command(key);
    this.held.set(letter, () => this.actions.joystick(letter, false));
    return true;
  }

  private release(key: string): void {
    const letter = key.toLowerCase();
    this.held.get(letter)?.();
    this.held.delete(letter);
  }
}
