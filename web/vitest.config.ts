// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// Unit tests. Only `make page` builds the core, so a stand-in takes its place here.
import { fileURLToPath } from "node:url";
import { defineConfig } from "vitest/config";

const core = fileURLToPath(new URL("tests/core.ts", import.meta.url));

export default defineConfig({
  test: {
    include: ["tests/**/*.test.ts"],
    alias: { "../generated/virtual_brick": core },
    // A test may take long on a machine with other work; one that hangs fails all the same.
    testTimeout: 120_000,
  },
});
