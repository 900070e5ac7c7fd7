// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The virtual brick, compiled to WebAssembly. */
import type { VirtualBrick } from "../generated/virtual_brick";

export type Core = VirtualBrick;
export type CoreClass = typeof VirtualBrick;
