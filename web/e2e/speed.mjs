// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// `node speed.mjs ADDRESS SECONDS [KEY]`: times real speed of the page at ADDRESS, as fast as it
// can, over that many seconds of the wall; KEY is pressed first. Prints JSON: the ratio, and when
// the page first painted and its brick was ready, in ms from the beginning of loading.
import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

const [address, seconds, key] = process.argv.slice(2);
const paths = [process.env.RAVENBRICK_CHROMIUM ?? "", "/usr/bin/chromium-headless-shell"];
const executablePath = paths.find((path) => existsSync(path));
if (!executablePath)
  throw new Error("no Chromium; install the Debian package chromium-headless-shell");

const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--mute-audio"] });
const page = await browser.newPage();
page.setDefaultTimeout(120_000);
await page.goto(address);
await page.waitForFunction(() => document.title.includes("–"));
const [paint_ms, ready_ms] = await page.evaluate(() => [
  performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? null,
  performance.now(),
]);

/** Wall and virtual time, in seconds. */
const look = () =>
  page.evaluate(() => [
    performance.now() / 1000,
    Number.parseFloat(document.querySelector("#time").textContent),
  ]);

await page.click("#run");
if (key) {
  await page.waitForTimeout(1000);
  await page.locator("body").press(key, { delay: 300 });
}
await page.selectOption("#speed", "Infinity");
await page.waitForTimeout(1000);
const [wallBefore, before] = await look();
await page.waitForTimeout(Number(seconds) * 1000);
const [wallAfter, after] = await look();
const status = await page.textContent("#status");
await browser.close();
const ratio = (after - before) / (wallAfter - wallBefore);
console.log(JSON.stringify({ ratio, status, paint_ms, ready_ms }));
