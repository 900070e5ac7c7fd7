// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Start: worker, page, service worker. */
import coreAddress from "../generated/virtual_brick_bg.wasm?url";
import { App } from "./app";
import { fetchFile, startWorker } from "./files";
import { placeOf } from "./place";
import type { Command, Report } from "./protocol";
import "./style/base.css";
import "./style/views.css";
import "./style/study.css";
import "./style/layout.css";
import "./style/embedded.css";
import workerAddress from "./worker?worker&url";

const page = document.getElementById("page");
if (!page) throw new Error("index.html has no element #page");

// First of all: the core takes longest, and the page is made meanwhile.
const starting = startWorker(workerAddress, coreAddress);
const place = placeOf(location);
const { name, embedded } = place;
document.documentElement.classList.toggle("embedded", embedded);
let worker: Worker | null = null;
const waiting: Command[] = [];
const send = (command: Command) =>
  worker ? worker.postMessage(command) : void waiting.push(command);
const begins = place.runs && !matchMedia("(prefers-reduced-motion: reduce)").matches;
// Nobody predicts a run that begins by itself.
const app = new App(page, { send }, { name, embedded, asks: !begins });

async function startBrick(): Promise<void> {
  const { worker: started, sent } = await starting;
  started.addEventListener("message", ({ data }: MessageEvent<Report>) => {
    if (data.kind === "started") {
      worker = started;
      for (const command of waiting.splice(0)) worker.postMessage(command);
    }
    app.receive(data);
  });
  started.addEventListener("error", (event) => {
    app.toolbar.showError(
      `The brick cannot run in this browser: ${event.message || "no WebAssembly"}`,
    );
  });
  await sent;
}

startBrick().catch((error: Error) => {
  app.toolbar.showError(`The brick cannot be loaded: ${error.message}`);
});
const begun = app.begin(location.hash, fetchFile, place.folder);
// The studio around this page says when there is a new image; it hears when that runs.
addEventListener("message", async ({ origin, source, data }) => {
  if (origin !== location.origin || source !== parent || data !== "new image") return;
  await begun;
  await app.renew(fetchFile, () => parent.postMessage("moving", location.origin));
});
void begun.then(() => {
  if (begins) app.show();
  // The site that the page is a part of has its own service worker.
  if (place.shared || !("serviceWorker" in navigator) || !isSecureContext) return;
  // Without one (a private window, a file) the page works as long as its server does.
  navigator.serviceWorker.register("./offline.js").catch(() => undefined);
});
