// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// What is built lies in build/page, beside what else is built: nothing of it is committed.
import { defineConfig } from "vite";

export default defineConfig({
  base: "./",
  build: {
    outDir: "../build/page",
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
  },
  worker: { format: "es" },
  // A test may take long on a machine with other work; one that hangs fails all the same.
  test: { include: ["tests/**/*.test.ts"], testTimeout: 120_000 },
} as Parameters<typeof defineConfig>[0]);
