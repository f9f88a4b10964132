// The night over the picked place: that of the chosen time, or tonight. Its hours come after the sky.

import { api, type NightQuery } from "../api/client.ts";
import { isWithoutAnswer } from "../api/problem.ts";
import { eveningOf, eveningOfTonight } from "../night/time.ts";
import { type AppState, CONDITIONS, coordinatesOf, nightQuery, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { debounced } from "../ui/dom.ts";

/** A date that is chosen for this long is looked at. */
const HOURS_WAIT_MS = 350;

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

function hoursRequest(state: Readonly<AppState>): { scene: string; query: NightQuery } | null {
  const scene = sceneOf(state);
  const date = eveningOfState(state);
  if (scene === null || state.place === null || date === null || state.clouds !== null) return null;
  return { scene: scene.id, query: nightQuery(state, state.place, date) };
}

/** How bright each hour of the night is, under a clear sky. */
export function followNightHours(store: AppStore): void {
  let requests = new AbortController();
  let requested = "";
  const load = async () => {
    const { state } = store;
    const request = hoursRequest(state);
    if (request === null || state.skyStage !== "picture" || state.isBusy || state.isTrying || state.isAway) return;
    requested = JSON.stringify(request);
    requests = new AbortController();
    const { signal } = requests;
    try {
      store.set({ nightHours: await api.nightHours(request.scene, request.query, signal) });
    } catch (reason) {
      if (signal.aborted) return;
      if (isWithoutAnswer(reason)) requested = "";
      store.report(reason);
    }
  };
  const loadSoon = debounced(HOURS_WAIT_MS, () => void load());
  const parts = [sceneOf, "place", "isAway", "skyStage", "isBusy", "isTrying", "time", ...CONDITIONS] as const;
  store.watch(parts, (state) => {
    if (JSON.stringify(hoursRequest(state)) === requested) return;
    requests.abort();
    requested = "";
    if (state.nightHours !== null) store.set({ nightHours: null });
    loadSoon();
  });
}
