// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
import { statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { describe, expect } from "vitest";
import {
  waitForReset,
  download,
  waitForEnd,
  darkShare,
  waitForCached,
  waitForServiceWorker,
  waitFor,
  waitUntil,
  screenshot,
  measureRate,
  ravenbrick,
  ROOT,
  waitForText,
  virtualTime,
  test,
  VEHICLE,
} from "./harness";

interface Saved {
  digest: string;
  until_ms: number;
}

/** A scenario of this length in which nothing happens: the page's own surroundings. */
function emptyScenario(duration_ms: number): string {
  const file = join(ROOT, "out", "page", "idle.toml");
  writeFileSync(
    file,
    `schema_version = 1\nname = "idle"\nseed = 1\nduration_ms = ${duration_ms}\n`,
  );
  return file;
}

describe("sample: the drive in the tab", () => {
  test("has the digest of the native run and replays on it", async ({ open, drive }) => {
    const native = await ravenbrick("run", VEHICLE, "drive");
    const { page, requests } = await open(drive);
    await screenshot(page, "1-ready");
    await page.selectOption("#speed", "2");
    await page.click("#run");
    await waitUntil(page, 3);
    await screenshot(page, "2-driving");
    await page.selectOption("#speed", "Infinity");
    expect(await darkShare(page, "#lcd")).toBeGreaterThan(0.02);
    expect(await darkShare(page, "#floor-view")).toBeGreaterThan(0.001);
    expect(await darkShare(page, "#timeline-view")).toBeGreaterThan(0.005);
    await waitForEnd(page, "ended (power off)");
    await screenshot(page, "3-ended");
    const saved = await download(page, "#save-run");
    expect((JSON.parse(saved.text) as { digest: string }).digest).toBe(native["trace_digest"]);
    const replay = ["run", VEHICLE, "drive", "--replay", saved.path];
    expect((await ravenbrick(...replay))["same_as_replayed"]).toBe(true);
    const elsewhere = requests.filter((url) => !/^blob:/.test(url) && !url.startsWith(drive));
    expect(elsewhere).toEqual([]);
  });
});

describe("steering by hand", () => {
  test("gives the same run again as file, link and inputs", async ({ open, free }) => {
    const { page, context } = await open(free);
    await page.selectOption("#speed", "5");
    await page.keyboard.press("Space");
    await waitUntil(page, 1);
    await page.keyboard.down("t");
    await waitFor(page, 0.3);
    await page.keyboard.up("t");
    await waitFor(page, 2.7);
    for (let turn = 0; turn < 4; turn += 1) await page.keyboard.press("a");
    await waitFor(page, 3);
    await page.keyboard.press("s");
    await page.keyboard.press("Space");
    const pose = (await page.textContent("#pose")) ?? "";
    expect(Math.abs(Number(/(-?\d+)°/.exec(pose)?.[1]))).toBeGreaterThan(5);
    await screenshot(page, "4-by-hand");

    const saved = await download(page, "#save-run");
    const { digest, until_ms } = JSON.parse(saved.text) as Saved;
    const shown_us = Math.round((await virtualTime(page)) * 1e6);
    expect(Math.ceil(shown_us / 1000)).toBe(until_ms);
    const inputs = await download(page, "#save-inputs");
    expect(inputs.text).toMatch(/^at_cycles,motor\.A\.hand_angle,touch\.1\n/);
    const idle = emptyScenario(until_ms);
    const again = await ravenbrick("run", VEHICLE, idle, "--replay", saved.path);
    expect(again["same_as_replayed"]).toBe(true);
    const fed = await ravenbrick("run", VEHICLE, idle, "--stimulus", inputs.path);
    expect(fed["trace_digest"]).toBe(digest);

    await page.click("#save-link");
    await page.waitForFunction(() => location.hash.startsWith("#replay="));
    const link = page.url();
    const other = await context.newPage();
    await other.goto(link);
    await other.waitForFunction(
      () => /same run again|ANOTHER/.test(document.querySelector(".readings")?.textContent ?? ""),
      { timeout: 300_000 },
    );
    const same = `The same run again: trace digest ${digest}`;
    expect(await other.textContent("#status")).toBe(same);
    await page.click("#reset");
    await page.setInputFiles("#open", saved.path);
    await waitForText(page, "#status", same);
  });

  test("plugs, presses and breaks things", async ({ open, free }) => {
    const { page } = await open(free);
    await page.selectOption('[aria-label="Sensor at port 4"]', "ultrasonic");
    await page.waitForSelector('[data-input="distance.4"]');
    await page.click("#run");
    await page.uncheck('[data-input="sensor.1.plugged"]');
    await page.fill('[data-input="battery.voltage"]', "7.08");
    await waitUntil(page, 2);
    expect(await page.textContent("#battery-voltage")).toBe("7.08 V");
    await page.hover('[aria-label^="Orange"]');
    await page.mouse.down();
    expect(await page.getAttribute('[aria-label^="Orange"]', "aria-pressed")).toBe("true");
    await screenshot(page, "5-faults");
    await page.mouse.up();
    await page.click("#reset");
    await waitForReset(page);
    await page.click("#run");
    await waitUntil(page, 1);
    await page.check('[data-input="fault.twi_stuck"]');
    await waitForEnd(page, "link to motors lost");
  });
});

describe("time", () => {
  test("keeps to real time; steps by instruction, line and job", async ({ open, drive }) => {
    const { page } = await open(drive);
    await page.click("#run");
    await waitUntil(page, 0.2);
    // A machine with other work is slower, but what is late is not made up for. A picture may be
    // a second late.
    const rate = await measureRate(page, 5);
    expect(rate).toBeLessThan(1.5);
    await page.selectOption("#speed", "0.1");
    await waitFor(page, 0.02);
    const slow = await measureRate(page, 0.5);
    expect(slow).toBeLessThan(0.15);
    expect(rate).toBeGreaterThan(2 * slow);
    await page.click("#run");
    await page.waitForFunction(() => document.querySelector("#run")?.textContent === "Run");
    const places: string[] = [];
    // From the idle loop, steps by line lead into handlers, through the vectors at address 0.
    for (const button of ["#step-i", "#step-i", ...Array(6).fill("#step-l"), "#step-j"]) {
      const before = await page.textContent("#time");
      await page.click(button);
      await page.waitForFunction((old) => {
        return document.querySelector("#time")?.textContent !== old;
      }, before);
      places.push((await page.textContent("#place")) ?? "");
      const [, name, line] = /\((.*):(\d+)\)$/.exec(places.at(-1) ?? "") ?? [];
      expect(await page.textContent("#source-place")).toBe(name ? `${name}:${line}` : "");
    }
    for (const place of places.slice(2, 8)) {
      expect(place).toMatch(/\.(ad[bs]|[cS]):\d+/);
      expect(place).not.toMatch(/^0000/);
    }
    expect(await page.textContent("#source-text [aria-current]")).toBeTruthy();
    await page.fill("#channel", "symbol:vehicle_control_left");
    await page.keyboard.press("Enter");
    await page.selectOption('[aria-label="Width of the schedule"]', "10");
    await page.click("#step-j");
    await screenshot(page, "6-stepped");
    expect(await page.textContent('[aria-label="Shown channels"]')).toContain("control_left");
    await page.fill("#channel", "symbol:nonsense");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() =>
      document.querySelector("#problem")?.textContent?.includes("nonsense"),
    );
    await page.click("#step-i");
    expect(await page.textContent("#problem")).toBe("");
  });
});

