// The service worker: the network comes first, and without one what was kept is answered, marked with its date.

import { ANSWER_CACHE, asStored, kindOf, MAX_ANSWERS, MAX_FILES, SHELL_CACHE } from "./stored.ts";

/** Of the worker's own surroundings what is used here: the page's types do not have them. */
interface Extendable extends Event {
  waitUntil: (work: Promise<unknown>) => void;
}
interface Fetching extends Extendable {
  readonly request: Request;
  respondWith: (response: Promise<Response>) => void;
}
interface Worker {
  readonly registration: { readonly scope: string };
  readonly clients: { claim: () => Promise<void> };
  skipWaiting: () => Promise<void>;
  addEventListener: ((type: "install" | "activate", listener: (event: Extendable) => void) => void) &
    ((type: "fetch", listener: (event: Fetching) => void) => void) &
    ((type: "message", listener: (event: Extendable & { readonly data: unknown }) => void) => void);
}
const worker = globalThis as unknown as Worker;
const { scope } = worker.registration;

/** Removes what came first where there is too much. */
async function trim(cache: Cache, max: number): Promise<void> {
  const keys = await cache.keys();
  await Promise.all(keys.slice(0, Math.max(keys.length - max, 0)).map((key) => cache.delete(key)));
}

/** Keeps an answer as the newest. */
async function keep(name: string, request: Request | string, response: Response, max: number): Promise<void> {
  if (!response.ok || response.status !== 200) return;
  const cache = await caches.open(name);
  await cache.delete(request);
  await cache.put(request, response);
  await trim(cache, max);
}

/** Names of files hold their hash: what is kept is what would come. */
async function file(request: Request): Promise<Response> {
  const kept = await caches.match(request, { cacheName: SHELL_CACHE });
  if (kept !== undefined) return kept;
  const response = await fetch(request);
  await keep(SHELL_CACHE, request, response.clone(), MAX_FILES);
  return response;
}

/** The page as the server has it, else as it was. */
async function page(event: Fetching): Promise<Response> {
  try {
    const response = await fetch(event.request);
    event.waitUntil(keep(SHELL_CACHE, scope, response.clone(), MAX_FILES));
    return response;
  } catch (reason) {
    const kept = await caches.match(scope, { cacheName: SHELL_CACHE });
    if (kept === undefined) throw reason;
    return kept;
  }
}

/** An answer of the server, else the one that it gave before, marked. */
async function answer(event: Fetching, isTile: boolean): Promise<Response> {
  try {
    const response = await fetch(event.request);
    event.waitUntil(keep(ANSWER_CACHE, event.request, response.clone(), MAX_ANSWERS));
    return response;
  } catch (reason) {
    const kept = await caches.match(event.request, { cacheName: ANSWER_CACHE });
    if (kept !== undefined) return asStored(kept);
    // The map goes on without a tile.
    if (isTile) return new Response(null, { status: 404 });
    throw reason;
  }
}

worker.addEventListener("install", (event) => event.waitUntil(worker.skipWaiting()));
worker.addEventListener("activate", (event) => {
  const dropOthers = async () => {
    const others = (await caches.keys()).filter((name) => name !== SHELL_CACHE && name !== ANSWER_CACHE);
    await Promise.all(others.map((name) => caches.delete(name)));
    await worker.clients.claim();
  };
  event.waitUntil(dropOthers());
});
// The page came before the worker: it names its files once.
worker.addEventListener("message", (event) => {
  const { urls } = event.data as { urls?: unknown };
  if (!Array.isArray(urls)) return;
  const wanted = urls.filter((url): url is string => typeof url === "string" && kindOf(url, scope) === "file");
  const keepAll = async () => {
    await keep(SHELL_CACHE, scope, await fetch(scope), MAX_FILES);
    await Promise.all(wanted.map((url) => file(new Request(url))));
  };
  event.waitUntil(keepAll());
});
worker.addEventListener("fetch", (event) => {
  const { request } = event;
  // Who asks whether the server is there wants no kept answer.
  if (request.method !== "GET" || request.cache === "no-store") return;
  const kind = kindOf(request.url, scope);
  if (kind === "page" && request.mode === "navigate") event.respondWith(page(event));
  else if (kind === "file") event.respondWith(file(request));
  else if (kind === "answer" || kind === "tile") event.respondWith(answer(event, kind === "tile"));
});
