// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The page of `ravenbrick design --page`: gains that the mouse sets in Chromium. */
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createServer, type AddressInfo } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { beforeAll, describe, expect } from "vitest";
import { COMMAND, darkShare, ravenbrick, screenshot, started, test } from "./harness";

const CANVAS = "canvas.mpl-canvas";

const HEAD = `# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A loop for the page."""
import control
import numpy as np
from ravenbrick.control import TunableLoop
from ravenbrick.model import Diagram, Gain, Inport, Outport, Parameter, Sum


def design():
`;

/** An angle at 40 ms around a speed at 10 ms. */
const TWO_RATES = `${HEAD}
    diagram = Diagram("servo", 0.01)
    away = diagram.add(Sum("Away", signs="+-", sample_time=0.04))
    error = diagram.add(Sum("Error", signs="+-"))
    outer = diagram.add(Gain("Outer", gain=Parameter("Kx", 6.0, "1/s", ""), sample_time=0.04))
    inner = diagram.add(Gain("Inner", gain=2.0))
    diagram.connect_chain(diagram.add(Inport("wanted")), away, outer, error, inner)
    diagram.connect(diagram.add(Inport("speed")), error, 1)
    diagram.connect(diagram.add(Inport("angle")), away, 1)
    diagram.connect_chain(inner, diagram.add(Outport("voltage")))
    plant = control.ss([[0, 1], [0, -20]], [[0], [40]], np.eye(2), np.zeros((2, 1)))
    return TunableLoop.around(plant, diagram, {"angle": 0, "speed": 1}, 2.0)
`;

/** Two coupled wheels with a voltage each. */
const TWO_MOTORS = `${HEAD}
    diagram = Diagram("wheels", 0.01)
    for side, gain in (("left", 1.5), ("right", 0.75)):
        error = diagram.add(Sum(f"error_{side}", signs="+-"))
        diagram.connect(diagram.add(Inport(f"wanted_{side}")), error, 0)
        diagram.connect(diagram.add(Inport(f"speed_{side}")), error, 1)
        gain = diagram.add(Gain(f"gain_{side}", gain=Parameter(f"K_{side}", gain, "V", "")))
        diagram.connect_chain(error, gain, diagram.add(Outport(f"volts_{side}")))
    plant = control.ss([[-10, 3], [3, -12]], [[30, 4], [4, 25]], np.eye(2), np.zeros((2, 2)))
    return TunableLoop.around(
        plant, diagram, {"speed_left": 0, "speed_right": 1}, WANTED
    )
`;
const PAIR = 'driven={"volts_left": 0, "volts_right": 1}, set_point="wanted_left"';

let project = "";

beforeAll(async () => {
  const folder = mkdtempSync(join(tmpdir(), "design-"));
  project = join(folder, "loop");
  await ravenbrick("new", project, "--template", "motor");
  return () => rmSync(folder, { recursive: true });
});

/** A TCP port that nobody listens on. */
async function freePort(): Promise<number> {
  const server = createServer();
  await new Promise<void>((ready) => server.listen(0, "127.0.0.1", ready));
  const { port } = server.address() as AddressInfo;
  await new Promise((closed) => server.close(closed));
  return port;
}

/** Where a slider stands: the lowest is row 0; its track is half as wide as the figure. */
async function onSlider(page: Page, row: number, share: number): Promise<[number, number]> {
  const box = (await page.locator(CANVAS).boundingBox())!;
  const height = 1 - (0.02 + 0.045 * row + 0.015);
  return [box.x + box.width * (0.36 + 0.5 * share), box.y + box.height * height];
}

interface Shown {
  gains: Record<string, number>;
  figures: Record<string, number>;
}

/** Serve a design, set the lowest slider to its middle, end the server: what it had at its end. */
async function tuned(browser: Browser, source: string, name: string): Promise<Shown> {
  writeFileSync(join(project, "design.py"), source);
  const words = ["design", project, "--json", "--page", String(await freePort())];
  const server = await started(COMMAND, ...words);
  const page = await browser.newPage({ viewport: { width: 1280, height: 1000 } });
  const errors: string[] = [];
  page.on("pageerror", (error) => errors.push(error.message));
  await page.goto(server.address);
  await page.locator(CANVAS).waitFor();
  while ((await darkShare(page, CANVAS)) < 0.005) await page.waitForTimeout(100);
  const before = await page.locator(CANVAS).screenshot();
  await page.mouse.move(...(await onSlider(page, 0, 0.5)));
  await page.mouse.down();
  while (before.equals(await page.locator(CANVAS).screenshot())) await page.waitForTimeout(100);
  await page.mouse.up();
  await screenshot(page, `design-${name}`);
  await page.close();
  server.end();
  expect(errors).toEqual([]);
  return JSON.parse(await server.ended) as Shown;
}

describe("the page of a design", () => {
  test("shows a controller of two rates, whose gain the mouse sets", async ({ browser }) => {
    const { gains, figures } = await tuned(browser, TWO_RATES, "rates");
    expect(gains["Kx"]).toBeGreaterThan(11.5);
    expect(gains["Kx"]).toBeLessThan(12.5);
    expect(Object.keys(figures)).toEqual(["settling_time", "overshoot"]);
  });

  test("shows the chosen pair of two actuators", async ({ browser }) => {
    const { gains, figures } = await tuned(browser, TWO_MOTORS.replace("WANTED", PAIR), "pair");
    expect(gains["K_left"]).toBeCloseTo(3, 0);
    expect(gains["K_right"]).toBe(0.75);
    expect(figures["phase_margin_deg"]).toBeGreaterThan(0);
  });

  test("says what to choose where there are two actuators", async () => {
    writeFileSync(join(project, "design.py"), TWO_MOTORS.replace(", WANTED", ""));
    const words = ["design", project, "--page", String(await freePort())];
    await expect(started(COMMAND, ...words)).rejects.toThrow("say which input of the plant each");
  });
});
