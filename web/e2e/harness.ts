// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The page as the user gets it: `ravenbrick view` and a headless Chromium. */
import { execFile, spawn } from "node:child_process";
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import axe from "axe-core";
import {
  chromium,
  type Browser,
  type BrowserContext,
  type BrowserContextOptions,
  type ConsoleMessage,
  type Frame,
  type Page,
} from "playwright-core";
import { expect, test as base } from "vitest";

export const ROOT = join(dirname(fileURLToPath(import.meta.url)), "..", "..");
export const PICTURES = join(ROOT, "out", "page");
export const COMMAND = join(ROOT, ".venv", "bin", "ravenbrick");
export const VEHICLE = "examples/vehicle";
// The first has no windows to draw, and takes 30 % less of a processor.
const BROWSERS = ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"];
export const TIMEOUT_MS = 300_000;

/** The JSON answer of a command; a verdict of the pass criteria is no failure. */
export async function ravenbrick(...words: string[]): Promise<Record<string, unknown>> {
  const done = await promisify(execFile)(COMMAND, [...words, "--json"], { cwd: ROOT });
  return JSON.parse(done.stdout) as Record<string, unknown>;
}

export interface Served {
  address: string;
  end: () => void;
  /** What it has said on its standard output when it is over. */
  ended: Promise<string>;
}

/** `ravenbrick view` or `studio` for a project. */
const serve = (...words: string[]) => started(COMMAND, ...words, "--port", "0", "--no-browser");

/** A server that says its address. */
export const started = (program: string, ...words: string[]) => startedIn(ROOT, program, ...words);

/** The same, started in a folder. */
export async function startedIn(
  cwd: string,
  program: string,
  ...words: string[]
): Promise<Served> {
  const server = spawn(program, words, {
    cwd,
    env: { ...process.env, PYTHONUNBUFFERED: "1", COLUMNS: "200" },
  });
  const ended = new Promise<string>((over) => {
    let answer = "";
    server.stdout.on("data", (bytes: Buffer) => (answer += bytes.toString()));
    server.on("close", () => over(answer));
  });
  const address = await new Promise<string>((found, failed) => {
    let said = "";
    const late = setTimeout(() => {
      failed(new Error(`no address within ${TIMEOUT_MS / 1000} s: ${said}`));
      server.kill();
    }, TIMEOUT_MS).unref();
    const listen = (bytes: Buffer) => {
      said += bytes.toString();
      const match = /http:\/\/127\.0\.0\.1:\d+\/([\w-]+\/)?(?![\w-]|$)/.exec(said);
      if (!match) return;
      clearTimeout(late);
      found(match[0]);
    };
    server.stdout.on("data", listen);
    server.stderr.on("data", listen);
    const over = (code: number | null) => `${program} ${words[0]} ended with ${code}: ${said}`;
    server.on("exit", (code) => failed(new Error(over(code))));
  });
  return { address, end: () => server.kill("SIGINT"), ended };
}

async function launch(): Promise<Browser> {
  const places = BROWSERS.map((name) => join("/usr/bin", name));
  const executablePath = [process.env["RAVENBRICK_CHROMIUM"] ?? "", ...places].find(existsSync);
  if (!executablePath)
    throw new Error("no Chromium; install the Debian package chromium-headless-shell");
  mkdirSync(PICTURES, { recursive: true });
  return chromium.launch({ executablePath, args: ["--no-sandbox", "--mute-audio"] });
}

/** A page in a browser context of its own, what it asked of the network, and its errors. */
interface Opened {
  page: Page;
  context: BrowserContext;
  requests: string[];
  errors: string[];
}

type Open = (
  address: string,
  options?: BrowserContextOptions,
  prepare?: (page: Page) => Promise<unknown>,
) => Promise<Opened>;

async function openPage(browser: Browser, options: BrowserContextOptions): Promise<Opened> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  context.setDefaultTimeout(TIMEOUT_MS);
  const requests: string[] = [];
  const errors: string[] = [];
  context.on("request", (request) => requests.push(request.url()));
  context.on("weberror", (failure) => errors.push(failure.error().message));
  // A conflict of versions is an answer of the studio, which Chromium reports as an error.
  const isError = (message: ConsoleMessage) =>
    message.type() === "error" && !message.text().includes("409 (Conflict)");
  context.on("console", (message) => isError(message) && errors.push(message.text()));
  return { page: await context.newPage(), context, requests, errors };
}

/** A task in the answer of `ravenbrick analyse`. */
interface AnalysedTask {
  name: string;
  response_bound_cycles: number;
  observed: { response_cycles: number };
}

interface Fixtures {
  /** One Chromium for all tests. */
  browser: Browser;
  /** Serve a project until all tests are done; the same words give the same server. */
  view: (...words: string[]) => Promise<string>;
  /** The same for `ravenbrick studio`. */
  studio: (...words: string[]) => Promise<string>;
  /** What `ravenbrick analyse` found for the vehicle. */
  bounds: AnalysedTask[];
  /** Address of the vehicle with the scenario `drive`, with none, and designed, with `step`. */
  drive: string;
  free: string;
  step: string;
  /** A page that has loaded its brick. Its test fails if it leaves an error in the console. */
  open: Open;
}

