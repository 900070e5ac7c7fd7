// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The studio as the user gets it, by keyboard: edit, save, build, and the new image runs. */
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { loadavg, tmpdir } from "node:os";
import { join } from "node:path";
import type { Page } from "playwright-core";
import { beforeAll, describe, expect } from "vitest";
import { ravenbrick, screenshot, test, violations, waitForText } from "./harness";

/** Many times as long as the first build takes. */
const BRICK_TIMEOUT_MS = 90_000;
declare module "vitest" {
  /** Measured, not judged: verification/course/site.py puts it into the row of the results. */
  interface TaskMeta {
    edit?: string;
  }
}

/** Each tab behind the brick's: its command, and an element of what that shows. */
const TABS = [
  ["design", "design", "img"],
  ["diagram", "diagram", "iframe"],
  ["bounds", "analyse", "iframe"],
  ["report", "report", "iframe"],
] as const;

let folder = "";
let project = "";

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), "studio-"));
  project = join(folder, "my-robot");
  await ravenbrick("new", project, "--template", "motor");
  await ravenbrick("build", project);
  return () => rmSync(folder, { recursive: true });
});

/** Press F6 until the focus is in an element of this selector. */
async function goToPane(page: Page, selector: string): Promise<void> {
  for (let presses = 0; presses < 6; presses += 1) {
    const inside = await page.evaluate(
      (wanted) => document.activeElement?.closest(wanted) !== null,
      selector,
    );
    if (inside) return;
    await page.keyboard.press("F6");
  }
  throw new Error(`F6 does not lead to ${selector}`);
}

/** Put the cursor behind a text of the file that is shown, with the editor's own search. */
async function find(page: Page, text: string): Promise<void> {
  await page.locator("#editor .cm-content").waitFor();
  await goToPane(page, "#editor");
  await page.keyboard.press("Control+Home");
  await page.keyboard.press("Control+f");
  await page.keyboard.type(text);
  await page.keyboard.press("Enter");
  await page.keyboard.press("Escape");
  await page.keyboard.press("ArrowRight");
}

/** Wait until the brick's page is loaded; where it does not come, the studio's page says why. */
async function waitForBrick(page: Page): Promise<void> {
  const brick = page.frameLocator("#brick-frame").locator("#time");
  await brick.waitFor({ timeout: BRICK_TIMEOUT_MS }).catch(async (error: Error) => {
    throw new Error(`${error.message}\nThe page:\n${await page.innerText("body")}`);
  });
}

const saved = (name: string) => readFileSync(join(project, name), "utf-8");
const shown = (page: Page) => page.textContent("#status");

describe("the studio", () => {
  test("edits the design by keyboard, and the new image runs", async ({ open, studio, task }) => {
    const { page } = await open(await studio(project));
    await waitForBrick(page);
    await find(page, "SETTLING_TIME = 0.4");
    await page.keyboard.press("Backspace");
    await page.keyboard.type("3");
    await page.keyboard.press("Control+s");
    await waitForText(page, "#status", /runs \d/);
    expect(saved("design.py")).toContain("SETTLING_TIME = 0.3");
    task.meta.edit = `${await shown(page)} (load of the machine: ${loadavg()[0]?.toFixed(1)})`;
    const lines = await page.locator("#commands code").allTextContents();
    expect(lines[0]).toMatch(/^ravenbrick view \S*my-robot$/);
    expect(lines[1]).toMatch(/^ravenbrick build \S*my-robot$/);
  });

  test("shows an error at its line and keeps the old image", async ({ open, studio }) => {
    const { page } = await open(await studio(project));
    await waitForBrick(page);
    await goToPane(page, "#files");
    await page.locator('[data-path="src/tasks.adb"]').press("Enter");
    await page.locator('#editor .cm-content[aria-label="src/tasks.adb"]').waitFor();
    await find(page, "task body Control_Task is");
    await page.keyboard.press("Enter");
    await page.keyboard.type("Wrong : Integer := Unknown;");
    await page.keyboard.press("Control+s");
    await waitForText(page, "#status", "build failed");
    await waitForText(page, "#problems button", /^src\/tasks\.adb:\d+:\d+: .*Unknown/);
    expect(await page.locator("#editor .cm-lint-marker-error").count()).toBe(1);
    expect(await page.frameLocator("#brick-frame").locator("#time").count()).toBe(1);
    await screenshot(page, "studio-error", false);
    await page.keyboard.press("Escape");
    expect(await page.evaluate(() => document.activeElement?.id)).toBe("save");
    await page.keyboard.press("F8");
    await page.keyboard.press("End");
    await page.keyboard.press("Shift+Home");
    await page.keyboard.press("Shift+Home");
    await page.keyboard.press("Delete");
    await page.keyboard.press("Control+s");
    await waitForText(page, "#status", /runs \d/);
    expect(await page.locator("#problems button").count()).toBe(0);
  });

  test("shows by keyboard what each command wrote", async ({ open, studio }) => {
    const balancer = join(folder, "balancer"); // analysed in a quarter of the motor's time
    await ravenbrick("new", balancer, "--template", "balance");
    const { page } = await open(await studio(balancer));
    await waitForBrick(page);
    await page.selectOption("#scenario", "stand");
    await waitForText(page, "#commands li", /view \S+ stand.*done/);
    await page.focus("#brick-tab");
    for (const [tab, command, shown] of TABS) {
      await page.keyboard.press("ArrowRight");
      expect(await page.evaluate(() => document.activeElement?.id)).toBe(`${tab}-tab`);
      await page.keyboard.press("Tab");
      await page.keyboard.press("Enter");
      await waitForText(page, "#commands li", new RegExp(`${command}.*done`));
      await page.locator(`#${tab}-panel ${shown}`).first().waitFor();
      expect(await violations(page)).toEqual([]);
      await screenshot(page, `studio-${tab}`, false);
      await page.focus(`#${tab}-tab`);
    }
  });

  test("asks when another program changed the file", async ({ open, studio }) => {
    const { page } = await open(await studio(project));
    await find(page, "SETTLING_TIME");
    await page.keyboard.type(" ");
    writeFileSync(join(project, "design.py"), `# from elsewhere\n${saved("design.py")}`);
    await page.keyboard.press("Control+s");
    await waitForText(page, "#conflict", "was changed by another program");
    expect(saved("design.py")).toContain("# from elsewhere");
    await page.keyboard.press("Enter");
    await page.locator("#conflict").waitFor({ state: "hidden" });
    await page.keyboard.press("Control+Home");
    await waitForText(page, "#editor .cm-content", "# from elsewhere");
  });

  for (const colorScheme of ["light", "dark"] as const) {
    test(`has no violation, ${colorScheme}`, async ({ open, studio }) => {
      const { page } = await open(await studio(project), { colorScheme });
      await waitForBrick(page);
      const brick = page.frame({ url: /\/brick\// });
      expect(brick).not.toBeNull();
      expect(await violations(page, [page.mainFrame(), brick!])).toEqual([]);
      await page.keyboard.press("Escape");
      await page.click("#diagram-tab");
      await page.click("#diagram-panel button");
      await page.frameLocator("#diagram-panel iframe").locator("svg").waitFor();
      const drawn = page.frameLocator("#diagram-panel iframe").locator("main");
      expect((await drawn.boundingBox())?.width).toBeGreaterThan(300); // beside or above its code
      expect(await violations(page)).toEqual([]);
      await screenshot(page, `studio-${colorScheme}`, false);
    });
  }
});
