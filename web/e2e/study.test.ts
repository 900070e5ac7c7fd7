// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Gains, predictions, code and share links on the page, with the vehicle's step response. */
import type { Page } from "playwright-core";
import { describe, expect } from "vitest";
import { screenshot, test, VEHICLE, violations, waitForText } from "./harness";

const KP = 'input[data-tunable="functional_P.Kp"]';
const KP_NOW = '[aria-label="Kp in the program"]';

/** Run as fast as possible to an instant and pause there. */
async function runTo(page: Page, seconds: number): Promise<void> {
  await page.selectOption("#speed", "Infinity");
  await page.click("#run");
  // The page itself pauses: it may be minutes further when a busy machine has brought a click.
  // While the worker has not answered yet, a click would ask to run once more.
  await page.waitForFunction((end) => {
    const run = document.querySelector<HTMLButtonElement>("#run");
    const time = Number.parseFloat(document.querySelector("#time")?.textContent ?? "0");
    const there = run?.textContent === "Pause" && time >= end;
    if (there) run.click();
    return there;
  }, seconds);
  await waitForText(page, "#run", /^Run$/);
}

/** Go to another line of the controller and stand there: a run on the way shows the line before. */
async function nextLine(page: Page): Promise<void> {
  const before = await page.textContent("#time");
  await page.click("#step-c");
  await page.waitForFunction((old) => {
    const still = document.querySelector("#code:not(.past)");
    return still && document.querySelector("#time")?.textContent !== old;
  }, before);
}

/** Make the link and give its address. */
async function share(page: Page): Promise<string> {
  await page.click("#save-link");
  await page.waitForFunction(() => location.hash.startsWith("#replay="));
  return page.url();
}

describe("the panels of a lab", () => {
  test("a gain changed during the run replays from a short link", async ({ open, step, view }) => {
    const { page, context } = await open(step);
    expect(await page.textContent(KP_NOW)).toBe("0.3144 V/V");
    await runTo(page, 0.5);
    await page.fill(KP, "1.2");
    await runTo(page, 1.5);
    await waitForText(page, KP_NOW, "1.2 V/V");
    const link = await share(page);
    expect(link.length).toBeLessThan(1000);
    const other = await context.newPage();
    await other.goto(link);
    await waitForText(other, "#status", "The same run again");
    expect(await other.textContent(KP_NOW)).toBe("1.2 V/V");

    const drive = await view(VEHICLE, "drive");
    const elsewhere = await context.newPage();
    await elsewhere.goto(drive + new URL(link).hash);
    await waitForText(elsewhere, "#problem", "vehicle, scenario step in another environment");
  });

  test("a gain is kept when the run begins again, and forgotten by Reset", async ({
    open,
    step,
  }) => {
    const { page } = await open(step);
    await page.fill('[aria-label="Kp (V/V), as a number"]', "0.9");
    await page.keyboard.press("Enter");
    await page.click("#tuning-again");
    await runTo(page, 0.2);
    expect(await page.textContent(KP_NOW)).toBe("0.9 V/V");
    await page.click("#reset");
    await waitForText(page, KP_NOW, "0.3144 V/V");
  });

  test("a sketch by keyboard and pointer is compared with the run", async ({ open, step }) => {
    const { page } = await open(step);
    const sketch = page.locator("#prediction fieldset", { hasText: "left wheel" });
    for (const [at, value] of [
      ["0.95", "0"],
      ["1.0", "0"],
    ] as const) {
      await sketch.getByRole("spinbutton").nth(0).fill(at);
      await sketch.getByRole("spinbutton").nth(1).fill(value);
      await page.keyboard.press("Enter");
    }
    const plot = sketch.locator("svg");
    await plot.hover({ position: { x: 200, y: 40 } });
    await page.mouse.down();
    await page.mouse.up();
    expect(await sketch.locator("li").count()).toBe(3);
    await sketch.getByText("Fix my sketch").click();
    await runTo(page, 2);
    await sketch.getByText("Mean difference:").waitFor();
    expect(await sketch.locator(".curve.measured").count()).toBeGreaterThan(0);
    expect(await violations(page)).toEqual([]);
    await screenshot(page, "10-study");
  });

  test("diagram, C and Ada show the line of the controller", async ({ open, step }) => {
    const { page } = await open(step, { colorScheme: "dark" });
    await runTo(page, 1.1);
    do {
      await nextLine(page);
    } while (!(await page.textContent("#code-block")));
    expect(await page.textContent("#code-c-place")).toMatch(/^functional\.c:\d+$/);
    expect(await page.textContent("#code-ada-place")).toMatch(/^driving\.adb:\d+$/);
    expect(await page.textContent("#code-ada-text [aria-current]")).toContain("Step");
    const block = (await page.textContent("#code-block")) ?? "";
    expect(await page.getAttribute(".pane .chosen", "data-blocks")).toContain(block);
    expect(await violations(page)).toEqual([]);
    await page.locator("#code").screenshot({ path: "../out/page/11-code.png" });
  });

  test("the checks are judged in the tab as ravenbrick run judges them", async ({ open, step }) => {
    const { page } = await open(step);
    await page.fill("#prediction input", "0.3");
    await page.click("#prediction button");
    await runTo(page, 4.1);
    await waitForText(page, "#checks-state", "all met");
    expect(await page.locator("#check-list .met").count()).toBe(3);
    expect(await page.textContent("#step-figures")).toContain("settled after 39");
    expect(await page.textContent("#prediction .answer")).toMatch(/Measured: 0\.39\d* s/);
    expect(await violations(page)).toEqual([]);
    await screenshot(page, "12-judged");
  });
});