const forAllTests = { scope: "worker" } as const;

/** Hand out servers of a command, one for the same words, and end them when all tests are done. */
async function serveForAll(
  command: "view" | "studio",
  use: (address: (...words: string[]) => Promise<string>) => Promise<void>,
) {
  const servers = new Map<string, Promise<Served>>();
  await use(async (...words) => {
    const server = servers.get(words.join()) ?? serve(command, ...words);
    servers.set(words.join(), server);
    return (await server).address;
  });
  for (const server of servers.values()) (await server).end();
}

export const test = base.extend<Fixtures>({
  browser: [
    async ({}, use) => {
      const browser = await launch();
      await use(browser);
      await browser.close();
    },
    forAllTests,
  ],
  view: [async ({}, use) => serveForAll("view", use), forAllTests],
  studio: [async ({}, use) => serveForAll("studio", use), forAllTests],
  bounds: [
    async ({}, use) => {
      await build(VEHICLE);
      const analysed = await ravenbrick("analyse", VEHICLE, "--scenario", "drive");
      await use(analysed["tasks"] as AnalysedTask[]);
    },
    forAllTests,
  ],
  // The server shows the bounds that the analysis leaves.
  drive: [async ({ bounds: _known, view }, use) => use(await view(VEHICLE, "drive")), forAllTests],
  free: [async ({ view }, use) => use(await view(await build(VEHICLE))), forAllTests],
  step: [
    async ({ view }, use) => {
      await ravenbrick("design", VEHICLE);
      await use(await view(await build(VEHICLE), "step"));
    },
    forAllTests,
  ],
  open: async ({ browser }, use) => {
    const all: Opened[] = [];
    await use(async (address, options = {}, prepare = () => Promise.resolve()) => {
      const one = await openPage(browser, options);
      all.push(one);
      await prepare(one.page);
      await one.page.goto(address);
      await one.page.waitForFunction(() => document.title.includes("–"));
      return one;
    });
    for (const { context } of all) await context.close();
    expect(all.flatMap(({ errors }) => errors)).toEqual([]);
  },
});

/** Build a project; its folder. */
export async function build(project: string): Promise<string> {
  await ravenbrick("build", project);
  return project;
}

/** What axe finds wrong in the page, and in its frames if they are given: rule and elements. */
export async function violations(page: Page, frames = [page.mainFrame()]): Promise<string[]> {
  for (const frame of frames) await frame.evaluate(axe.source);
  const found = await page.evaluate(async () => {
    const { axe: judge } = globalThis as unknown as { axe: typeof axe };
    const { violations } = await judge.run(document);
    return violations.map(({ id, nodes }) => [id, ...nodes.map((node) => node.html)].join(" | "));
  });
  return found;
}

/** Wait until an element contains these words. */
export async function waitForText(page: Page, selector: string, words: string | RegExp) {
  await page.locator(selector, { hasText: words }).waitFor({ state: "attached" });
}

/** Wait until the run is at its beginning again. */
export const waitForReset = (page: Page) => waitForText(page, "#time", /^0\.000000 s/);

/** Wait until the program has ended in this way. */
export const waitForEnd = (page: Page, how: string) => waitForText(page, "#program", how);

/** A picture of the page for a person to look at. */
export async function screenshot(page: Page, name: string, fullPage = true): Promise<void> {
  await page.evaluate(() => scrollTo(0, 0));
  await page.screenshot({ path: join(PICTURES, `${name}.png`), fullPage });
}

/** What a button of the page downloads. */
export async function download(
  page: Page,
  button: string,
): Promise<{ path: string; text: string }> {
  const [file] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
  const path = join(PICTURES, file.suggestedFilename());
  await file.saveAs(path);
  return { path, text: readFileSync(path, "utf-8") };
}

/** Virtual time shown by the page, in seconds. */
export async function virtualTime(page: Page): Promise<number> {
  return Number.parseFloat((await page.textContent("#time")) ?? "");
}

/** Wait until the page's virtual time has passed an instant. */
export async function waitUntil(page: Page | Frame, seconds: number): Promise<void> {
  await page.waitForFunction(
    (end) => Number.parseFloat(document.querySelector("#time")?.textContent ?? "0") >= end,
    seconds,
    { timeout: TIMEOUT_MS },
  );
}

/** Wait until so much virtual time has passed from now on: as long as the program would see it. */
export async function waitFor(page: Page, seconds: number): Promise<void> {
  await waitUntil(page, (await virtualTime(page)) + seconds);
}

/** Virtual seconds per second of the page's own clock, from one picture to one this much later. */
export async function measureRate(page: Page, seconds: number): Promise<number> {
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
export async function waitForServiceWorker(page: Page): Promise<void> {
  await page.waitForFunction(() => navigator.serviceWorker.controller !== null);
}

/** Wait until the service worker has kept a file; the last that a page reads: it has them all. */
export async function waitForCached(page: Page, name: string): Promise<void> {
  const kept = () => page.evaluate(async (file) => !!(await caches.match(file)), name);
  await expect.poll(kept, { timeout: TIMEOUT_MS }).toBe(true);
}

/** Share of pixels of a canvas that are not transparent, or dark on the display. */
export async function darkShare(page: Page, selector: string): Promise<number> {
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
