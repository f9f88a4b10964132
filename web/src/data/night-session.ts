// The night over the picked place: that of the chosen time, or tonight.

import { api } from "../api/client.ts";
import { eveningOf, eveningOfTonight } from "../night/time.ts";
import { type AppState, coordinatesOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";

/** Date of its evening; null without a place. */
export function eveningOfState({ place, time }: Readonly<AppState>, nowMs = Date.now()): string | null {
  if (place === null) return null;
  return time === null ? eveningOfTonight(nowMs, place.longitude_deg) : eveningOf(Date.parse(time), place.longitude_deg);
}

export function followNight(store: AppStore): void {
  let requests = new AbortController();
  store.watch(["place", "isAway", (state) => eveningOfState(state)], (state) => {
    requests.abort();
    requests = new AbortController();
    const { place, isAway } = state;
    if (isAway) return;
    const date = eveningOfState(state);
    if (place === null || date === null) store.set({ night: null });
    else void load(store, coordinatesOf(place), date, requests.signal);
  });
}

async function load(store: AppStore, at: { lat: number; lon: number }, date: string, signal: AbortSignal): Promise<void> {
  try {
    store.set({ night: await api.night(at, date, signal) });
  } catch (reason) {
    if (signal.aborted) return;
    store.set({ night: null });
    store.report(reason);
  }
}
