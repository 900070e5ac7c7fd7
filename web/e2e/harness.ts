// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The page as the user gets it: `ravenbrick view` and a headless Chromium. */
import { execFile, spawn, type ChildProcess } from "node:child_process";
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { chromium, type Browser, type BrowserContextOptions, type Page } from "playwright-core";

export const ROOT = join(dirname(fileURLToPath(import.meta.url)), "..", "..");
export const PICTURES = join(ROOT, "out", "page");
const COMMAND = join(ROOT, ".venv", "bin", "ravenbrick");
export const VEHICLE = "examples/vehicle";
const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/** The browser of the system; RAVENBRICK_CHROMIUM names another. */
export function browserPath(): string | undefined {
  return [process.env["RAVENBRICK_CHROMIUM"] ?? "", ...BROWSERS].find((path) => existsSync(path));
}

/** The JSON answer of a command; a verdict of the pass criteria is no failure. */
export async function ravenbrick(...words: string[]): Promise<Record<string, unknown>> {
  const done = await promisify(execFile)(COMMAND, [...words, "--json"], { cwd: ROOT });
  return JSON.parse(done.stdout) as Record<string, unknown>;
}

/** A server for a project, and its address. */
export async function serve(...words: string[]): Promise<{ address: string; end: () => void }> {
  const options = ["--port", "0", "--no-browser"];
  const server: ChildProcess = spawn(COMMAND, ["view", ...words, ...options], {
    cwd: ROOT,
    env: { ...process.env, PYTHONUNBUFFERED: "1", COLUMNS: "200" },
  });
  const address = await new Promise<string>((found, failed) => {
    let said = "";
    const listen = (bytes: Buffer) => {
      said += bytes.toString();
      const match = /http:\/\/127\.0\.0\.1:\d+\//.exec(said);
      if (match) found(match[0]);
    };
    server.stdout?.on("data", listen);
    server.stderr?.on("data", listen);
    server.on("exit", (code) => failed(new Error(`ravenbrick view ended with ${code}: ${said}`)));
  });
  return { address, end: () => server.kill("SIGINT") };
}

export async function launch(): Promise<Browser> {
  const executablePath = browserPath();
  if (!executablePath) throw new Error("no Chromium; install the Debian package chromium");
  mkdirSync(PICTURES, { recursive: true });
  return chromium.launch({ executablePath, args: ["--no-sandbox", "--mute-audio"] });
}

/** A page that has loaded its brick, with what it asked of the network and complained about. */
export async function open(
  browser: Browser,
  address: string,
  options: BrowserContextOptions = {},
  prepare: (page: Page) => Promise<void> = () => Promise.resolve(),
) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  context.setDefaultTimeout(300_000);
  const page = await context.newPage();
  const requests: string[] = [];
  const complaints: string[] = [];
  page.on("request", (request) => requests.push(request.url()));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  await prepare(page);
  await page.goto(address);
  await page.waitForFunction(() => document.title.includes("–"));
  return { context, page, requests, complaints };
}

/** Wait until the line of status begins with these words. */
export async function says(page: Page, words: string): Promise<void> {
  await page.waitForFunction(
    (begin) => document.querySelector("#status")?.textContent?.startsWith(begin),
    words,
    { timeout: 300_000 },
  );
}

/** Wait until the run is at its beginning again. */
export async function begins(page: Page): Promise<void> {
  await page.waitForFunction(() =>
    document.querySelector("#time")?.textContent?.startsWith("0.000000 s"),
  );
}

/** Wait until the program has ended in this way. */
export async function ends(page: Page, how: string): Promise<void> {
  await page.waitForFunction(
    (words) => document.querySelector("#program")?.textContent?.includes(words),
    how,
    { timeout: 300_000 },
  );
}

/** A picture of the page for a person to look at. */
export async function picture(page: Page, name: string, fullPage = true): Promise<void> {
  await page.evaluate(() => scrollTo(0, 0));
  await page.screenshot({ path: join(PICTURES, `${name}.png`), fullPage });
}

/** What a button of the page downloads. */
export async function downloaded(
  page: Page,
  button: string,
): Promise<{ path: string; text: string }> {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
  const path = join(PICTURES, download.suggestedFilename());
  await download.saveAs(path);
  return { path, text: readFileSync(path, "utf-8") };
}

/** Virtual time shown by the page, in seconds. */
export async function shownTime(page: Page): Promise<number> {
  return Number.parseFloat((await page.textContent("#time")) ?? "");
}

/** Wait until the page's virtual time has passed an instant. */
export async function passes(page: Page, seconds: number): Promise<void> {
  await page.waitForFunction(
    (end) => Number.parseFloat(document.querySelector("#time")?.textContent ?? "0") >= end,
    seconds,
    { timeout: 300_000 },
  );
}

/** Wait until so much virtual time has passed from now on: as long as the program would see it. */
export async function lasts(page: Page, seconds: number): Promise<void> {
  await passes(page, (await shownTime(page)) + seconds);
}

/** Virtual seconds per second of the page's own clock, from one picture to one this much later. */
export async function rateOver(page: Page, seconds: number): Promise<number> {
  return page.evaluate(async (wanted) => {
    const shown = () => Number.parseFloat(document.querySelector("#time")?.textContent ?? "");
    const until = async (done: () => boolean) => {
      while (!done()) await new Promise((next) => requestAnimationFrame(next));
      return [performance.now(), shown()] as const;
    };
    const old = shown();
    const [began, from] = await until(() => shown() > old);
    const [ended, to] = await until(() => shown() >= from + wanted);
    return (1000 * (to - from)) / (ended - began);
  }, seconds);
}

/** Wait until the service worker answers the page: it keeps what it hands over. */
export async function kept(page: Page): Promise<void> {
  await page.waitForFunction(() => navigator.serviceWorker.controller !== null);
}

/** Share of pixels of a canvas that are not transparent, or dark on the display. */
export async function inked(page: Page, selector: string): Promise<number> {
  return page.$eval(selector, (element) => {
    const canvas = element as HTMLCanvasElement;
    const context = canvas.getContext("2d");
    const data = context?.getImageData(0, 0, canvas.width, canvas.height).data ?? [];
    let count = 0;
    for (let at = 0; at < data.length; at += 4) {
      if ((data[at + 3] ?? 0) > 0 && (data[at] ?? 255) < 120) count += 1;
    }
    return count / (data.length / 4 || 1);
  });
}
