// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
// The service worker: what was loaded once is there without a network, and so is what the list
// offline.json beside it names. What the network has is newer and wins.
const CACHE = "ravenbrick";

/** Files by name with their digests: those that are new or another than before are loaded. */
async function keepListed() {
  const list = await fetch("./offline.json", { cache: "no-cache" }).catch(() => null);
  if (!list?.ok) return;
  const cache = await caches.open(CACHE);
  const before = await (await cache.match("./offline.json"))?.json();
  const names = Object.entries(await list.clone().json());
  // One after the other: whoever reads meanwhile does not wait for all of it.
  for (const [name, digest] of names) {
    if (before?.[name] !== digest || !(await cache.match(name))) await cache.add(name);
  }
  await cache.put("./offline.json", list);
}

self.addEventListener("install", () => self.skipWaiting());
self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));
self.addEventListener("message", (event) => {
  if (event.data === "keep") event.waitUntil(keepListed());
});

async function answer(request) {
  const cache = await caches.open(CACHE);
  try {
    const response = await fetch(request);
    if (response.ok) await cache.put(request, response.clone());
    return response;
  } catch (error) {
    const page = request.url.replace(/\/$/, "/index.html");
    const match = (address) => cache.match(address, { ignoreSearch: true });
    const kept = (await match(request)) ?? (await match(page));
    if (kept) return kept;
    throw error;
  }
}

self.addEventListener("fetch", (event) => {
  const { request } = event;
  const own = new URL(request.url).origin === self.location.origin;
  if (request.method === "GET" && own) event.respondWith(answer(request));
});
