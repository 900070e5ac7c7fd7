// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The panels of a lab: gains, step response, checks, predictions, code beside its model. */
import { el } from "../dom";
import type { Frame, Measured } from "../protocol";
import type { TimedInput } from "../session";
import type { Sources } from "../view/listing";
import type { Actions, View } from "../view/view";
import { Checks } from "./checks";
import { Code, type WorstPaths } from "./code";
import { Prediction } from "./prediction";
import { StepResponse, type Design } from "./step_response";
import { Tuning } from "./tuning";

/** Wall time between two judgements while the run goes on. */
const PERIOD_MS = 1000;

/** Files that belong to the image beside the page. */
export interface Companions {
  sources: Sources;
  design: Design;
  paths: WorstPaths;
}

/** What these panels ask for besides inputs. */
export interface StudyActions {
  again(inputs: TimedInput[]): void;
  measure(signals: string[]): void;
  stepController(): void;
}

export class Study {
  readonly element: HTMLElement;
  readonly views: View[];
  /** In a sheet it stands before the controls that begin the run. */
  readonly prediction = new Prediction();
  private readonly step = new StepResponse();
  private readonly checks = new Checks();
  private readonly code: Code;
  private asked = { cycles: -1, wall: 0 };

  constructor(
    actions: Actions,
    private readonly wanted: StudyActions,
  ) {
    const tuning = new Tuning(actions, (inputs) => wanted.again(inputs));
    this.code = new Code(() => wanted.stepController());
    this.views = [this.prediction, tuning, this.step, this.checks, this.code];
    const below = this.views.filter((view) => view !== this.prediction);
    this.element = el("div", { class: "study" }, ...below.map((view) => view.element));
  }

  provide({ sources, design, paths }: Companions): void {
    this.step.provide(design);
    this.code.provide(sources, design.diagram ?? "", paths);
  }

  /** Ask for a judgement from time to time, and whenever the run pauses. */
  follow({ cycles, running }: Frame): void {
    const wall = performance.now();
    const judged = [this.step, this.checks, this.prediction];
    if (judged.every(({ element }) => element.hidden) || cycles === this.asked.cycles) return;
    if (cycles === 0 || (running && wall - this.asked.wall < PERIOD_MS)) return;
    this.asked = { cycles, wall };
    this.wanted.measure(this.prediction.signals);
  }

  measured(measured: Measured): void {
    for (const view of [this.step, this.checks, this.prediction]) view.measured(measured);
  }
}
