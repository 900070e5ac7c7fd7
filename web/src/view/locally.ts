// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The commands that continue outside the browser. */
import { seconds } from "../clock";
import { el } from "../dom";
import type { Frame, Ready } from "../protocol";
import type { View } from "./view";

/** File of a saved run, by project and scenario. */
export function runFileName(project: string, scenario: string | null): string {
  return `${project}${scenario ? `-${scenario}` : ""}.run.json`;
}

export class Locally implements View {
  readonly element: HTMLElement;
  private readonly commands = el("pre", { tabindex: 0, "aria-label": "Commands" });
  private readonly time = el("span", {}, "");
  private file = "";

  /** `name` is the project's where the page is shown, "" for its own. */
  constructor(
    private readonly name: string,
    save: () => void,
  ) {
    const button = el("button", { type: "button", click: save }, "Save this run");
    const text = el("p", {}, "Your project, and this run up to ", this.time, ":");
    const panel = el("div", {}, text, this.commands, button);
    this.element = el("details", { id: "locally" }, el("summary", {}, "Open locally"), panel);
    this.element.hidden = true;
  }

  ready({ session }: Ready): void {
    const { locally, project, scenario } = session;
    this.element.hidden = !locally;
    if (!locally) return;
    const { template, changed } = locally;
    const folder = template ? this.name || project : locally.folder;
    this.file = runFileName(project, scenario);
    const commands = [
      template ? `ravenbrick new ${folder} --template ${template}` : "",
      changed ? "# then the steps of the sheet" : "",
      `ravenbrick view ${folder} ${scenario ?? ""}`,
      `ravenbrick run ${folder} ${scenario ?? ""} --replay ${this.file}`,
    ];
    this.commands.textContent = commands.filter(Boolean).join("\n");
  }

  frame({ cycles }: Frame): void {
    this.time.textContent = `${seconds(cycles).toFixed(3)} s (${this.file})`;
  }
}
