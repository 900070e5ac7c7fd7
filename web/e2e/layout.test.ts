// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** What a person sees and reaches: without scrolling, by finger, by key, and from the disk. */
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { describe, expect } from "vitest";
import { waitForReset, waitUntil, screenshot, test } from "./harness";

/** Elements that are not wholly inside the window. */
const outside = (page: Page, selectors: string[]) =>
  page.evaluate(
    (wanted) =>
      wanted.filter((selector) => {
        const { top, left, bottom, right } =
          document.querySelector(selector)?.getBoundingClientRect() ?? new DOMRect(-1);
        return top < 0 || left < 0 || bottom > innerHeight || right > innerWidth;
      }),
    selectors,
  );

const joystick = (page: Page) => page.inputValue('[aria-label^="Joystick"]');

describe("the layout", () => {
  for (const [width, height] of [
    [1920, 1080],
    [1920, 940],
    [1366, 768],
  ] as const) {
    test(`shows drive and instruments at once, ${width} by ${height}`, async ({ open, drive }) => {
      const { page } = await open(drive, { viewport: { width, height } });
      await page.selectOption("#speed", "5");
      await page.click("#run");
      await waitUntil(page, 3);
      await page.click("#run");
      const drivePart = ["#run", "#save-run", "#keys", "#face", "#hand", "#floor"];
      const instruments = ["#scope", "#scope-plot", "#source", "#timeline", "#timeline-view"];
      expect(await outside(page, [...drivePart, ...instruments])).toEqual([]);
      expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(width);
      if (height === 1080) await screenshot(page, "11-wide");
    });
  }

  for (const [width, height] of [
    [390, 844],
    [360, 640],
  ] as const) {
    test(`has the controls in reach on a phone, ${width} by ${height}`, async ({ open, drive }) => {
      const viewport = { width, height };
      const phone = { viewport, hasTouch: true, isMobile: true };
      const { page } = await open(drive, phone);
      const reached = ["#run", "#lcd", "#floor-view", "#joystick input", "#hand .touch"];
      expect(await outside(page, reached)).toEqual([]);
      await page.tap("#more");
      await page.locator("#keys summary").scrollIntoViewIfNeeded();
      const small = await page.$$eval("button, select, summary, .switch, input", (all) =>
        all
          .filter((one) => one.checkVisibility() && !one.matches(".unseen, .switch input"))
          .map((one) => [one.outerHTML.slice(0, 80), one.getBoundingClientRect()] as const)
          .filter(([, { height, width }]) => Math.min(height, width) < 43.9)
          .map(([html]) => html),
      );
      expect(small).toEqual([]);
      // Wherever somebody looks, the two stay.
      await page.evaluate(() => document.querySelector("#surroundings")?.scrollIntoView());
      expect(await outside(page, ["#joystick input", "#hand .touch"])).toEqual([]);
      expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(width);
    });
  }
});

describe("the keyboard", () => {
  test("drives after any control was clicked", async ({ open, drive }) => {
    const { page } = await open(drive);
    await page.selectOption("#speed", "2");
    await page.keyboard.press("Space");
    await waitUntil(page, 0.1);
    const clicked = ["#reset", "#sound", '[data-input="battery.voltage"]', "#keys summary"];
    for (const [turn, control] of clicked.entries()) {
      await page.click(control);
      await waitForReset(page);
      await page.keyboard.press("a");
      expect(await joystick(page)).toBe(String(5 * (turn + 1)));
    }
    // A list of choices that is focused is not searched by the keys that drive.
    await page.focus("#speed");
    await page.keyboard.press("d");
    expect([await joystick(page), await page.inputValue("#speed")]).toEqual(["15", "2"]);
    // Space runs after a click; on a button that was reached by Tab, it is the button's.
    await page.click("#keys summary");
    await page.keyboard.press("Space");
    await waitUntil(page, 0.1);
    await page.focus("#reset");
    await page.keyboard.press("Space");
    await waitForReset(page);
    await page.fill("#channel", "");
    await page.focus("#channel");
    await page.keyboard.type("sat");
    expect(await page.inputValue("#channel")).toBe("sat");
  });
});

describe("from the disk", () => {
  test("says what to do, since a browser runs no page of files", async ({ browser, drive }) => {
    const page = await browser.newPage();
    const file = join(mkdtempSync(join(tmpdir(), "page-")), "index.html");
    writeFileSync(file, await (await fetch(drive)).text());
    await page.goto(`file://${file}`);
    await page.waitForSelector("#late", { state: "visible" });
    expect(await page.innerText("#late")).toContain("run ravenbrick view PROJECT");
    await page.close();
  });
});
