// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The page as axe-core judges it (WCAG 2.2 A and AA, and axe's good practice), and by keyboard. */
import { describe, expect } from "vitest";
import { violations, waitUntil, virtualTime, test } from "./harness";

describe("accessibility", () => {
  for (const colorScheme of ["light", "dark"] as const) {
    test(`has no violation before and during a run, ${colorScheme}`, async ({ open, drive }) => {
      const { page } = await open(drive, { colorScheme });
      expect(await violations(page)).toEqual([]);
      await page.click("#run");
      await waitUntil(page, 1.2);
      expect(await violations(page)).toEqual([]);
    });
  }

  test("has no violation on a phone", async ({ open, drive }) => {
    const viewport = { width: 360, height: 740 };
    const { page } = await open(drive, { viewport, hasTouch: true });
    expect(await violations(page)).toEqual([]);
  });

  test("has a violation when a button has no name", async ({ open, drive }) => {
    const { page } = await open(drive);
    await page.$eval("#run", (button) => button.replaceChildren());
    await page.$eval("#run", (button) => button.removeAttribute("title"));
    expect((await violations(page)).join()).toContain("button-name");
  });

  test("is complete by keyboard: every control is reached, Run works", async ({ open, drive }) => {
    const { page } = await open(drive);
    const controls = await page.$$eval(
      "button, input:not([tabindex='-1']), select, [tabindex='0']",
      (all) => all.filter((one) => one.checkVisibility()).length,
    );
    const reached = new Set<string>();
    for (let step = 0; step < controls; step += 1) {
      await page.keyboard.press("Tab");
      reached.add(
        await page.evaluate(() => {
          const all = [...document.querySelectorAll("*")];
          return String(all.indexOf(document.activeElement ?? document.body));
        }),
      );
    }
    expect(reached.size).toBe(controls);
    await page.focus("#run");
    await page.keyboard.press("Enter");
    await waitUntil(page, 1);
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.querySelector("#run")?.textContent === "Run");
    expect(await virtualTime(page)).toBeGreaterThan(1);
  });
});
