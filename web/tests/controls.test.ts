// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// @vitest-environment jsdom
/** What a person presses, turns and plugs, by pointer, keys and gamepad. */
import { describe, expect, it } from "vitest";
import { app, FRAME, get, inputs, press, READY, sent } from "./page";

describe("the brick's face", () => {
  it("has four buttons that are down while they are held", () => {
    const orange = get('[aria-label^="Orange button"]');
    orange.dispatchEvent(new Event("pointerdown"));
    expect(orange.getAttribute("aria-pressed")).toBe("true");
    orange.dispatchEvent(new Event("pointerup"));
    orange.dispatchEvent(new Event("pointercancel"));
    expect(inputs()).toEqual([
      ["button.orange", 1],
      ["button.orange", 0],
    ]);
  });

  it("is played by keys, except while somebody types", () => {
    press("ArrowLeft");
    press("Escape");
    press("Enter", get("#channel"));
    expect(inputs()).toEqual([
      ["button.left", 1],
      ["button.left", 0],
      ["button.grey", 1],
      ["button.grey", 0],
    ]);
  });
});

describe("the keyboard", () => {
  const down = (key: string, target: EventTarget = document.body) =>
    target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
  const up = (key: string, target: EventTarget = document.body) =>
    target.dispatchEvent(new KeyboardEvent("keyup", { key, bubbles: true }));

  it.each([
    ...["#run", "#reset", "#speed", "#step-l", "#sound", "#keys summary", "#timeline-view"],
    ...['[aria-label^="Joystick"]', '[data-input="battery.voltage"]', '[data-input="touch.1"]'],
  ])("drives the brick after %s was used", (control) => {
    get(control).focus();
    press("a", get(control));
    press("t", get(control));
    expect(inputs().map(([name]) => name)).toEqual(["motor.A.hand_angle", "touch.1", "touch.1"]);
  });

  it("leaves Space and Enter to a focused button, arrows to a slider", () => {
    for (const key of [" ", "Enter"]) {
      expect(down(key, get("#reset"))).toBe(true);
      expect(down(key, get("#speed"))).toBe(true);
    }
    expect(down(" ", get("#sound"))).toBe(true);
    expect(down("ArrowLeft", get('[aria-label^="Joystick"]'))).toBe(true);
    expect(sent).toEqual([]);
  });

  it("is not held by a control that was used with the pointer", () => {
    for (const [selector, event] of [
      ["#speed", "change"],
      ['[data-input="battery.voltage"]', "change"],
      ["#reset", "click"],
    ] as const) {
      const control = get(selector);
      control.focus();
      control.dispatchEvent(new Event("pointerdown", { bubbles: true }));
      control.dispatchEvent(new Event(event, { bubbles: true }));
      expect(document.activeElement).toBe(document.body);
    }
    const speed = get("#speed");
    speed.focus();
    down("ArrowDown", speed);
    speed.dispatchEvent(new Event("change", { bubbles: true }));
    expect(document.activeElement).toBe(speed);
  });

  it("types in a text field until Escape", () => {
    const field = get("#channel");
    field.focus();
    for (const key of ["a", "t", " ", "r"]) expect(down(key, field)).toBe(true);
    expect(sent).toEqual([]);
    press("Escape", field);
    expect(document.activeElement).toBe(document.body);
    expect(sent).toEqual([]);
  });

  it("lets go of a key wherever the focus is then, and when the window loses it", () => {
    down("t");
    up("t", get("#channel"));
    down("Enter");
    dispatchEvent(new Event("blur"));
    expect(inputs()).toEqual([
      ["touch.1", 1],
      ["touch.1", 0],
      ["button.orange", 1],
      ["button.orange", 0],
    ]);
  });

  it("reaches what can be reached in the order of the page", () => {
    const places = [...document.querySelectorAll<HTMLElement>("[tabindex]")];
    expect(Math.max(...places.map((place) => place.tabIndex))).toBe(0);
  });

  it("has its keys listed on the page", () => {
    const listed = [...document.querySelectorAll("#keys kbd")].map((key) => key.textContent);
    for (const key of ["Space", ".", ",", "j", "r", "a", "d", "s", "t", "Enter", "Esc"]) {
      expect(listed).toContain(key);
    }
  });
});

describe("what is plugged in", () => {
  it("shows a touch sensor to press and its cable to pull", () => {
    const touch = get('button[data-input="touch.1"]');
    press(" ", touch);
    const cable = get<HTMLInputElement>('[data-input="sensor.1.plugged"]');
    expect(cable.checked).toBe(true);
    cable.click();
    expect(inputs()).toEqual([
      ["touch.1", 1],
      ["touch.1", 0],
      ["sensor.1.plugged", 0],
    ]);
  });

  it("changes with another sensor, which begins the run again", () => {
    app.load(READY.session, new Uint8Array([1]));
    const choice = get<HTMLSelectElement>('[aria-label="Sensor at port 3"]');
    choice.value = "ultrasonic";
    choice.dispatchEvent(new Event("change"));
    const last = sent.at(-1);
    expect(last?.kind === "load" && last.session.configuration.sensors).toEqual({
      "1": { kind: "touch" },
      "3": { kind: "ultrasonic" },
    });
  });
});

