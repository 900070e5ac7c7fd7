// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Other programs on the page: one that plays notes, one that follows a line. */
import { execFile } from "node:child_process";
import { join } from "node:path";
import { promisify } from "node:util";
import type { Browser } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { inked, launch, open, passes, picture, ravenbrick, ROOT, serve, VEHICLE } from "./harness";

const LINE = "examples/line-follower";
let browser: Browser;

beforeAll(async () => {
  browser = await launch();
});

afterAll(async () => {
  await browser?.close();
});

describe("sound", () => {
  it("of a program is played once it is switched on", async () => {
    const project = join("examples", "devices", "device.gpr");
    const options = ["-q", "-p", "--config=tools/ravenbrick.cgpr", "-P", project];
    await promisify(execFile)("gprbuild", [...options, "-XDEVICE=loudspeaker"], { cwd: ROOT });
    const image = join(ROOT, "build", "devices", "loudspeaker", "ram", "loudspeaker.elf");
    const server = await serve(VEHICLE, "--elf", image);
    const { context, page } = await open(browser, server.address);
    await page.check("#sound");
    await page.click("#run");
    await passes(page, 1.5);
    const played = await page.getAttribute("label[data-played]", "data-played");
    expect(Number(played)).toBeGreaterThan(1000);
    await context.close();
    server.end();
  });
});

describe("the floor", () => {
  it("shows what the light sensor sees below the robot", async () => {
    await ravenbrick("build", LINE);
    const server = await serve(LINE, "lap");
    const { context, page } = await open(browser, server.address);
    const black = await inked(page, "#floor-view");
    expect(black).toBeGreaterThan(0.01);
    await page.selectOption("#speed", "Infinity");
    await page.click("#run");
    await passes(page, 8);
    await picture(page, "10-line");
    await context.close();
    server.end();
  });
});
