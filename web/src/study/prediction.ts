// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Questions before the run: the student's number or sketch, then the measured answer over it. */
import { el, panel } from "../dom";
import type { Measured, Ready } from "../protocol";
import type { Question } from "../session";
import { Sketch } from "./sketch";
import type { View } from "../view/view";

type NumberQuestion = Extract<Question, { measure: string }>;

/** Unit in which people state a measure, and its size. */
const UNITS: Record<string, [string, number]> = {
  settling_time: ["s", 1],
  overshoot: ["%", 0.01],
  steady_state_error: ["%", 0.01],
  cpu_utilization: ["%", 0.01],
  lateral_deviation: ["mm", 0.001],
  distance: ["m", 1],
};

/** A question of the page that embeds this one: `?question=TEXT&measure=NAME`. */
export function questionOfAddress(search: string): Question[] {
  const fields = new URLSearchParams(search);
  const [text, measure] = [fields.get("question"), fields.get("measure")];
  return text && measure ? [{ text, measure }] : [];
}

/** The student's number; `show` gives the answer when it is known and the number is fixed. */
class Estimate {
  readonly element: HTMLElement;
  private readonly number = el("input", { type: "number", step: "any", required: true });
  private readonly answer = el("p", { class: "answer", role: "status" });
  private fixed: number | null = null;

  constructor(
    private readonly question: NumberQuestion,
    private readonly change: () => void,
  ) {
    const [unit] = UNITS[question.measure] ?? ["", 1];
    const button = el("button", { type: "submit" }, "Fix my answer");
    const label = el("label", {}, "My answer ", this.number, ` ${unit}`);
    const form = el("form", { class: "row" }, label, button);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (!Number.isFinite(this.number.valueAsNumber)) return;
      this.fixed = this.number.valueAsNumber;
      this.number.disabled = button.disabled = true;
      this.answer.textContent = "Now run the brick.";
      this.change();
    });
    const legend = el("legend", {}, question.text);
    this.element = el("fieldset", { class: "question" }, legend, form, this.answer);
  }

  show({ final }: Measured, value: number | null): void {
    if (this.fixed === null || value === null) return;
    const [unit, size] = UNITS[this.question.measure] ?? ["", 1];
    const measured = value / size;
    const difference = Math.abs(measured - this.fixed);
    const state = final ? "" : " (so far)";
    const text =
      `You: ${String(this.fixed)} ${unit}. Measured${state}: ${measured.toPrecision(4)} ${unit}. ` +
      `Difference: ${difference.toPrecision(3)} ${unit}.`;
    if (this.answer.textContent !== text) this.answer.textContent = text;
  }
}

export class Prediction implements View {
  readonly element: HTMLElement;
  private readonly list = el("div", { class: "questions" });
  private answers: (Estimate | Sketch)[] = [];
  private questions: Question[] = [];
  private criteria = 0;
  private measures: Measured | null = null;

  constructor() {
    this.element = panel("prediction", "Predict before you run", [], this.list);
  }

  /** Signals that the sketches are compared with. */
  get signals(): string[] {
    return this.questions.flatMap((question) => ("signal" in question ? [question.signal] : []));
  }

  ready({ session, judges }: Ready): void {
    const asked = session.questions ?? [];
    const questions = asked.filter((question) => judges || "signal" in question);
    this.criteria = session.checks?.criteria.length ?? 0;
    this.measures = null;
    this.element.hidden = questions.length === 0;
    // Another run of the same program: what was predicted stays.
    if (JSON.stringify(questions) === JSON.stringify(this.questions)) return;
    this.questions = questions;
    const change = () => this.show();
    this.answers = questions.map((question) =>
      "measure" in question ? new Estimate(question, change) : new Sketch(question, change),
    );
    this.list.replaceChildren(...this.answers.map(({ element }) => element));
  }

  frame(): void {}

  measured(measures: Measured): void {
    this.measures = measures;
    this.show();
  }

  private show(): void {
    const { measures } = this;
    if (!measures) return;
    let at = this.criteria;
    for (const answer of this.answers) {
      if (answer instanceof Sketch) answer.show(measures);
      else answer.show(measures, measures.verdicts[at++]?.value ?? null);
    }
  }
}
