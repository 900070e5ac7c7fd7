// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The worker: runs the brick beside the page and reports once per picture. */
import initialise, { VirtualBrick } from "../generated/virtual_brick";
import type { Command, Report } from "./protocol";
import { Simulation } from "./simulation";

const TICK_MS = 16;
const BUDGET_MS = 13;
/** A frame that the page has not answered after this time is taken for lost. */
const FRAME_TIMEOUT_MS = 2000;

const simulation = new Simulation(VirtualBrick);
let loaded = false;
let lastTick = performance.now();
let compared = false;
let expectedDigest: string | null = null;
/** Brings the next tick behind the messages of the page that wait. */
const nextTick = new MessageChannel();
nextTick.port1.onmessage = tick;
/** When the frame was sent that the page has not shown yet: a slow page gets fewer of them. */
let frameSentAt: number | null = null;

function send(report: Report): void {
  const transfer: Transferable[] = [];
  if (report.kind === "frame") transfer.push(report.events.buffer, report.scope.buffer);
  self.postMessage(report, { transfer });
}

function frame(): void {
  frameSentAt = performance.now();
  send(simulation.frame(frameSentAt));
}

/** A replayed run that has come to its end is compared with the one that was saved. */
function compareDigests(): void {
  if (!simulation.replayEnded || compared || !expectedDigest) return;
  compared = true;
  send({ kind: "replayed", expected: expectedDigest, found: simulation.digest() });
}

function apply(command: Command): void {
  switch (command.kind) {
    case "load":
      expectedDigest = null;
      send(simulation.load(command.session, command.elf));
      loaded = true;
      break;
    case "replay":
      expectedDigest = command.run.digest;
      compared = false;
      send(simulation.load(command.run, command.elf, command.run));
      loaded = true;
      break;
    case "reset":
      compared = false;
      send(simulation.reset(command.inputs));
      break;
    case "run":
      // Whoever goes on after the end of a replayed run leaves it.
      if (compared) simulation.leaveReplay();
      if (command.fromMotion) simulation.runToMotion();
      simulation.running = !simulation.ended;
      lastTick = performance.now();
      break;
    case "pause":
      simulation.running = false;
      break;
    case "speed":
      simulation.factor = command.factor;
      break;
    case "step":
      simulation.step(command.by, command.thread);
      break;
    case "input":
      simulation.input(command.name, command.value);
      break;
    case "scope":
      simulation.chooseScope(command.channels, command.period_ms);
      break;
    case "measure":
      send(simulation.measure(command.signals));
      break;
    case "save":
      send({ kind: "saved", ...simulation.save() });
      break;
  }
}

function execute(command: Command): void {
  if (command.kind === "shown") {
    frameSentAt = null;
    return;
  }
  try {
    if (!loaded && command.kind !== "load" && command.kind !== "replay") return;
    apply(command);
    frame();
    compareDigests();
  } catch (error) {
    const text = error instanceof Error ? error.message : String(error);
    send({ kind: "failure", of: command.kind, message: text });
  }
}

function tick(): void {
  const now = performance.now();
  if (simulation.running) {
    simulation.advance(Math.min(now - lastTick, 250), BUDGET_MS, () => performance.now());
    const pageIsReady = frameSentAt === null || now - frameSentAt > FRAME_TIMEOUT_MS;
    if (pageIsReady || !simulation.running) frame();
    compareDigests();
  }
  lastTick = now;
  // Browsers round the shortest of timers up to 4 ms: as fast as possible is without one.
  if (simulation.running && simulation.factor === Infinity) nextTick.port2.postMessage(null);
  else setTimeout(tick, Math.max(0, TICK_MS - (performance.now() - now)));
}

/** The core, which the page sends first. */
function handedOver(): Promise<WebAssembly.Module> {
  return new Promise((found) => {
    const first = ({ data }: MessageEvent<WebAssembly.Module>) => found(data);
    self.addEventListener("message", first, { once: true });
  });
}

async function begin(): Promise<void> {
  await initialise({ module_or_path: await handedOver() });
  self.addEventListener("message", (message: MessageEvent<Command>) => execute(message.data));
  send({ kind: "started" });
  tick();
}

begin().catch((error: Error) => {
  setTimeout(() => {
    throw error;
  });
});
