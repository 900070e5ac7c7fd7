// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The schedule that the events of a run tell: who executed when, jobs and their response times. */
import { IDLE, Kind, unpack, type TraceEvent } from "./events";

/** A piece of execution; instants in cycles. */
export interface Piece {
  from: number;
  to: number;
}

/** A job from its nominal release to its completion (null while under way). */
export interface Job {
  release: number;
  completion: number | null;
  missed: boolean;
  /** Its response time is above the bound: then bound or program is not that of this run. */
  beyond: boolean;
}

/** What the jobs of a task are held against; times in cycles. */
export interface Limits {
  deadline: number | null;
  /** Proven response time. It holds after the start of all tasks. */
  bound: number | null;
  cyclic: boolean;
}

/** Figures of a task over the whole run. */
export interface Figures {
  jobs: number;
  worst: number;
  last: number;
  misses: number;
  /** The longest response time of the jobs that a bound concerns, and how many are above it. */
  bounded: number;
  beyond: number;
}

const KEPT = 20_000;

/** A lane of the timeline. */
export class Lane {
  readonly pieces: Piece[] = [];
  readonly jobs: Job[] = [];
  readonly figures: Figures = { jobs: 0, worst: 0, last: 0, misses: 0, bounded: 0, beyond: 0 };
  limits: Limits = { deadline: null, bound: null, cyclic: false };
  busy = 0;
  /** Release of the second job: the first one of a cyclic task only waits for it. */
  begin: number | null = null;
  private first: number | null = null;

  addPiece(from: number, to: number): void {
    this.busy += to - from;
    this.pieces.push({ from, to });
    if (this.pieces.length > 2 * KEPT) this.pieces.splice(0, KEPT);
  }

  released(release: number): void {
    if (this.first === null) this.first = release;
    else this.begin ??= release;
    this.jobs.push({ release, completion: null, missed: false, beyond: false });
    if (this.jobs.length > 2 * KEPT) this.jobs.splice(0, KEPT);
  }

  /** A job ends; `begin` is when all tasks have started, null before. */
  completed(release: number, at: number, begin: number | null): void {
    const job = this.jobs.findLast((known) => known.release === release);
    const response = at - release;
    const { deadline, bound } = this.limits;
    const late = deadline !== null && response > deadline;
    if (bound !== null && begin !== null && release >= begin && release !== this.first) {
      this.figures.bounded = Math.max(this.figures.bounded, response);
      if (response > bound) {
        this.figures.beyond += 1;
        if (job) job.beyond = true;
      }
    }
    if (job) {
      // A miss that was seen while the job was still under way is counted already.
      if (late && !job.missed) this.figures.misses += 1;
      job.completion = at;
      job.missed ||= late;
    }
    this.figures.jobs += 1;
    this.figures.last = response;
    this.figures.worst = Math.max(this.figures.worst, response);
  }

  /** Jobs under way whose deadline has passed are misses too. */
  notice(now: number): void {
    const job = this.jobs.at(-1);
    const { deadline } = this.limits;
    if (!job || job.completion !== null || job.missed || deadline === null) return;
    if (now - job.release > deadline) {
      job.missed = true;
      this.figures.misses += 1;
    }
  }
}

/** Lanes of threads and interrupt sources, fed with packed events as they come. */
export class Schedule {
  readonly threads = new Map<number, Lane>();
  readonly interrupts = new Map<number, Lane>();
  now = 0;
  private running: { subject: number; since: number } | null = null;
  private nested: { source: number; since: number }[] = [];

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
    for (const event of unpack(packed)) this.take(event);
    this.now = now;
    for (const lane of this.threads.values()) lane.notice(now);
  }

  /** The piece under way of a lane, up to the present. */
  open(lane: Lane): Piece | null {
    const running = this.running;
    if (running && this.threads.get(running.subject) === lane && this.nested.length === 0) {
      return { from: running.since, to: this.now };
    }
    const top = this.nested.at(-1);
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
      this.lane(this.running.subject).addPiece(this.running.since, at);
    }
    this.running.since = at;
  }

  private take({ at, kind, subject, value }: TraceEvent): void {
    switch (kind) {
      case Kind.thread_running:
        if (this.nested.length === 0) this.closeRunning(at);
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
    const top = this.nested.at(-1);
    if (top) this.interrupt(top.source).addPiece(top.since, at);
    else this.closeRunning(at);
    this.nested.push({ source, since: at });
  }

  private leave(at: number): void {
    const left = this.nested.pop();
    if (left) this.interrupt(left.source).addPiece(left.since, at);
    const top = this.nested.at(-1);
    if (top) top.since = at;
    else if (this.running) this.running.since = at;
  }
}
