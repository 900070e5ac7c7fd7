// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The schedule as it happens: a lane per task and interrupt source, and a table of jobs. */
import { CLOCK_HZ } from "../clock";
import { colour, el, panel, surface } from "../dom";
import { sourceName } from "../events";
import type { Frame, Ready, Thread } from "../protocol";
import { Schedule, type Job, type Lane, type Interval } from "../schedule";
import type { Task } from "../session";
import type { View } from "./view";

const LANE_HEIGHT = 24;
const LABEL_WIDTH = 130;
const AXIS_HEIGHT = 18;
const REDRAW_MS = 100;
const US = 1e6 / CLOCK_HZ;

interface Row {
  label: string;
  lane: Lane;
  task: Task | null;
  interrupt: boolean;
}

function microseconds(cycles: number): string {
  return `${(cycles * US).toFixed(0)} µs`;
}

export class Timeline implements View {
  readonly element: HTMLElement;
  private schedule = new Schedule();
  private tasks: Task[] = [];
  private threads: Thread[] = [];
  private drawn = 0;
  private readonly canvas = el("canvas", {
    id: "timeline-view",
    role: "img",
    "aria-label": "Schedule: execution of tasks and interrupts over time",
  });
  private readonly width = el(
    "select",
    { "aria-label": "Width of the schedule", change: () => this.draw() },
    ...[2, 10, 50, 200, 1000].map((ms) =>
      el("option", { value: ms, selected: ms === 50 }, `${ms} ms`),
    ),
  );
  private readonly note = el("p", { class: "note" });
  private readonly body = el("tbody", {});

  constructor() {
    const heads = ["task", "jobs", "last", "worst", "deadline", "misses", "bound", "of bound"];
    heads.push("processor");
    const head = el("tr", {}, ...heads.map((name) => el("th", { scope: "col" }, name)));
    const table = el("table", {}, el("thead", {}, head), this.body);
    const legend = "■ executes  □ from release ↑ to completion  ↓ deadline (missed: red)  ┤ bound";
    this.element = panel(
      "timeline",
      "Schedule",
      [this.width, el("span", { class: "note" }, legend)],
      this.canvas,
      el("div", { class: "scrolled", role: "region", tabindex: 0, "aria-label": "Tasks" }, table),
      this.note,
    );
  }

  ready({ session, unobserved }: Ready): void {
    this.tasks = session.tasks;
    const cyclic = this.tasks.filter((task) => task.release === "cyclic");
    this.schedule = new Schedule(cyclic.length);
    this.threads = [];
    this.note.textContent = unobserved ? `Tasks cannot be observed: ${unobserved}` : "";
    this.draw();
  }

  frame(frame: Frame): void {
    this.threads = frame.threads;
    frame.threads.forEach((thread, index) => {
      const task = this.task(thread.name);
      this.schedule.setLimits(index, {
        deadline: task?.deadline_us == null ? null : task.deadline_us / US,
        bound: task?.bound_cycles ?? null,
        cyclic: task?.release === "cyclic",
      });
    });
    this.schedule.add(frame.events, frame.cycles);
    const wall = performance.now();
    if (frame.running && wall - this.drawn < REDRAW_MS) return;
    this.drawn = wall;
    this.draw();
    this.updateTable();
  }

  /** Index of the thread whose jobs are stepped: that of a task's name, or any. */
  threadOf(name: string): number {
    return this.threads.findIndex((thread) => thread.name === name);
  }

  get names(): string[] {
    return this.threads.map((thread) => thread.name);
  }

  private task(name: string): Task | undefined {
    return this.tasks.find((task) => task.name === name);
  }

  private rows(): Row[] {
    const interrupts = [...this.schedule.interrupts]
      .sort(([a], [b]) => a - b)
      .map(([source, lane]) => ({ label: sourceName(source), lane, task: null, interrupt: true }));
    const tasks = [...this.schedule.threads]
      .map(([index, lane]) => ({ thread: this.threads[index], lane }))
      .sort((a, b) => (b.thread?.priority ?? 0) - (a.thread?.priority ?? 0))
      .map(({ thread, lane }) => ({
        label: thread?.name || "?",
        lane,
        task: this.task(thread?.name ?? "") ?? null,
        interrupt: false,
      }));
    return [...interrupts, ...tasks];
  }

  private draw(): void {
    const rows = this.rows();
    this.canvas.style.height = `${Math.max(1, rows.length) * LANE_HEIGHT + AXIS_HEIGHT}px`;
    const drawing = surface(this.canvas);
    if (!drawing) return;
    const { context, width, height } = drawing;
    const span = (Number(this.width.value) / 1000) * CLOCK_HZ;
    const from = this.schedule.now - span;
    const place = (at: number) => LABEL_WIDTH + ((at - from) / span) * (width - LABEL_WIDTH);
    context.font = "12px system-ui, sans-serif";
    rows.forEach((row, index) => this.lane(context, row, index * LANE_HEIGHT, from, place));
    this.axis(context, width, height, from, span, place);
  }

