// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** In place of the core that is compiled to WebAssembly: nothing of it runs in unit tests. */
export class VirtualBrick {}

export default async function initialise(): Promise<void> {}
