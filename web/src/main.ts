// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Start: worker, page, service worker. */
import { App } from "./app";
import type { Command, Report } from "./protocol";
import "./style/base.css";
import "./style/views.css";
import "./style/study.css";
import "./style/layout.css";

const page = document.getElementById("page");
if (!page) throw new Error("index.html has no element #page");

const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
const waiting: Command[] = [];
let started = false;
const app = new App(page, {
  send: (command) => (started ? worker.postMessage(command) : void waiting.push(command)),
});

worker.addEventListener("message", ({ data }: MessageEvent<Report>) => {
  if (data.kind === "started") {
    started = true;
    for (const command of waiting.splice(0)) worker.postMessage(command);
  }
  app.receive(data);
});
worker.addEventListener("error", (event) => {
  app.toolbar.showError(
    `The brick cannot run in this browser: ${event.message || "no WebAssembly"}`,
  );
});

await app.begin(location.hash, (address) => fetch(address));
if ("serviceWorker" in navigator && isSecureContext) {
  // Without one (a private window, a file) the page works as long as its server does.
  navigator.serviceWorker.register("./offline.js").catch(() => undefined);
}