describe("small and off-line", () => {
  test("fits a phone, in the dark too", async ({ open, drive }) => {
    const phone = { width: 360, height: 740 };
    const { page } = await open(drive, {
      viewport: phone,
      colorScheme: "dark",
      hasTouch: true,
      isMobile: true,
    });
    await page.selectOption("#speed", "20");
    await page.click("#run");
    await waitUntil(page, 3);
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    expect(width).toBeLessThanOrEqual(phone.width);
    await screenshot(page, "7-phone-dark", false);
  });

  test("works without its server once it was loaded", async ({ open, drive }) => {
    const { page, context } = await open(drive);
    await page.evaluate(() => navigator.serviceWorker.ready.then(() => undefined));
    // The second visit goes through the service worker and fills its cache.
    await page.reload();
    await waitForServiceWorker(page);
    await waitForCached(page, "worst_paths.json");
    await context.setOffline(true);
    await page.reload();
    await page.waitForFunction(() => document.title.includes("–"));
    await page.click("#run");
    await waitUntil(page, 0.2);
  });

  test("is small and paints soon", async ({ open, drive }) => {
    const packed = statSync(join(ROOT, "host", "src", "ravenbrick", "page.zip")).size;
    const { page } = await open(drive);
    const paint = await page.evaluate(() =>
      performance.getEntriesByName("first-contentful-paint").map((entry) => entry.startTime),
    );
    console.log(`page: ${packed} bytes packed, first paint ${paint[0]?.toFixed(0)} ms`);
    expect(packed).toBeLessThan(640_000);
    expect(paint[0]).toBeLessThan(10_000);
    expect(await page.textContent("#status")).toContain("vehicle");
  });
});
