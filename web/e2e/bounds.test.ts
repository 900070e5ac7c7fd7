// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Jobs on the page against the bounds that `ravenbrick analyse` proved. */
import type { Page } from "playwright-core";
import { describe, expect } from "vitest";
import { waitForEnd, waitUntil, screenshot, test } from "./harness";

interface Session {
  tasks: { bound_cycles: number | null }[];
}

/** The cells of a task's row. */
const row = (page: Page, task: string) =>
  page.$eval(`[data-task="${task}"]`, (element) => ({
    missed: element.className === "missed",
    cells: [...element.querySelectorAll("td")].map((cell) => cell.textContent ?? ""),
  }));

describe("response times", () => {
  test("stay below their bounds in the whole drive", async ({ open, drive, bounds }) => {
    const { page } = await open(drive);
    await page.selectOption('[aria-label="Width of the schedule"]', "10");
    await page.click("#run");
    await waitUntil(page, 4);
    await page.click("#run");
    await screenshot(page, "8-bounds");
    await page.selectOption("#speed", "Infinity");
    await page.click("#run");
    await waitForEnd(page, "ended (power off)");
    for (const { name, response_bound_cycles, observed } of bounds) {
      const { missed, cells } = await row(page, name);
      const [, , , , misses, bound, share] = cells;
      expect([missed, misses]).toEqual([false, "0"]);
      const us = (response_bound_cycles * 7e3) / 336_384;
      expect(bound).toBe(`${us.toFixed(0)} µs`);
      const seen = (100 * observed.response_cycles) / response_bound_cycles;
      expect(seen).toBeLessThanOrEqual(100);
      expect(share).toBe(`${seen.toFixed(1)} %`);
    }
  });

  test("above their bound are shown as such", async ({ open, drive }) => {
    const { page } = await open(drive, {}, async (made) => {
      await made.route("**/session.json", async (route) => {
        const answer = await route.fetch();
        const session = (await answer.json()) as Session;
        for (const task of session.tasks) task.bound_cycles = 2000;
        await route.fulfill({ response: answer, json: session });
      });
    });
    await page.selectOption("#speed", "5");
    await page.click("#run");
    await waitUntil(page, 3);
    await page.click("#run");
    const { missed, cells } = await row(page, "control_task");
    expect([missed, cells[4]]).toEqual([true, "0"]);
    expect(Number.parseFloat(cells[6] ?? "")).toBeGreaterThan(100);
    await screenshot(page, "9-beyond-bounds");
  });
});
