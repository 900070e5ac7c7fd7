// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The pass criteria of the scenario, judged in the tab by the code that `ravenbrick run` uses. */
import { el, panel } from "../dom";
import type { Measured, Ready, Verdict } from "../protocol";
import type { Checks as Wanted } from "../session";
import type { View } from "../view/view";

/** A criterion before there is a run. */
function wanted({ measure, minimum, maximum }: Wanted["criteria"][number]): string {
  const bounds = [minimum == null ? "" : `≥ ${minimum}`, maximum == null ? "" : `≤ ${maximum}`];
  return `${measure.replaceAll("_", " ")} ${bounds.filter(Boolean).join(", ")}`;
}

export class Checks implements View {
  readonly element: HTMLElement;
  private readonly list = el("ul", { id: "check-list", class: "verdicts" });
  private readonly state = el("output", { id: "checks-state" });
  private labels: string[] = [];
  /** Criteria of the file stand before those of questions, sentences after both. */
  private criteria = 0;
  private asked = 0;

  constructor() {
    this.element = panel("checks", "Checks", [this.state], this.list);
  }

  ready({ session, judges }: Ready): void {
    const { criteria, expectations } = session.checks ?? { criteria: [], expectations: [] };
    this.labels = [...criteria.map(wanted), ...expectations];
    this.criteria = criteria.length;
    this.asked = (session.questions ?? []).filter((question) => "measure" in question).length;
    this.element.hidden = this.labels.length === 0 || !judges;
    this.show([], "not run yet");
  }

  frame(): void {}

  measured({ verdicts, final }: Measured): void {
    const own = verdicts.filter((_, at) => at < this.criteria || at >= this.criteria + this.asked);
    const failed = own.some(({ met }) => !met);
    this.show(own, !final ? "so far" : failed ? "not all met" : "all met");
  }

  private show(verdicts: Verdict[], state: string): void {
    if (this.state.value !== state) this.state.value = state;
    this.list.replaceChildren(...this.labels.map((label, at) => entry(label, verdicts[at])));
  }
}

function entry(label: string, verdict: Verdict | undefined): HTMLElement {
  const open = !verdict || verdict.problem !== undefined;
  const [mark, kind] = open ? ["…", "open"] : verdict.met ? ["✓", "met"] : ["✗", "missed"];
  const word = open ? "not yet" : verdict.met ? "met" : "not met";
  const shown = open ? (verdict?.problem ?? "") : (verdict.shown ?? "");
  return el(
    "li",
    { class: kind },
    el("span", { "aria-hidden": "true" }, mark),
    el("span", {}, `${verdict?.label ?? label}: `, el("b", {}, word), shown ? ` (${shown})` : ""),
  );
}