  private lane(
    context: CanvasRenderingContext2D,
    row: Row,
    top: number,
    from: number,
    place: (at: number) => number,
  ): void {
    const base = top + LANE_HEIGHT - 4;
    context.fillStyle = colour("ink");
    context.fillText(row.label, 4, base - 6, LABEL_WIDTH - 8);
    context.save();
    context.beginPath();
    context.rect(LABEL_WIDTH, top, 1e5, LANE_HEIGHT);
    context.clip();
    const open = this.schedule.current(row.lane);
    const intervals = open
      ? [...recent(row.lane.intervals, from), open]
      : recent(row.lane.intervals, from);
    context.fillStyle = colour(row.interrupt ? "interrupt" : "accent");
    for (const interval of intervals) {
      const left = place(interval.from);
      context.fillRect(left, top + 10, Math.max(0.75, place(interval.to) - left), base - top - 10);
    }
    for (const job of row.lane.jobs.slice(-500)) this.job(context, row.lane, job, top, place);
    context.restore();
  }

  /** A job's outline, an arrow up at its release, one down at its deadline, its bound as ┤. */
  private job(
    context: CanvasRenderingContext2D,
    { limits }: Lane,
    job: Job,
    top: number,
    place: (at: number) => number,
  ): void {
    const [high, base] = [top + 2, top + LANE_HEIGHT - 4];
    const end = job.completion ?? this.schedule.now;
    const left = place(job.release);
    if (Math.max(place(end), place(job.release + (limits.deadline ?? 0))) < LABEL_WIDTH) return;
    context.strokeStyle = colour(job.missed ? "missed" : job.aboveBound ? "bound" : "job");
    context.lineWidth = job.missed || job.aboveBound ? 2 : 1;
    context.strokeRect(left, top + 8, Math.max(1, place(end) - left), base - top - 8);
    arrow(context, left, base, high);
    if (limits.deadline !== null) arrow(context, place(job.release + limits.deadline), high, base);
    if (limits.bound === null) return;
    const bound = place(job.release + limits.bound);
    context.strokeStyle = colour("bound");
    context.beginPath();
    context.moveTo(bound, top + 6);
    context.lineTo(bound, base + 2);
    context.moveTo(bound - 4, (top + 8 + base) / 2);
    context.lineTo(bound, (top + 8 + base) / 2);
    context.stroke();
  }

  private axis(
    context: CanvasRenderingContext2D,
    width: number,
    height: number,
    from: number,
    span: number,
    place: (at: number) => number,
  ): void {
    const step = span / Math.min(5, Math.max(1, Math.floor((width - LABEL_WIDTH) / 90)));
    context.fillStyle = colour("ink");
    context.textAlign = "center";
    for (let at = Math.ceil(from / step) * step; at <= from + span; at += step) {
      const x = place(at);
      if (at < 0 || x > width - 20) continue;
      context.fillText(`${((at / CLOCK_HZ) * 1000).toFixed(1)} ms`, x, height - 4);
    }
    context.textAlign = "start";
  }

  private updateTable(): void {
    const now = Math.max(1, this.schedule.now);
    const known = this.rows();
    const tasksFirst = [false, true].flatMap((kind) => known.filter((r) => r.interrupt === kind));
    const rows = tasksFirst.map(({ label, lane, task, interrupt }) => {
      const { jobs, last, worst, misses, worstBounded, aboveBound } = lane.statistics;
      const { bound } = lane.limits;
      const cells = interrupt
        ? ["", "", "", "", "", "", ""]
        : [
            String(jobs),
            microseconds(last),
            microseconds(worst),
            task?.deadline_us == null ? "–" : `${task.deadline_us} µs`,
            String(misses),
            bound === null ? "–" : microseconds(bound),
            bound === null || worstBounded === 0
              ? "–"
              : `${((100 * worstBounded) / bound).toFixed(1)} %`,
          ];
      const share = `${((100 * lane.busy) / now).toFixed(1)} %`;
      return el(
        "tr",
        { class: misses > 0 || aboveBound > 0 ? "missed" : "", "data-task": label },
        el("th", { scope: "row" }, label),
        ...[...cells, share].map((text) => el("td", {}, text)),
      );
    });
    this.body.replaceChildren(...rows);
  }
}

function arrow(context: CanvasRenderingContext2D, x: number, from: number, to: number): void {
  const back = Math.sign(from - to) * 4;
  context.beginPath();
  context.moveTo(x, from);
  context.lineTo(x, to);
  context.moveTo(x - 3, to + back);
  context.lineTo(x, to);
  context.lineTo(x + 3, to + back);
  context.stroke();
}

/** The intervals that end after an instant; they are sorted. */
function recent(intervals: readonly Interval[], from: number): Interval[] {
  let first = intervals.length;
  while (first > 0 && (intervals[first - 1]?.to ?? 0) >= from) first -= 1;
  return intervals.slice(first);
}
