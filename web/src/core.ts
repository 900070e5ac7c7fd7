// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The virtual brick, compiled to WebAssembly. */
import type { VirtualBrick } from "../generated/virtual_brick";

export type Core = VirtualBrick;
export type CoreClass = typeof VirtualBrick;

/** What judges a run, where the core was built with it. */
export interface Judge {
  verdict(request_json: string): string;
  step_response(request_json: string, motor: string): Float64Array;
  log_pins(pins: Uint32Array): void;
}

export function judgeOf(core: Core): Judge | null {
  return "verdict" in core && "step_response" in core ? (core as unknown as Judge) : null;
}

/** What reads criteria in words, where the core was built with it. */
export function sentencesOf(core: CoreClass): { expectation(sentence: string): string } | null {
  return "expectation" in core ? (core as unknown as { expectation(s: string): string }) : null;
}
