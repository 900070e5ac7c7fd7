// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// @vitest-environment jsdom
/** What the page shows, loads and saves. */
import { Blob } from "node:buffer";
import { beforeEach, describe, expect, it, vi } from "vitest";
import { encodeRun } from "../src/run_file";
import { app, FRAME, get, READY, sent } from "./page";
// After the page of the tests, which draws no plots.
import { App } from "../src/app";

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
    sent.length = 0;
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
  const fetched = (address: string) =>
    Promise.resolve({ ok: address in answers, ...answers[address] });
  const text = () => get("#source-text").textContent;
  const here = () => document.querySelector("#source-text [aria-current]")?.textContent;

  beforeEach(async () => {
    await app.begin("", fetched as unknown as typeof fetch);
    app.receive(READY);
    app.receive(FRAME);
    // What comes after the first picture: promises that are there already.
    await new Promise((done) => setTimeout(done));
  });

  it("does not hold up the brick, which is loaded before it comes", async () => {
    const late = (address: string) =>
      address.endsWith("sources.json") ? new Promise<Response>(() => {}) : fetched(address);
    sent.length = 0;
    await app.begin("", late as unknown as typeof fetch);
    expect(sent.map(({ kind }) => kind)).toEqual(["load"]);
    // Those of the page before are gone.
    app.receive(READY);
    app.receive({ ...FRAME, place });
    expect(text()).toContain("is not in the project");
  });

  it("comes when a brick that begins by itself is under way", async () => {
    const asked: string[] = [];
    const noting = (address: string) => (asked.push(address), fetched(address));
    const own = new App(get("#page"), { send: () => undefined });
    own.show();
    await own.begin("", noting as unknown as typeof fetch);
    own.receive(READY);
    own.receive({ ...FRAME, cycles: 0 });
    await new Promise((done) => setTimeout(done));
    expect(asked).not.toContain("./sources.json");
    own.receive(FRAME);
    await vi.waitFor(() => expect(asked).toContain("./sources.json"), { timeout: 100_000 });
  });

  it("and the rest beside the page make a link of a run short", async () => {
    vi.stubGlobal("Blob", Blob);
    const run = { ...READY.session, until_ms: 1, until_cycles: 48_055, digest: "ab" };
    const linked = async (elf: Uint8Array) => {
      app.load(READY.session, elf);
      get("#save-link").click();
      app.receive({ kind: "saved", run, elf });
      await vi.waitFor(() => expect(get("#status").textContent).toContain("copied"));
      return location.hash.split("=")[0];
    };
    expect(await linked(ELF)).toBe("#replay");
    app.receive(READY);
    expect(await linked(new Uint8Array([3]))).toBe("#run");
    vi.unstubAllGlobals();
  });

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

describe("a frame", () => {
  it("turns the hub, shows figures, time and place", () => {
    app.receive(FRAME);
    const hubs = [...document.querySelectorAll(".hub")].map((hub) => hub.getAttribute("transform"));
    expect(hubs[1]).toBe("rotate(-180)");
    const spokes = [...document.querySelectorAll(".hub:first-of-type line")].slice(0, 6);
    const angles = spokes.map((spoke) => spoke.getAttribute("transform"));
    expect(angles).toEqual([0, 1, 2, 3, 4, 5].map((sixth) => `rotate(${60 * sixth})`));
    expect(get('[data-figure="B.speed"]').textContent).toBe("115 °/s");
    expect(get("#time").textContent).toBe("1.000000 s, cycle 48054858");
    expect(get("#place").textContent).toBe("00202000 adainit (vehicle.adb:12)");
    expect(get("#battery-voltage").textContent).toBe("7.90 V");
  });

  it("tells where the vehicle is, and where it looks to", () => {
    app.receive({ ...READY, channels: { ...READY.channels, signals: ["body.x"] } });
    const signals = { "body.x": 1, "body.y": -0.5, "body.heading": Math.PI / 2 };
    app.receive({ ...FRAME, signals });
    expect(get("#pose").textContent).toBe("x 1.00 m, y -0.50 m, 90°");
  });

  it("shows a missed deadline in the table of tasks", () => {
    app.receive(FRAME);
    const row = get('[data-task="control_task"]');
    expect(row.className).toBe("missed");
    const cells = [...row.querySelectorAll("td")].map((cell) => cell.textContent);
    expect(cells.slice(0, 6)).toEqual(["1", "1248 µs", "1248 µs", "1000 µs", "1", "1000 µs"]);
  });
});

describe("the scope", () => {
  it("asks for signals, pins and symbols, and takes back what is refused", () => {
    app.scopeView.addChannel("vehicle_control_left");
    app.scopeView.addChannel("pin:17");
    expect(app.scopeView.channels).toEqual([
      "signal:motor.B.angular_velocity",
      "symbol:vehicle_control_left",
      "pin:17",
    ]);
    expect(sent.at(-1)).toMatchObject({ kind: "scope", period_ms: 1 });
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
