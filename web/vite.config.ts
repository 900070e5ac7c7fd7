// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// What is built lies in build/page, beside what else is built: nothing of it is committed.
import { defineConfig } from "vite";

/** A browser runs no modules from the disk: the page is made of classic scripts. */
const classicScripts = {
  name: "classic-scripts",
  enforce: "post" as const,
  transformIndexHtml: (html: string) =>
    html.replace('type="module" crossorigin', "defer").replace(" crossorigin", ""),
};

export default defineConfig({
  base: "./",
  plugins: [classicScripts],
  build: {
    outDir: "../build/page",
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    rollupOptions: { output: { format: "iife" } },
  },
  worker: { format: "iife" },
});
