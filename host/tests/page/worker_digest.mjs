// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// `node worker_digest.mjs WORKER RUN ELF`: replays a run file in the page's worker, without a
// browser, and prints the trace digest.
import { readdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { pathToFileURL } from "node:url";

const [worker, runFile, elfFile] = process.argv.slice(2);
const run = JSON.parse(readFileSync(runFile, "utf-8"));
const core = readdirSync(dirname(worker)).find((name) => name.endsWith(".wasm"));
let begin;
const started = new Promise((done) => (begin = done));
globalThis.self = Object.assign(new EventTarget(), {
  location: pathToFileURL(worker),
  postMessage(report) {
    if (report.kind === "started") begin();
    if (report.kind === "failure") throw new Error(report.message);
    if (report.kind !== "replayed") return;
    console.log(report.found);
    process.exit(0);
  },
});
const send = (data) => self.dispatchEvent(Object.assign(new Event("message"), { data }));
await import(pathToFileURL(worker));
send(new WebAssembly.Module(readFileSync(join(dirname(worker), core))));
await started;
send({ kind: "replay", run, elf: new Uint8Array(readFileSync(elfFile)) });
send({ kind: "speed", factor: Infinity });
send({ kind: "run" });
