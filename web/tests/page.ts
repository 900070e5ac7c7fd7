// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The page in jsdom, anew for each test, with what it sends to the worker. */
import { beforeEach, vi } from "vitest";
import { App } from "../src/app";
import { Kind } from "../src/events";
import type { Command, Frame, Ready } from "../src/protocol";
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

export const READY: Ready = {
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
  image: "1".repeat(64),
  environment: "2".repeat(64),
  judges: true,
};

export const FRAME: Frame = {
  kind: "frame",
  cycles: 48_054_858,
  running: false,
  realTimeRatio: 0,
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
  calls: [],
  variables: {},
  inputs: [],
};

export const sent: Command[] = [];
export let app: App;
let life = new AbortController();

beforeEach(() => {
  // jsdom has no canvas.
  vi.spyOn(HTMLCanvasElement.prototype, "getContext").mockReturnValue(null);
  document.body.innerHTML = '<div id="page"></div>';
  const page = document.getElementById("page") as HTMLElement;
  life.abort();
  life = new AbortController();
  const send = (command: Command) => void (command.kind === "shown" || sent.push(command));
  app = new App(page, { send }, { signal: life.signal });
  app.receive(READY);
  sent.length = 0;
});

export const get = <Kind extends HTMLElement>(selector: string) => {
  const found = document.querySelector<Kind>(selector);
  if (!found) throw new Error(`nothing matches ${selector}`);
  return found;
};
export const inputs = () => sent.filter((c) => c.kind === "input").map((c) => [c.name, c.value]);
export const press = (key: string, target: EventTarget = document.body) => {
  target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
  target.dispatchEvent(new KeyboardEvent("keyup", { key, bubbles: true }));
};
