// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Runs as files and links. The format is described in docs/reference/run-files.md. */
import { withoutDebugInformation } from "./elf";
import type { Run } from "./session";

export const FORMAT = "ravenbrick run";
export const VERSION = 1;
const LINK_MARK = "#run=";

/** A file or link that holds no run; the text says what was expected. */
export class RunFileError extends Error {}

export interface StoredRun {
  run: Run;
  elf: Uint8Array;
}

function toBase64(bytes: Uint8Array): string {
  let text = "";
  for (let at = 0; at < bytes.length; at += 0x8000) {
    text += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
  }
  return btoa(text);
}

function fromBase64(text: string): Uint8Array {
  let decoded: string;
  try {
    decoded = atob(text);
  } catch {
    throw new RunFileError("its image is no base64; save the run again");
  }
  return Uint8Array.from(decoded, (letter) => letter.charCodeAt(0));
}

/** The run as the text of a file. */
export function encodeRun({ run, elf }: StoredRun): string {
  const head = { format: FORMAT, version: VERSION };
  return JSON.stringify({ ...head, ...run, elf: toBase64(elf) }, null, 1) + "\n";
}

const FIELDS: [keyof Run, (value: unknown) => boolean, string][] = [
  ["configuration", (value) => typeof value === "object" && value !== null, "an object"],
  ["probes", Array.isArray, "an array"],
  ["tasks", Array.isArray, "an array"],
  ["inputs", Array.isArray, "an array"],
  ["until_cycles", Number.isSafeInteger, "a whole number of cycles"],
  ["until_ms", Number.isSafeInteger, "a whole number of milliseconds"],
  ["digest", (value) => typeof value === "string", "a digest"],
];

/** Read the text of a file; throws `RunFileError`. */
export function decodeRun(text: string): StoredRun {
  let value: Record<string, unknown>;
  try {
    value = JSON.parse(text) as Record<string, unknown>;
  } catch (error) {
    throw new RunFileError(`no JSON (${(error as Error).message}); expected a saved run`);
  }
  if (typeof value !== "object" || value === null || value["format"] !== FORMAT) {
    throw new RunFileError(`no saved run: its field "format" is not "${FORMAT}"`);
  }
  if (value["version"] !== VERSION) {
    throw new RunFileError(`a run of version ${String(value["version"])}; expected ${VERSION}`);
  }
  for (const [field, accepted, expected] of FIELDS) {
    if (!accepted(value[field])) throw new RunFileError(`its field "${field}" is not ${expected}`);
  }
  if (typeof value["elf"] !== "string") throw new RunFileError('its field "elf" is missing');
  const { elf, format: _format, version: _version, ...run } = value;
  return { run: run as unknown as Run, elf: fromBase64(elf as string) };
}

/** Text as letters that an address may have. */
export async function pack(text: string): Promise<string> {
  const bytes = new TextEncoder().encode(text);
  const packed = await through(bytes, new CompressionStream("deflate-raw"));
  return toBase64(packed).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

/** The text of such letters; throws `RunFileError`. */
export async function unpack(letters: string): Promise<string> {
  const packed = fromBase64(letters.replaceAll("-", "+").replaceAll("_", "/"));
  try {
    const text = await through(packed, new DecompressionStream("deflate-raw"));
    return new TextDecoder().decode(text);
  } catch {
    throw new RunFileError("the link is damaged or cut off; ask for the file instead");
  }
}

async function through(bytes: Uint8Array, stream: GenericTransform): Promise<Uint8Array> {
  const body = new Blob([bytes as BlobPart]).stream().pipeThrough(stream as ReadableWritablePair);
  return new Uint8Array(await new Response(body).arrayBuffer());
}

interface GenericTransform {
  readable: ReadableStream;
  writable: WritableStream;
}

/**
 * The run as the fragment of a link; without debug information, which does not change it unless
 * inputs name variables.
 */
export async function encodeLink({ run, elf }: StoredRun): Promise<string> {
  const named = run.inputs.some(({ name }) => name.startsWith("variable."));
  const image = named ? elf : withoutDebugInformation(elf);
  return LINK_MARK + (await pack(encodeRun({ run, elf: image })));
}

/** The run of a link's fragment; null when the fragment is of another kind. */
export async function decodeLink(fragment: string): Promise<StoredRun | null> {
  if (!fragment.startsWith(LINK_MARK)) return null;
  return decodeRun(await unpack(fragment.slice(LINK_MARK.length)));
}
