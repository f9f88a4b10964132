// A server that does not answer: it is asked again by itself, and once it is back, so is all that did not come.

import { api, onFinding, onStored } from "../api/client.ts";
import type { AppStore } from "../state/app-store.ts";
import { loadScenes } from "./scenes.ts";

const FIRST_WAIT_MS = 1000;
const MAX_WAIT_MS = 15_000;

export function followConnection(store: AppStore): void {
  // Of kept answers the oldest is told; one of the server itself, and what is shown is new again.
  onStored((date) => {
    const atMs = date === null ? null : Date.parse(date) || 0;
    const { storedAtMs } = store.state;
    const told = atMs === null || storedAtMs === null ? (storedAtMs ?? atMs) : Math.min(atMs, storedAtMs);
    if (told !== storedAtMs) store.set({ storedAtMs: told });
  });
  onFinding((foundPart) => {
    store.set({ foundPart });
  });
  store.watch(["isAway"], ({ isAway }) => {
    if (isAway) void untilBack(store);
  });
}

async function untilBack(store: AppStore): Promise<void> {
  const { signal } = new AbortController();
  for (let waitMs = FIRST_WAIT_MS; ; waitMs = Math.min(2 * waitMs, MAX_WAIT_MS)) {
    await new Promise((resolve) => setTimeout(resolve, waitMs));
    try {
      await api.reach(signal);
      break;
    } catch {
      // It is still away.
    }
  }
  store.set({ isAway: false, problem: null });
  if (store.state.atmospheres.length === 0) await loadScenes(store, Promise.resolve());
}
