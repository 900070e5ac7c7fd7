// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from "vitest/config";

export default defineConfig({
  test: {
    dir: "e2e",
    include: ["*.test.ts"],
    environment: "node",
    hookTimeout: 900_000,
    testTimeout: 900_000,
    fileParallelism: false,
    // One process, in which all files share browser and servers (e2e/harness.ts).
    isolate: false,
  },
});
