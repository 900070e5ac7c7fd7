// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The scope: any signal, pin or symbol over time. */
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { seconds } from "../clock";
import { colour, el, panel } from "../dom";
import type { Frame, Ready } from "../protocol";
import type { Actions, View } from "./view";

const ROWS_MAX = 60_000;
const REDRAW_MS = 60;
const COLOURS = ["#2f6fab", "#c4572b", "#3b8a4b", "#8455a8", "#a67c00", "#607080", "#b03060"];
const HEIGHT_MIN = 120;

export class Scope implements View {
  readonly element: HTMLElement;
  channels: string[] = [];
  /** Instants, then a column per channel; null before the first sample of a signal. */
  private columns: (number | null)[][] = [[]];
  private accepted: [string[], (number | null)[][]] = [[], [[]]];
  private plot: uPlot | null = null;
  private drawn = 0;
  private readonly known = el("datalist", { id: "channels" });
  /** What can be shown, in the list once somebody is about to choose. */
  private names: string[] = [];
  private readonly name = el("input", {
    id: "channel",
    list: "channels",
    placeholder: "signal:… pin:… symbol:…",
    "aria-label": "Signal, pin or symbol to show",
    spellcheck: "false",
    autocomplete: "off",
    focus: () => this.offer(),
  });
  private readonly window = el(
    "select",
    { "aria-label": "Width of the scope", change: () => this.draw(true) },
    ...[1, 5, 20, 60].map((s) => el("option", { value: s, selected: s === 5 }, `${s} s`)),
  );
  private readonly period = el(
    "select",
    { "aria-label": "Sampling period of the scope", change: () => this.choose(this.channels) },
    ...[0.1, 1, 10].map((ms) => el("option", { value: ms, selected: ms === 1 }, `${ms} ms`)),
  );
  /** Value of each channel at the cursor, else the last. */
  private values: HTMLOutputElement[] = [];
  private readonly chosen = el("ul", { class: "chips", "aria-label": "Shown channels" });
  private readonly figure = el("div", { id: "scope-plot" });

  constructor(private readonly actions: Actions) {
    const add = el("button", { type: "submit" }, "show");
    const form = el("form", { class: "row" }, this.name, this.known, add, this.window, this.period);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.addChannel(this.name.value.trim());
      this.name.value = "";
    });
    this.element = panel("scope", "Scope", [form], this.chosen, this.figure);
  }

  ready({ channels }: Ready): void {
    const pins = Array.from({ length: 32 }, (_, pin) => `pin:${pin}`);
    const signals = channels.signals.map((name) => `signal:${name}`);
    const symbols = channels.symbols.map(({ name }) => `symbol:${name}`);
    this.names = [...signals, ...pins, ...symbols];
    this.known.replaceChildren();
    const first = ["signal:motor.B.angular_velocity", "signal:motor.C.angular_velocity"];
    if (this.channels.length === 0) this.channels = first.filter((name) => signals.includes(name));
    this.choose(this.channels);
  }

  private offer(): void {
    if (this.known.childElementCount > 0) return;
    this.known.replaceChildren(...this.names.map((value) => el("option", { value })));
  }

  /** Show one more channel; what the core refuses is taken out again by `undo`. */
  addChannel(channel: string): void {
    const full = channel.includes(":") ? channel : `symbol:${channel}`;
    if (channel && !this.channels.includes(full)) this.choose([...this.channels, full]);
  }

  /** The core refused the last choice: it goes on with the one before, and so does the plot. */
  undo(): void {
    const [channels, columns] = this.accepted;
    // Another image may refuse what was shown before.
    if (channels.join() === this.channels.join()) return this.choose(channels.slice(0, -1));
    [this.channels, this.columns] = [channels, columns];
    this.arrange();
  }

  frame({ scope, running }: Frame): void {
    const width = this.channels.length + 1;
    if (width === 1 || scope.length % width !== 0) return;
    for (let at = 0; at < scope.length; at += width) {
      this.columns.forEach((column, index) => {
        const value = scope[at + index] ?? Number.NaN;
        column.push(index === 0 ? seconds(value) : Number.isNaN(value) ? null : value);
      });
    }
    const surplus = (this.columns[0]?.length ?? 0) - ROWS_MAX;
    if (surplus > 0) for (const column of this.columns) column.splice(0, surplus);
    this.draw(!running);
  }

  private choose(channels: string[]): void {
    this.accepted = [this.channels, this.columns];
    this.channels = channels;
    this.columns = Array.from({ length: channels.length + 1 }, () => []);
    this.actions.scope(channels, Number(this.period.value));
    this.arrange();
  }

  private arrange(): void {
    const { channels } = this;
    this.values = channels.map(() => el("output", {}));
    this.chosen.replaceChildren(
      ...channels.map((channel, index) => {
        const remove = el(
          "button",
          {
            type: "button",
            "aria-label": `Remove ${channel}`,
            click: () => this.choose(this.channels.filter((other) => other !== channel)),
          },
          "×",
        );
        const name = el("span", {}, channel.replace(/^(signal|symbol):/, ""));
        const chip = el("li", {}, name, this.values[index] ?? null, remove);
        chip.style.borderColor = COLOURS[index % COLOURS.length] ?? "";
        return chip;
      }),
    );
    this.plot?.destroy();
    this.plot = null;
    if (channels.length > 0 && this.figure.clientWidth > 0) this.plot = this.create();
    this.draw(true);
  }

  private create(): uPlot {
    const series = this.channels.map((channel, index) => ({
      stroke: COLOURS[index % COLOURS.length] ?? "black",
      width: 1.5,
      paths: (channel.startsWith("pin:") && uPlot.paths.stepped?.({ align: 1 })) || null,
    }));
    const [stroke, line] = [colour("ink"), { stroke: colour("grid"), width: 1 }];
    const axis = { stroke, grid: line, ticks: line };
    const options: uPlot.Options = {
      ...this.size(),
      scales: { x: { time: false } },
      axes: [
        { ...axis, size: 32, values: (_, instants) => instants.map((instant) => `${instant} s`) },
        { ...axis, size: 60 },
      ],
      legend: { show: false },
      hooks: { setCursor: [(plot) => this.read(plot)], setData: [(plot) => this.read(plot)] },
      series: [{}, ...(series as uPlot.Series[])],
    };
    return new uPlot(options, this.columns as uPlot.AlignedData, this.figure);
  }

  private read({ cursor, data }: uPlot): void {
    this.values.forEach((output, index) => {
      const column = data[index + 1] ?? [];
      const value = cursor.idx == null ? column.at(-1) : column[cursor.idx];
      output.value = value == null ? "–" : value.toPrecision(4);
    });
  }

  private size(): { width: number; height: number } {
    const { clientWidth: width, clientHeight } = this.figure;
    return { width, height: Math.max(HEIGHT_MIN, clientHeight) };
  }

  private draw(now = false): void {
    const wall = performance.now();
    const times = this.columns[0] ?? [];
    if (!this.plot || times.length === 0 || (!now && wall - this.drawn < REDRAW_MS)) return;
    this.drawn = wall;
    const end = times.at(-1) ?? 0;
    const size = this.size();
    const changed = size.width !== this.plot.width || size.height !== this.plot.height;
    if (changed) this.plot.setSize(size);
    const from = Math.max(0, end - Number(this.window.value));
    const first = Math.max(
      0,
      times.findIndex((time) => time !== null && time >= from),
    );
    const shown = this.columns.map((column) => column.slice(first));
    this.plot.setData(shown as uPlot.AlignedData);
  }
}
