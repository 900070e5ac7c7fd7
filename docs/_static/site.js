// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
const NAMES = {
  ".mobile-header": "Site",
  ".sidebar-drawer": "Pages",
  "[role=main]": "Text",
  ".toc-drawer": "On this page",
};

// A box takes the focus while it is narrower than its content: then its bar is for keys, too.
const boxes = new ResizeObserver((changed) => {
  for (const { target } of changed) {
    if (target.scrollWidth > target.clientWidth) target.tabIndex = 0;
    else target.removeAttribute("tabindex");
  }
});

// What the theme leaves out for a keyboard and for a screen reader: boxes that scroll take the
// focus, titles of the list of pages have a level, the parts of the page have names, since a brick
// in its frame has the same parts, and the way back to the top belongs to one of them.
addEventListener("DOMContentLoaded", () => {
  for (const box of document.querySelectorAll("pre, .table-wrapper, .formula")) boxes.observe(box);
  for (const title of document.querySelectorAll(".caption[role=heading]")) title.ariaLevel = "2";
  for (const [part, name] of Object.entries(NAMES)) {
    document.querySelector(part)?.setAttribute("aria-label", name);
  }
  const top = document.querySelector(".back-to-top");
  if (top) document.querySelector("[role=main]")?.prepend(top);
});

// The site without a network: after the first page has loaded, the service worker loads the rest.
addEventListener("load", async () => {
  if (!("serviceWorker" in navigator) || !isSecureContext) return;
  const root = new URL(document.documentElement.dataset.content_root ?? "./", location.href);
  try {
    await navigator.serviceWorker.register(new URL("offline.js", root));
    const { active } = await navigator.serviceWorker.ready;
    active.postMessage("keep");
  } catch {
    // Without one (a private window) the site works as long as its server does.
  }
});
