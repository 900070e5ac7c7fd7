// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** What the brick's loudspeaker plays, heard. */
import { CLOCK_HZ } from "../clock";
import { el } from "../dom";
import type { Frame } from "../protocol";

const SAMPLE_CYCLES = 1000;
const LATENCY_S = 0.08;

export class Sound {
  readonly element: HTMLElement;
  private context: AudioContext | null = null;
  private next = 0;

  constructor() {
    const change = () => this.switchTo(box.checked);
    const box = el("input", { type: "checkbox", id: "sound", change });
    this.element = el("label", { class: "switch" }, box, "sound");
  }

  frame({ sound }: Frame, factor: number): void {
    if (!this.context || sound.length === 0 || !Number.isFinite(factor)) return;
    const buffer = this.context.createBuffer(1, sound.length, CLOCK_HZ / SAMPLE_CYCLES);
    const channel = buffer.getChannelData(0);
    sound.forEach((value, at) => (channel[at] = value / 32768));
    const source = this.context.createBufferSource();
    source.buffer = buffer;
    source.playbackRate.value = factor;
    source.connect(this.context.destination);
    const now = this.context.currentTime;
    this.next = Math.max(this.next, now + LATENCY_S / 2);
    if (this.next < now + 4 * LATENCY_S) {
      source.start(this.next);
      this.next += buffer.duration / factor;
      const played = Number(this.element.dataset["played"] ?? 0) + sound.length;
      this.element.dataset["played"] = String(played);
    }
  }

  private switchTo(on: boolean): void {
    void this.context?.close();
    this.context = on ? new AudioContext() : null;
    this.next = 0;
  }
}
