// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The schedule that the events of a run tell: who executed when, jobs and their response times. */
import { IDLE, Kind, unpack, type TraceEvent } from "./events";

/** An interval of execution; instants in cycles. */
export interface Interval {
  from: number;
  to: number;
}

/** A job from its nominal release to its completion (null while under way). */
export interface Job {
  release: number;
  completion: number | null;
  missed: boolean;
  /** Its response time is above the bound: then bound or program is not that of this run. */
  aboveBound: boolean;
}

/** What the jobs of a task are held against; times in cycles. */
export interface Limits {
  deadline: number | null;
  /** Proven response time. It holds after the start of all tasks. */
  bound: number | null;
  cyclic: boolean;
}

/** Statistics of a task over the whole run. */
export interface Statistics {
  jobs: number;
  worst: number;
  last: number;
  misses: number;
  /** The longest response time of the jobs that a bound concerns, and how many are above it. */
  worstBounded: number;
  aboveBound: number;
}

const HISTORY_MAX = 20_000;

/** A lane of the timeline. */
export class Lane {
  readonly intervals: Interval[] = [];
  readonly jobs: Job[] = [];
  readonly statistics: Statistics = {
    jobs: 0,
    worst: 0,
    last: 0,
    misses: 0,
    worstBounded: 0,
    aboveBound: 0,
  };
  limits: Limits = { deadline: null, bound: null, cyclic: false };
  busy = 0;
  /** Release of the second job: the first one of a cyclic task only waits for it. */
  begin: number | null = null;
  private first: number | null = null;

  addInterval(from: number, to: number): void {
    this.busy += to - from;
    this.intervals.push({ from, to });
    if (this.intervals.length > 2 * HISTORY_MAX) this.intervals.splice(0, HISTORY_MAX);
  }

  released(release: number): void {
    if (this.first === null) this.first = release;
    else this.begin ??= release;
    this.jobs.push({ release, completion: null, missed: false, aboveBound: false });
    if (this.jobs.length > 2 * HISTORY_MAX) this.jobs.splice(0, HISTORY_MAX);
  }

  /** A job ends; `begin` is when all tasks have started, null before. */
  completed(release: number, at: number, begin: number | null): void {
    const job = this.jobs.findLast((known) => known.release === release);
    const response = at - release;
    const { deadline, bound } = this.limits;
    const late = deadline !== null && response > deadline;
    if (bound !== null && begin !== null && release >= begin && release !== this.first) {
      this.statistics.worstBounded = Math.max(this.statistics.worstBounded, response);
      if (response > bound) {
        this.statistics.aboveBound += 1;
        if (job) job.aboveBound = true;
      }
    }
    if (job) {
      // A miss that was seen while the job was still under way is counted already.
      if (late && !job.missed) this.statistics.misses += 1;
      job.completion = at;
      job.missed ||= late;
    }
    this.statistics.jobs += 1;
    this.statistics.last = response;
    this.statistics.worst = Math.max(this.statistics.worst, response);
  }

  /** Jobs under way whose deadline has passed are misses too. */
  checkDeadline(now: number): void {
    const job = this.jobs.at(-1);
    const { deadline } = this.limits;
    if (!job || job.completion !== null || job.missed || deadline === null) return;
    if (now - job.release > deadline) {
      job.missed = true;
      this.statistics.misses += 1;
    }
  }
}

/** Lanes of threads and interrupt sources, fed with packed events as they come. */
export class Schedule {
  readonly threads = new Map<number, Lane>();
  readonly interrupts = new Map<number, Lane>();
  now = 0;
  private running: { subject: number; since: number } | null = null;
  private handlers: { source: number; since: number }[] = [];

  /** `cyclicTasks` is how many there will be: not all are there from the beginning. */
  constructor(private readonly cyclicTasks = 0) {}

  setLimits(thread: number, limits: Limits): void {
    this.lane(thread).limits = limits;
  }

  /** When the last cyclic task begins its cycle; null while one has not. */
  get begin(): number | null {
    let [begin, known] = [0, 0];
    for (const lane of this.threads.values()) {
      if (!lane.limits.cyclic) continue;
      if (lane.begin === null) return null;
      begin = Math.max(begin, lane.begin);
      known += 1;
    }
    return known < this.cyclicTasks ? null : begin;
  }

  add(packed: Uint8Array, now: number): void {
    for (const event of unpack(packed)) this.process(event);
    this.now = now;
    for (const lane of this.threads.values()) lane.checkDeadline(now);
  }

  /** The interval under way of a lane, up to the present. */
  current(lane: Lane): Interval | null {
    const running = this.running;
    if (running && this.threads.get(running.subject) === lane && this.handlers.length === 0) {
      return { from: running.since, to: this.now };
    }
    const top = this.handlers.at(-1);
    if (top && this.interrupts.get(top.source) === lane) return { from: top.since, to: this.now };
    return null;
  }

  private lane(thread: number): Lane {
    let lane = this.threads.get(thread);
    if (!lane) {
      lane = new Lane();
      this.threads.set(thread, lane);
    }
    return lane;
  }

  private interrupt(source: number): Lane {
    let lane = this.interrupts.get(source);
    if (!lane) this.interrupts.set(source, (lane = new Lane()));
    return lane;
  }

  private closeRunning(at: number): void {
    if (!this.running) return;
    if (at > this.running.since) {
      this.lane(this.running.subject).addInterval(this.running.since, at);
    }
    this.running.since = at;
  }

  private process({ at, kind, subject, value }: TraceEvent): void {
    switch (kind) {
      case Kind.thread_running:
        if (this.handlers.length === 0) this.closeRunning(at);
        this.running = subject === IDLE ? null : { subject, since: at };
        break;
      case Kind.release:
        this.lane(subject).released(value);
        break;
      case Kind.completion:
        this.lane(subject).completed(value, at, this.begin);
        break;
      case Kind.interrupt_entered:
        this.enter(at, subject);
        break;
      case Kind.interrupt_left:
        this.leave(at);
        break;
    }
  }

  private enter(at: number, source: number): void {
    const top = this.handlers.at(-1);
    if (top) this.interrupt(top.source).addInterval(top.since, at);
    else this.closeRunning(at);
    this.handlers.push({ source, since: at });
  }

  private leave(at: number): void {
    const left = this.handlers.pop();
    if (left) this.interrupt(left.source).addInterval(left.since, at);
    const top = this.handlers.at(-1);
    if (top) top.since = at;
    else if (this.running) this.running.since = at;
  }
}
