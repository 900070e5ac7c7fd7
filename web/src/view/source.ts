// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The source text around the place where the program is paused. */
import { panel } from "../dom";
import type { Frame, Place } from "../protocol";
import { Listing, type Sources } from "./listing";
import type { View } from "./view";

export class Source implements View {
  readonly element: HTMLElement;
  private place: Place | null = null;
  private readonly listing = new Listing("source", "Source text");

  constructor() {
    this.element = panel("source", "Source", [this.listing.where], this.listing.text);
  }

  /** Sources of the image that is loaded; none for an image from elsewhere. */
  provide(sources: Sources): void {
    this.listing.provide(sources, null);
    this.show();
  }

  ready(): void {
    this.place = null;
    this.show();
  }

  frame({ running, place }: Frame): void {
    this.element.classList.toggle("past", running);
    if (running || JSON.stringify(place) === JSON.stringify(this.place)) return;
    this.place = place;
    this.show();
  }

  private show(): void {
    const { file, line } = this.place?.raised ?? this.place ?? { file: null, line: null };
    const place = file === null || line === null ? null : { file, line };
    if (!this.listing.show(place)) this.listing.explain(this.reason(file));
  }

  private reason(file: string | null): string {
    if (!this.place) return "Paused, the program shows its source line here.";
    const name = this.place.function;
    if (file !== null) return `${file} is not in the project, the drivers or the run-time.`;
    return `The code ${name ? `of ${name} ` : ""}has no source line.`;
  }
}
