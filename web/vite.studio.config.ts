// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// The studio's own page, built into build/studio; the brick in it is the page of `ravenbrick view`.
import { defineConfig } from "vite";

export default defineConfig({
  root: "studio",
  base: "./",
  build: {
    outDir: "../../build/studio",
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
  },
});
