// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** A run as the core judges it: criteria, step responses, signals. */
import { judgeOf, sentencesOf, type Core, type CoreClass } from "./core";
import type { Measured, StepFigures, Verdict } from "./protocol";
import type { Criterion, Session } from "./session";

interface Answer {
  measures: { steps: Record<string, StepFigures> };
  criteria: Verdict[];
  expectations: Verdict[];
}

/** Measures that questions ask for, after the criteria of the scenario. */
function criteriaOf({ checks, questions }: Session): Criterion[] {
  const asked = (questions ?? []).flatMap((q) => ("measure" in q ? [{ measure: q.measure }] : []));
  return [...(checks?.criteria ?? []), ...asked];
}

/** What the core is asked; fields that are null are left out. */
function requestOf(session: Session): string {
  const { checks, tasks } = session;
  const criteria = criteriaOf(session);
  const request = { ...checks, tasks, criteria };
  return JSON.stringify(request, (_, value: unknown) => (value === null ? undefined : value));
}

/** Record the pins that sentences speak of, from the beginning of the run. */
export function logPins(core: Core, coreClass: CoreClass, { checks }: Session): void {
  const [judge, sentences] = [judgeOf(core), sentencesOf(coreClass)];
  if (!judge || !sentences) return;
  const pins = (checks?.expectations ?? []).flatMap((sentence) => {
    const { pins } = JSON.parse(sentences.expectation(sentence)) as { pins?: number[] };
    return pins ?? [];
  });
  if (pins.length > 0) judge.log_pins(Uint32Array.from(pins));
}

/** Judge the run up to now. */
export function measure(core: Core, session: Session): Measured {
  const measured: Measured = {
    kind: "measured",
    cycles: core.cycles(),
    final: false,
    verdicts: [],
    steps: {},
    signals: {},
  };
  const judge = judgeOf(core);
  if (!judge || !session.checks) return measured;
  const request = requestOf(session);
  const answer = JSON.parse(judge.verdict(request)) as Answer;
  measured.verdicts = [...answer.criteria, ...answer.expectations];
  for (const motor of session.checks.step?.motors ?? []) {
    const rows = judge.step_response(request, motor);
    const figures = answer.measures.steps[motor];
    if (figures && rows.length > 0) measured.steps[motor] = { rows, figures };
  }
  return measured;
}
