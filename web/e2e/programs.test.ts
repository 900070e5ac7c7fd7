// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Other programs on the page: one that plays notes, one that follows a line, one that fails. */
import { execFile } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";
import { describe, expect } from "vitest";
import {
  waitForReset,
  build,
  waitForEnd,
  darkShare,
  waitUntil,
  screenshot,
  ravenbrick,
  test,
} from "./harness";
import { ROOT, VEHICLE } from "./harness";

const LINE = "examples/line-follower";

describe("sound", () => {
  test("of a program is played once it is switched on", async ({ open, view }) => {
    const project = join("examples", "devices", "device.gpr");
    const options = ["-q", "-p", "--config=tools/ravenbrick.cgpr", "-P", project];
    await promisify(execFile)("gprbuild", [...options, "-XDEVICE=loudspeaker"], { cwd: ROOT });
    const image = join(ROOT, "build", "devices", "loudspeaker", "ram", "loudspeaker.elf");
    const { page } = await open(await view(VEHICLE, "--elf", image));
    await page.check("#sound");
    await page.click("#run");
    await waitUntil(page, 1.5);
    const played = await page.getAttribute("label[data-played]", "data-played");
    expect(Number(played)).toBeGreaterThan(1000);
  });
});

describe("the floor", () => {
  test("shows what the light sensor sees below the robot", async ({ open, view }) => {
    const { page } = await open(await view(await build(LINE), "lap"));
    const black = await darkShare(page, "#floor-view");
    expect(black).toBeGreaterThan(0.01);
    await page.selectOption("#speed", "Infinity");
    await page.click("#run");
    await waitUntil(page, 8);
    await screenshot(page, "10-line");
  });
});

describe("a program that fails", () => {
  test("is shown with the line that raised the exception", async ({ open, view }) => {
    const project = join(mkdtempSync(join(tmpdir(), "page ")), "failing");
    await ravenbrick("new", project);
    const source = join(project, "src", "tasks.adb");
    const text = readFileSync(source, "utf-8");
    const raising = text.replace("Presses.Add;\n", "raise Constraint_Error;\n");
    expect(raising).not.toBe(text);
    writeFileSync(source, raising);
    const line = raising.slice(0, raising.indexOf("raise Constraint")).split("\n").length;
    const { page } = await open(await view(project, "press"));
    await page.click("#run");
    await waitForEnd(page, `tasks.adb:${line}`);
    expect(await page.textContent("#source-place")).toBe(`tasks.adb:${line}`);
    const here = await page.textContent("#source-text [aria-current]");
    expect(here?.trim()).toBe("raise Constraint_Error;");
    expect(await page.getAttribute("#program", "class")).toBe("failed");
    await screenshot(page, "12-failed");
    await page.click("#reset");
    await waitForReset(page);
    expect(await page.textContent("#program")).toBe("");
    rmSync(project, { recursive: true });
  });
});
