// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it, vi } from "vitest";
import { App } from "../src/app";
import { Kind } from "../src/events";
import type { Command, Frame, Ready } from "../src/protocol";
import { encodeRun } from "../src/run_file";
import { PLAIN_SESSION } from "../src/session";
import { pack } from "./events";

// jsdom draws nothing; the drawings are looked at in the browser.
vi.mock("uplot", () => ({ default: class {} }));

const input = (name: string, highest = 1, whole = true, unit = "") => ({
  name,
  lowest: name.startsWith("motor") ? -highest : 0,
  highest,
  whole,
  unit,
});

const READY: Ready = {
  kind: "ready",
  session: {
    ...PLAIN_SESSION,
    project: "vehicle",
    tasks: [
      {
        name: "control_task",
        release: "cyclic",
        period_us: 4000,
        deadline_us: 1000,
        priority: 2,
        bound_cycles: 48_055,
      },
    ],
  },
  inputs: [
    ...["left", "right", "orange", "grey"].map((name) => input(`button.${name}`)),
    input("touch.1"),
    input("sensor.1.plugged"),
    input("fault.1.digital_0_low"),
    input("motor.A.hand_angle", 1000, false, "rad"),
    input("motor.B.load_torque", 5, false, "N m"),
    { ...input("battery.voltage", 11.8, false, "V"), lowest: 5 },
    input("fault.coprocessor_checksum", 65_535),
    input("fault.twi_stuck"),
  ],
  channels: {
    signals: ["motor.A.angle", "motor.B.angle", "motor.B.angular_velocity", "battery.voltage"],
    symbols: [{ name: "vehicle_control_left", size: 4 }],
  },
  unobserved: null,
};

const FRAME: Frame = {
  kind: "frame",
  cycles: 48_054_858,
  running: false,
  achieved: 0,
  stop: null,
  lcd: null,
  signals: { "motor.B.angle": Math.PI, "motor.B.angular_velocity": 2, "battery.voltage": 7.9 },
  events: pack([10, Kind.release, 0, 10], [60_000, Kind.completion, 0, 10]),
  scope: new Float64Array(),
  sound: new Int16Array(),
  threads: [{ name: "control_task", priority: 2, state: 1, stack_size: 4096, stack_used: 100 }],
  place: {
    ...{ pc: 0x202000, function: "adainit", offset: 4 },
    ...{ file: "/a/b/vehicle.adb", line: 12, raised: null },
  },
  inputs: [],
};

let sent: Command[] = [];
let app: App;
let life = new AbortController();

beforeEach(() => {
  // jsdom has no canvas.
  vi.spyOn(HTMLCanvasElement.prototype, "getContext").mockReturnValue(null);
  document.body.innerHTML = '<div id="page"></div>';
  sent = [];
  const page = document.getElementById("page") as HTMLElement;
  life.abort();
  life = new AbortController();
  const send = (command: Command) => void (command.kind === "shown" || sent.push(command));
  app = new App(page, { send }, { signal: life.signal });
  app.receive(READY);
  sent = [];
});

const get = <Kind extends HTMLElement>(selector: string) => {
  const found = document.querySelector<Kind>(selector);
  if (!found) throw new Error(`nothing matches ${selector}`);
  return found;
};
const inputs = () => sent.filter((c) => c.kind === "input").map((c) => [c.name, c.value]);
const press = (key: string, target: EventTarget = document.body) => {
  target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
  target.dispatchEvent(new KeyboardEvent("keyup", { key, bubbles: true }));
};

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

  it("has its keys listed on the page", () => {
    const listed = [...document.querySelectorAll("#keys kbd")].map((key) => key.textContent);
    for (const key of ["Space", ".", ",", "j", "r", "a", "d", "s", "t", "Enter", "Esc"]) {
      expect(listed).toContain(key);
    }
  });
});

describe("an error", () => {
  const problem = () => get("#problem").textContent;
  const program = () => get("#program").textContent;

  it("of the page is gone with the next action, and with another image", () => {
    app.receive({ kind: "failure", of: "load", message: "no ELF file" });
    expect([problem(), program()]).toEqual(["no ELF file", ""]);
    get("#step-i").click();
    expect(problem()).toBe("");
    app.receive({ kind: "failure", of: "load", message: "no ELF file" });
    app.receive(READY);
    expect(problem()).toBe("");
  });

  it("of the program stays while it is ended, and is gone after a reset", () => {
    const stop = { reason: "fault" as const, at_cycles: 5, message: "no memory" };
    app.receive({ ...FRAME, stop });
    get("#save-run").click();
    app.receive({ ...FRAME, stop });
    expect([problem(), program()]).toEqual(["", "Program ended (fault): no memory"]);
    app.receive(READY);
    app.receive({ ...FRAME, cycles: 0 });
    expect(program()).toBe("");
  });

  it("is none when the program switched the brick off; it runs again from its beginning", () => {
    const stop = { reason: "power_off" as const, at_cycles: 5, message: "off" };
    app.receive({ ...FRAME, stop });
    expect(get("#program").className).toBe("");
    expect(get("#run").textContent).toBe("Run again");
    sent = [];
    get("#run").click();
    expect(sent.map(({ kind }) => kind)).toEqual(["reset", "run"]);
  });
});

