// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The worker: runs the brick beside the page and reports once per picture. */
import initialise, { VirtualBrick } from "../generated/virtual_brick";
import type { Command, Report } from "./protocol";
import { Simulation } from "./simulation";

const TICK_MS = 16;
const BUDGET_MS = 13;
/** A frame that the page has not answered after this time is taken for lost. */
const PATIENCE_MS = 2000;

const simulation = new Simulation(VirtualBrick);
let loaded = false;
let last = performance.now();
let announced = false;
let replayed: string | null = null;
/** When the frame was sent that the page has not shown yet: a slow page gets fewer of them. */
let unseen: number | null = null;

function send(report: Report): void {
  const transfer: Transferable[] = [];
  if (report.kind === "frame") transfer.push(report.events.buffer, report.scope.buffer);
  self.postMessage(report, { transfer });
}

function frame(): void {
  unseen = performance.now();
  send(simulation.frame(unseen));
}

/** A replayed run that has come to its end is compared with the one that was saved. */
function compare(): void {
  if (!simulation.atGoal || announced || !replayed) return;
  announced = true;
  send({ kind: "replayed", expected: replayed, found: simulation.digest() });
}

function obey(command: Command): void {
  switch (command.kind) {
    case "load":
      replayed = null;
      send(simulation.load(command.session, command.elf));
      loaded = true;
      break;
    case "replay":
      replayed = command.run.digest;
      announced = false;
      send(simulation.load(command.run, command.elf, command.run));
      loaded = true;
      break;
    case "reset":
      announced = false;
      send(simulation.reset());
      break;
    case "run":
      simulation.running = !simulation.ended && !simulation.atGoal;
      last = performance.now();
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
    case "save":
      send({ kind: "saved", ...simulation.save() });
      break;
  }
}

self.addEventListener("message", (message: MessageEvent<Command>) => {
  const command = message.data;
  if (command.kind === "shown") {
    unseen = null;
    return;
  }
  try {
    if (!loaded && command.kind !== "load" && command.kind !== "replay") return;
    obey(command);
    frame();
    compare();
  } catch (error) {
    const text = error instanceof Error ? error.message : String(error);
    send({ kind: "failure", of: command.kind, message: text });
  }
});

function tick(): void {
  const now = performance.now();
  if (simulation.running) {
    simulation.advance(Math.min(now - last, 250), BUDGET_MS, () => performance.now());
    const free = unseen === null || now - unseen > PATIENCE_MS;
    if (free || !simulation.running) frame();
    compare();
  }
  last = now;
  setTimeout(tick, Math.max(0, TICK_MS - (performance.now() - now)));
}

await initialise();
send({ kind: "started" });
tick();
