// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
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