describe("the source", () => {
  const ELF = new Uint8Array([1, 2]);
  const TEXT = ["procedure Vehicle is", "begin", "   null;", "end Vehicle;"].join("\n");
  const answers: Record<string, object> = {
    "./session.json": { json: () => Promise.resolve(READY.session) },
    "./image.elf": { arrayBuffer: () => Promise.resolve(ELF.buffer) },
    "./sources.json": { json: () => Promise.resolve({ "/a/b/vehicle.adb": TEXT }) },
  };
  const file = "/a/b/vehicle.adb";
  const place = { pc: 8, function: "main", offset: 0, file, line: 3, raised: null };
  const fetched = (address: string) => Promise.resolve({ ok: true, ...answers[address] });
  const text = () => get("#source-text").textContent;
  const here = () => document.querySelector("#source-text [aria-current]")?.textContent;

  beforeEach(() => app.begin("", fetched as unknown as typeof fetch));

  it("is shown around the line where the program is paused", () => {
    app.receive(READY);
    app.receive({ ...FRAME, place });
    expect([here(), get("#source-place").textContent]).toEqual(["   null;\n", "vehicle.adb:3"]);
    app.receive({ ...FRAME, place: { ...place, pc: 12, line: 4 } });
    expect(here()).toBe("end Vehicle;\n");
    expect(text()).toContain("procedure Vehicle is");
    app.receive({ ...FRAME, running: true, place: null });
    expect(get("#source").className).toBe("past");
  });

  it("of a failed program is the line that failed, not that of the run-time's last loop", () => {
    app.receive(READY);
    const raised = { file, line: 2 };
    app.receive({ ...FRAME, place: { ...place, file: "/rts/last_chance.adb", raised } });
    expect([here(), get("#source-place").textContent]).toEqual(["begin\n", "vehicle.adb:2"]);
  });

  it("that is not there is told: which file, or that the code has none", () => {
    app.receive(READY);
    app.receive({ ...FRAME, place: { ...place, file: "/gcc/libgcc2.c" } });
    expect(text()).toContain("/gcc/libgcc2.c is not in the project");
    app.receive({ ...FRAME, place: { ...place, file: null, line: null } });
    expect(text()).toContain("The code of main has no source line");
    app.receive(READY);
    expect(text()).toContain("Paused, the program shows");
  });

  it("of another image is not that of the image beside the page", () => {
    app.load(READY.session, new Uint8Array([3]));
    app.receive(READY);
    app.receive({ ...FRAME, place });
    expect(text()).toContain("is not in the project");
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
    const angles = inputs().map(([, value]) => ((value as number) * 180) / Math.PI);
    expect(angles.map(Math.round)).toEqual([45, 40, 0]);
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

describe("sound", () => {
  it("is given to the loudspeaker once it is switched on, faster with the speed", () => {
    const played: [number[], number, number][] = [];
    class Context {
      currentTime = 1;
      destination = {};
      close = () => Promise.resolve();
      createBuffer = (_channels: number, length: number, rate: number) => {
        const samples = new Float32Array(length);
        return { samples, rate, duration: length / rate, getChannelData: () => samples };
      };
      createBufferSource = () => ({
        buffer: null as ReturnType<Context["createBuffer"]> | null,
        playbackRate: { value: 1 },
        connect: () => undefined,
        start() {
          played.push([
            [...(this.buffer?.samples ?? [])],
            this.buffer?.rate ?? 0,
            this.playbackRate.value,
          ]);
        },
      });
    }
    vi.stubGlobal("AudioContext", Context);
    const sound = Int16Array.of(16384, -32768);
    app.receive({ ...FRAME, sound });
    get("#sound").click();
    get<HTMLSelectElement>("#speed").value = "2";
    get("#speed").dispatchEvent(new Event("change"));
    app.receive({ ...FRAME, sound });
    app.receive({ ...FRAME, sound: new Int16Array() });
    vi.unstubAllGlobals();
    expect(played).toEqual([[[0.5, -1], 336_384 / 7, 2]]);
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
    get('[data-input="fault.twi_stuck"]').click();
    expect(inputs().map(([name]) => name)).toEqual([
      "battery.voltage",
      "motor.B.load_torque",
      "fault.coprocessor_checksum",
      "fault.twi_stuck",
    ]);
  });
});

describe("a frame", () => {
  it("turns the hub, shows figures, time and place", () => {
    app.receive(FRAME);
    const hubs = [...document.querySelectorAll(".hub")].map((hub) => hub.getAttribute("transform"));
    expect(hubs[1]).toBe("rotate(-180)");
    expect(get('[data-figure="B.speed"]').textContent).toBe("115 °/s");
    expect(get("#time").textContent).toBe("1.000000 s, cycle 48054858");
    expect(get("#place").textContent).toBe("00202000 adainit (vehicle.adb:12)");
    expect(get("#battery-voltage").textContent).toBe("7.90 V");
  });

  it("shows a missed deadline in the table of tasks", () => {
    app.receive(FRAME);
    const row = get('[data-task="control_task"]');
    expect(row.className).toBe("missed");
    const cells = [...row.querySelectorAll("td")].map((cell) => cell.textContent);
    expect(cells.slice(0, 6)).toEqual(["1", "1248 µs", "1248 µs", "1000 µs", "1", "1000 µs"]);
  });

  it("says how a run ended", () => {
    const stop = { reason: "fault" as const, at_cycles: 5, message: "no memory at 16#0#" };
    app.receive({ ...FRAME, stop });
    const program = get("#program");
    expect(program.textContent).toBe("Program ended (fault): no memory at 16#0#");
    expect(program.className).toBe("failed");
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
    const choice = get<HTMLSelectElement>('[aria-label="Whose job to step"]');
    choice.value = "control_task";
    get("#step-j").click();
    expect(sent.at(-1)).toEqual({ kind: "step", by: "job", thread: 0 });
  });
});

describe("the scope", () => {
  it("asks for signals, pins and symbols, and takes back what is refused", () => {
    app.scopeView.show("vehicle_control_left");
    app.scopeView.show("pin:17");
    expect(app.scopeView.channels).toEqual([
      "signal:motor.B.angular_velocity",
      "symbol:vehicle_control_left",
      "pin:17",
    ]);
    app.receive({ kind: "failure", of: "scope", message: "no such symbol" });
    expect(app.scopeView.channels).not.toContain("pin:17");
    expect(app.scopeView.channels).toContain("symbol:vehicle_control_left");
    expect(get("#problem").textContent).toBe("no such symbol");
  });
});

describe("a saved run", () => {
  it("is replayed when it is opened, and its digest compared", async () => {
    const run = { ...READY.session, until_ms: 1, until_cycles: 48_055, digest: "ab" };
    const text = encodeRun({ run, elf: new Uint8Array([7]) });
    const opened = get<HTMLInputElement>("#open");
    const file = new File([text], "vehicle.run.json");
    Object.assign(file, { text: () => Promise.resolve(text) });
    Object.defineProperty(opened, "files", { value: [file] });
    opened.dispatchEvent(new Event("change"));
    const kinds = () => sent.map((c) => c.kind);
    await vi.waitFor(() => expect(kinds()).toContain("replay"), { timeout: 100_000 });
    app.receive({ kind: "replayed", expected: "ab", found: "cd" });
    expect(get("#problem").textContent).toContain("ANOTHER run");
  });
});

describe("accessibility", () => {
  it("names every control and every picture", () => {
    const controls = document.querySelectorAll("button, input, select, canvas, svg");
    const nameless = [...controls].filter((control) => {
      const name = control.getAttribute("aria-label") ?? control.textContent?.trim();
      const label = control.closest("label")?.textContent?.trim();
      return !name && !label;
    });
    expect(nameless.map((control) => control.outerHTML)).toEqual([]);
    for (const section of document.querySelectorAll("section")) {
      const title = section.getAttribute("aria-labelledby") ?? "";
      expect(document.getElementById(title)?.textContent).toBeTruthy();
    }
  });
});

describe("the beginning", () => {
  it("says what to do when no project lies beside the page", async () => {
    await app.begin("", () => Promise.reject(new Error("offline")));
    expect(get("#status").textContent).toContain("Open a program (.elf)");
  });

  it("says that a link is damaged", async () => {
    await app.begin("#run=AAAA", () => Promise.reject(new Error("offline")));
    expect(get("#problem").textContent).toContain("link");
  });
});
