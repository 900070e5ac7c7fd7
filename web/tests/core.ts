// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Stands in for the core that is compiled to WebAssembly: no unit test runs it. */
export class VirtualBrick {}

export default async function initialise(): Promise<void> {}
