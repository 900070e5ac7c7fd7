// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** A part of the page: made for a brick, told of each frame. */
import type { Frame, Ready } from "../protocol";

export interface View {
  readonly element: HTMLElement;
  /** Another brick was made. */
  ready(ready: Ready): void;
  /** Something happened. */
  frame(frame: Frame): void;
}

/** What views may ask for. */
export interface Actions {
  input(name: string, value: number): void;
  scope(channels: string[], period_ms: number): void;
  sensors(sensors: Record<string, { kind: string }>): void;
}
