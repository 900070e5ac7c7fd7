// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Files beside the page: from its server, or from the script `files.js` on the disk. */
import { el } from "./dom";

/** Files by name: gzip, then base64. From the disk a browser reads nothing but scripts. */
type Packed = Record<string, string>;

declare global {
  /** The files of the folder whose script was run last. */
  var packedFiles: Packed | undefined;
}

const FROM_DISK = location.protocol === "file:";
const folders = new Map<string, Promise<Packed>>();

function runScript(folder: string): Promise<Packed> {
  return new Promise((found, failed) => {
    const load = () => found(globalThis.packedFiles ?? {});
    const error = () => failed(new Error(`${folder}files.js is missing`));
    document.head.append(el("script", { src: `${folder}files.js`, load, error }));
  });
}

async function fromDisk(address: string): Promise<Response> {
  const [folder, name] = [address.replace(/[^/]*$/, ""), address.replace(/^.*\//, "")];
  const packed = folders.get(folder) ?? runScript(folder);
  folders.set(folder, packed);
  const text = (await packed)[name];
  if (text === undefined) return new Response(null, { status: 404 });
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")));
}

/** A file of the page or of the project beside it. */
export function fetchFile(address: string): Promise<Response> {
  return FROM_DISK ? fromDisk(address) : fetch(address);
}

/** The core; a server that names its type has it compiled while it is loaded. */
async function compiled(core: string): Promise<WebAssembly.Module> {
  const file = await fetchFile(core);
  if (!file.ok) throw new Error(`${core} is missing`);
  if (file.headers.get("Content-Type") === "application/wasm") {
    return WebAssembly.compileStreaming(file);
  }
  return WebAssembly.compile(await file.arrayBuffer());
}

/**
 * Start the worker, one from the disk from its text; meanwhile load the core. `sent` is done when
 * the core is on its way to the worker.
 */
export async function startWorker(
  script: string,
  core: string,
): Promise<{ worker: Worker; sent: Promise<void> }> {
  const module = compiled(core);
  const text = FROM_DISK ? await (await fetchFile(script)).blob() : null;
  const worker = new Worker(text ? URL.createObjectURL(text) : script);
  return { worker, sent: module.then((loaded) => worker.postMessage(loaded)) };
}
