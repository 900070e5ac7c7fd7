// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// `node digest.mjs RUN ELF`: what the example `digest` of the façade does, in WebAssembly.
import { readFileSync } from "node:fs";
import { initSync, VirtualBrick } from "../../../web/generated/virtual_brick.js";

const here = (name) => new URL(`../../../web/generated/${name}`, import.meta.url);
const [runFile, elfFile] = process.argv.slice(2);
const run = JSON.parse(readFileSync(runFile, "utf-8"));

initSync({ module: readFileSync(here("virtual_brick_bg.wasm")) });
const brick = new VirtualBrick(JSON.stringify(run.configuration), readFileSync(elfFile));
for (const { symbol, kind } of run.probes) brick.add_probe(symbol, kind ?? "");
for (const { at_cycles, name, value } of run.inputs) brick.schedule_input(at_cycles, name, value);
const began = performance.now();
brick.run_until(run.until_cycles);
const seconds = (performance.now() - began) / 1000;
const virtual_seconds = brick.cycles() / VirtualBrick.clock_hz();
console.log(JSON.stringify({ digest: brick.digest(), seconds, virtual_seconds }));
