// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The site of `make docs` as a reader gets it: from a plain file server, then without one. */
import { execFile } from "node:child_process";
import {
  copyFileSync,
  cpSync,
  existsSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  rmSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { promisify } from "node:util";
import { gzipSync } from "node:zlib";
import {
  firefox,
  type Browser,
  type BrowserContextOptions,
  type Frame,
  type Page,
} from "playwright-core";
import { beforeAll, describe, expect } from "vitest";
import {
  COMMAND,
  download,
  PICTURES,
  ROOT,
  started,
  startedIn,
  test,
  TIMEOUT_MS,
  violations,
  waitForText,
  waitUntil,
  type Served,
} from "../harness";

const SITE = join(ROOT, "docs", "_build", "html");
const BRICKS = join(SITE, "_static", "bricks");
/** Projects of the sheets after their steps, by the brick's name. */
const STEPPED = join(ROOT, "build", "site");
const MADE = ["build", "out"];
const PHONE = { width: 390, height: 844 };
/** How the sheets are looked at; the words stand in the names of the pictures. */
const VIEWS = {
  desktop: { viewport: { width: 1280, height: 900 } },
  phone: { viewport: PHONE },
  dark: { viewport: PHONE, colorScheme: "dark" },
} as const;
/** The second browser: Debian's package, by the protocol that browsers share (WebDriver BiDi). */
const FIREFOX = "/usr/bin/firefox-esr";
declare module "vitest" {
  /** Measured, not judged: verification/course/site.py puts it into the row of the results. */
  interface TaskMeta {
    firstRobot?: { rate: number; seconds: number; bytes: number };
  }
}

/** What may be loaded until the first robot moves, packed as web servers do. */
const MOST_BYTES = 2_500_000;

let server: Served;

/** Any file server does; this one comes with Python. */
beforeAll(async () => {
  const words = ["-u", "-m", "http.server", "0", "--bind", "127.0.0.1", "--directory", SITE];
  server = await started("python3", ...words);
  return server.end;
});

interface Session {
  project: string;
  digest?: string;
  /** None for a program in devices/, which is no project. */
  locally?: { template: string | null };
  tunables: { path: string }[];
}

const sessionOf = (name: string) =>
  JSON.parse(readFileSync(join(BRICKS, name, "session.json"), "utf-8")) as Session;
const bricks = readdirSync(BRICKS).sort();
const sheets = readdirSync(join(SITE, "lessons")).filter((name) => /^\d\d-.*\.html$/.test(name));

const brickPage = (name: string) => `${server.address}_static/brick/index.html?brick=${name}`;

/** Answer what the page asks before the run with any number; how many questions these are. */
async function predict(page: Page): Promise<number> {
  const questions = await page.locator("#prediction fieldset").all();
  for (const question of questions) {
    for (const field of await question.getByRole("spinbutton").all()) {
      await field.fill((await field.getAttribute("max")) ?? "1");
    }
    const add = question.getByRole("button", { name: "Add point" });
    if (await add.isVisible()) await add.click();
    await question.getByText(/^Fix my/).click();
  }
  return questions.length;
}

/** Run a brick's page to its end as fast as it goes. */
async function runToEnd(page: Page): Promise<string> {
  await page.selectOption("#speed", "Infinity");
  await page.click("#run");
  await waitForText(page, ".readings", /same run again|ANOTHER/);
  return (await page.textContent("#status")) ?? "";
}

/** Bring the brick of a sheet into view and wait until its virtual time passes. */
async function watchItMove(page: Page, seconds = 0): Promise<void> {
  const frame = page.locator("figure.brick iframe").first();
  await frame.scrollIntoViewIfNeeded();
  const brick = page.frameLocator("figure.brick iframe").first();
  const run = brick.locator("#run");
  await run.waitFor();
  if ((await run.textContent()) === "Run") await run.click();
  await brick.locator("#time", { hasText: /[1-9]/ }).waitFor();
  for (const shown of page.frames().slice(1)) await waitUntil(shown, seconds);
}

describe("a brick of the site", () => {
  for (const name of bricks) {
    const { digest } = sessionOf(name);
    const words = `${name} gives the native run's digest and answers its questions`;
    test.runIf(digest)(words, async ({ open }) => {
      const { page, requests } = await open(brickPage(name));
      const asked = await predict(page);
      expect(await runToEnd(page)).toBe(`The same run again: trace digest ${digest}`);
      const answers = page.locator("#prediction .answer", { hasText: /Measured|difference/ });
      await expect.poll(() => answers.count()).toBe(asked);
      expect(requests.filter((request) => !request.startsWith(server.address))).toEqual([]);
    });
  }
});

describe("a controller of the site", () => {
  const isGenerated = (name: string) =>
    sessionOf(name).tunables.some(({ path }) => path.startsWith("functional_P"));
  for (const name of bricks.filter(isGenerated)) {
    test(`${name} has its diagram`, () => {
      const design = JSON.parse(readFileSync(join(BRICKS, name, "design.json"), "utf-8")) as object;
      expect(design).toHaveProperty("diagram", expect.stringContaining("<svg"));
    });
  }
});

/** What a line that the page prints answers; a verdict of the pass criteria is no failure. */
async function answer(cwd: string, line: string): Promise<Record<string, unknown>> {
  const [, ...words] = line.split(" ");
  const done = promisify(execFile)(COMMAND, [...words, "--json"], { cwd });
  const { stdout } = await done.catch((failure: { stdout: string }) => failure);
  return JSON.parse(stdout) as Record<string, unknown>;
}

describe("Open locally", () => {
  for (const name of bricks) {
    const { digest, project, locally } = sessionOf(name);
    if (!locally) continue;
    test.runIf(digest)(`${name} goes on where the reader stopped`, async ({ open }) => {
      const { page } = await open(brickPage(name));
      await page.click("#run");
      await waitUntil(page, 0.2);
      await page.click("#run");
      await page.click("#locally summary");
      const printed = (await page.textContent("#locally pre")) ?? "";
      const saved = await download(page, "#locally button");
      const folder = locally.template ? mkdtempSync(join(tmpdir(), "locally-")) : ROOT;
      const file = join(folder, basename(saved.path));
      copyFileSync(saved.path, file);
      for (const line of printed.split("\n")) {
        if (line.startsWith("#")) {
          const filter = (path: string) => !MADE.includes(basename(path));
          cpSync(join(STEPPED, name, project), join(folder, project), { recursive: true, filter });
        } else if (line.startsWith("ravenbrick view")) {
          const words = [...line.trim().split(" ").slice(1), "--port", "0", "--no-browser"];
          const view = await startedIn(folder, COMMAND, ...words);
          expect((await fetch(view.address)).status).toBe(200);
          view.end();
        } else {
          const answered = await answer(folder, line);
          if (line.includes("--replay")) expect(answered["same_as_replayed"]).toBe(true);
          else expect(answered["ok"]).toBe(true);
        }
      }
      rmSync(locally.template ? folder : file, { recursive: true });
      expect(printed).toContain("--replay");
    });
  }
});

/** Says in every frame when the robot has moved by a centimetre, in ms since 1970. */
function noticeMotion(): void {
  const watch = new MutationObserver(() => {
    if (!/x 0\.0?[1-9]/.test(document.getElementById("pose")?.textContent ?? "")) return;
    watch.disconnect();
    Object.assign(globalThis, { movedAt: performance.timeOrigin + performance.now() });
  });
  watch.observe(document, { subtree: true, childList: true, characterData: true });
}

const movedAt = (frame: Frame) =>
  frame.evaluate(() => (globalThis as { movedAt?: number }).movedAt ?? 0).catch(() => 0);

describe("the first page", () => {
  // A phone's processor is taken for one that needs four times as long.
  const name = "has a robot that moves, for few bytes, %i times slower";
  test.for([1, 4])(name, async (rate, { browser, task }) => {
    const context = await browser.newContext({ serviceWorkers: "block", viewport: PHONE });
    context.setDefaultTimeout(TIMEOUT_MS);
    const page = await context.newPage();
    const devTools = await context.newCDPSession(page);
    await devTools.send("Emulation.setCPUThrottlingRate", { rate });
    const bodies: Promise<Buffer>[] = [];
    page.on("response", (response) => {
      if (response.ok()) bodies.push(response.body().catch(() => Buffer.alloc(0)));
    });
    // The page itself notices: a question from outside costs its processor more than the answer.
    await page.addInitScript(noticeMotion);
    await page.goto(server.address, { waitUntil: "commit" });
    const asked = () => Promise.all(page.frames().slice(1).map(movedAt));
    const moved = async () => Math.max(0, ...(await asked()));
    await expect.poll(moved, { timeout: TIMEOUT_MS, interval: 250 }).toBeGreaterThan(0);
    const seconds = ((await moved()) - (await page.evaluate(() => performance.timeOrigin))) / 1000;
    const loaded = await Promise.all(bodies);
    const bytes = loaded.reduce((sum, body) => sum + gzipSync(body).length, 0);
    task.meta.firstRobot = { rate, seconds, bytes };
    await context.close();
    expect(bytes).toBeGreaterThan(100_000);
    expect(bytes).toBeLessThan(MOST_BYTES);
  });
});

/** Open a sheet and run its brick for a second. */
async function sheetOf(browser: Browser, name: string, options: BrowserContextOptions) {
  const context = await browser.newContext(options);
  context.setDefaultTimeout(TIMEOUT_MS);
  const page = await context.newPage();
  await page.goto(`${server.address}lessons/${name}`);
  await watchItMove(page, 0.9);
  return page;
}

/** A picture of a sheet's brick for a person to look at: out/page/brick-<sheet>-<how>.png. */
async function picture(page: Page, name: string, how: string): Promise<void> {
  const path = join(PICTURES, `brick-${name.replace(".html", "")}-${how}.png`);
  await page.locator("figure.brick").first().screenshot({ path });
}

/** By how much page and frames are wider than they may be. */
const overflows = (page: Page) =>
  Promise.all(
    page.frames().map((frame) =>
      frame.evaluate(() => document.documentElement.scrollWidth - innerWidth),
    ),
  );

describe("a sheet", () => {
  for (const name of sheets) {
    for (const [how, options] of Object.entries(VIEWS)) {
      test(`${name} and its brick fit and have no violation, ${how}`, async ({ browser }) => {
        const page = await sheetOf(browser, name, options);
        expect(Math.max(...(await overflows(page)))).toBeLessThanOrEqual(0);
        expect(await violations(page, page.frames())).toEqual([]);
        await picture(page, name, how);
        await page.context().close();
      });
    }
  }
});

describe("Firefox", () => {
  test.runIf(existsSync(FIREFOX))("gives the native run's digests", async () => {
    const options = { channel: "moz-firefox", executablePath: FIREFOX };
    const browser = await firefox.launch(options);
    for (const name of ["vehicle-drive", "balancer-let-go"]) {
      const page = await browser.newPage();
      await page.goto(brickPage(name));
      expect(await runToEnd(page)).toContain(String(sessionOf(name).digest));
    }
    const page = await sheetOf(browser, sheets[0] ?? "", VIEWS.desktop);
    await picture(page, sheets[0] ?? "", "firefox");
    await browser.close();
  });
});

describe("without a network", () => {
  test("the site and its bricks are there after one visit", async ({ browser }) => {
    const context = await browser.newContext();
    const page = await context.newPage();
    await page.goto(server.address);
    const list = readFileSync(join(SITE, "offline.json"), "utf-8");
    const listed = Object.keys(JSON.parse(list) as object);
    const count = () =>
      page.evaluate(async () => (await (await caches.open("ravenbrick")).keys()).length);
    await expect.poll(count, { timeout: 120_000, interval: 500 }).toBeGreaterThan(listed.length);
    server.end();
    for (const name of sheets) {
      await page.goto(`${server.address}lessons/${name}`);
      expect(await page.textContent("h1")).toMatch(/\d/);
    }
    await page.goto(brickPage("vehicle-drive"));
    const { digest } = sessionOf("vehicle-drive");
    expect(await runToEnd(page)).toBe(`The same run again: trace digest ${digest}`);
    await context.close();
  });
});