describe("the joystick", () => {
  it("shows the angle that a scenario sets", () => {
    const inputs = [{ at_cycles: 1, name: "motor.A.hand_angle", value: -Math.PI / 6 }];
    app.receive({ ...READY, session: { ...READY.session, inputs } });
    const angle = () => get<HTMLInputElement>('[aria-label^="Joystick angle"]').value;
    app.receive({ ...FRAME, cycles: 0 });
    expect(angle()).toBe("0");
    app.receive({ ...FRAME, cycles: 1 });
    expect(angle()).toBe("-30");
    // By hand it is turned on from there, whatever a late frame says.
    press("a");
    app.receive({ ...FRAME, cycles: 2 });
    expect(angle()).toBe("-25");
  });

  it("turns by slider and keys, to the left positive", () => {
    const range = get<HTMLInputElement>('[aria-label^="Joystick angle"]');
    range.value = "45";
    range.dispatchEvent(new Event("input"));
    press("d");
    press("s");
    expect([range.min, range.max]).toEqual(["-90", "90"]);
    range.value = "30";
    range.dispatchEvent(new Event("input"));
    [...document.querySelectorAll("#joystick button")].forEach((b) => (b as HTMLElement).click());
    const angles = inputs().map(([, value]) => ((value as number) * 180) / Math.PI);
    expect(angles.map(Math.round)).toEqual([45, 40, 0, 30, 0]);
  });
});

describe("a gamepad", () => {
  it("turns the joystick by its stick and presses by its first button, beyond a dead zone", () => {
    const pad = { axes: [0.05], buttons: [{ pressed: false }] };
    const value = () => [null, pad];
    Object.defineProperty(navigator, "getGamepads", { value, configurable: true });
    try {
      app.receive(FRAME);
      expect(inputs()).toEqual([]);
      pad.axes[0] = -0.5;
      app.receive(FRAME);
      app.receive(FRAME);
      pad.buttons[0] = { pressed: true };
      app.receive(FRAME);
      pad.axes[0] = 0;
      pad.buttons[0] = { pressed: false };
      app.receive(FRAME);
    } finally {
      Object.defineProperty(navigator, "getGamepads", { value: undefined, configurable: true });
    }
    expect(inputs()).toEqual([
      ["motor.A.hand_angle", Math.PI / 4],
      ["touch.1", 1],
      ["motor.A.hand_angle", -0],
      ["touch.1", 0],
    ]);
  });
});

describe("the surroundings", () => {
  it("have battery, load and faults to set", () => {
    for (const [name, value] of [
      ["battery.voltage", "6.5"],
      ["motor.B.load_torque", "0.1"],
      ["fault.coprocessor_checksum", "3"],
    ] as const) {
      const slider = get<HTMLInputElement>(`[data-input="${name}"]`);
      slider.value = value;
      slider.dispatchEvent(new Event("input"));
    }
    const shown = get('[data-input="fault.coprocessor_checksum"] + output').textContent;
    expect(shown?.trim()).toBe("3");
    const load = get<HTMLInputElement>('[data-input="motor.B.load_torque"]');
    expect(Number(load.max)).toBe(-Number(load.min));
    get('[data-input="fault.twi_stuck"]').click();
    expect(inputs().map(([name]) => name)).toEqual([
      "battery.voltage",
      "motor.B.load_torque",
      "fault.coprocessor_checksum",
      "fault.twi_stuck",
    ]);
  });
});

describe("running", () => {
  it("is started and paused by button and space, stepped by keys", () => {
    get("#run").click();
    app.receive({ ...FRAME, running: true });
    press(" ");
    for (const key of [".", ",", "j"]) press(key);
    press("r");
    const told = sent.map((c) => (c.kind === "step" ? `${c.kind} ${c.by} ${c.thread}` : c.kind));
    expect(told).toEqual([
      ...["run", "pause", "step instruction -1", "step line -1", "step job -1", "reset"],
    ]);
  });

  it("gets slower and faster", () => {
    press("-");
    press("+");
    press("+");
    expect(sent.map((c) => c.kind === "speed" && c.factor)).toEqual([0.25, 1, 2]);
  });

  it("steps the jobs of the chosen task", () => {
    app.receive(FRAME);
    const choice = get<HTMLSelectElement>('[aria-label="Task whose jobs are stepped"]');
    choice.value = "control_task";
    get("#step-j").click();
    expect(sent.at(-1)).toEqual({ kind: "step", by: "job", thread: 0 });
  });
});
