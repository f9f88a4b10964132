// What the server has: its scenes and table packs, and the named places of the scene that is shown.

import { api } from "../api/client.ts";
import { words } from "../language/words.ts";
import { bestFirst, packsOf, sceneFor, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { cloudBases } from "../ui/clouds.ts";
import { residentScatterings, scatteringTitle } from "../ui/scattering.ts";

/** Shows what the server has, once the map is there: it moves to its scene before the sky takes a part of the page. */
export async function loadScenes(store: AppStore, mapLoaded: Promise<void>): Promise<void> {
  const { signal } = new AbortController();
  try {
    const [scenes, atmospheres] = await Promise.all([api.scenes(signal), api.atmospheres(signal)]);
    await mapLoaded;
    store.set({ scenes: bestFirst(scenes), atmospheres });
    if (scenes.length === 0) store.report(new Error(words().problems.noScenes));
  } catch (reason) {
    store.report(reason);
  }
}

/** Leaves out what a link from a server with other tables asks for. */
export function dropAbsentAir(store: AppStore): void {
  store.watch(["atmospheres", "clouds", "scattering"], ({ atmospheres, clouds, scattering }) => {
    if (clouds !== null && atmospheres.length > 0 && !cloudBases(atmospheres).includes(clouds)) {
      store.report(new Error(words().problems.noClouds(clouds)));
      store.set({ clouds: null });
    }
    const resident = residentScatterings(packsOf(store.state));
    const [best] = resident;
    if (scattering === null || best === undefined || resident.includes(scattering)) return;
    store.report(new Error(words().problems.noScattering(scatteringTitle(scattering), scatteringTitle(best))));
    store.set({ scattering: null });
  });
}

/** Where the state names no scene that exists, shows that of its place, or the first one. */
export function followScene(store: AppStore): void {
  store.watch(["scenes", "scene"], (state) => {
    const { scene } = state;
    const first = (state.place === null ? null : sceneFor(state, state.place)) ?? state.scenes[0];
    if (first === undefined || sceneOf(state) !== null) return;
    if (scene === null) {
      store.set({ scene: first.id });
      return;
    }
    store.report(new Error(words().problems.noSuchScene(scene, first.title)));
    // Another scene may have the place all the same.
    const isThere = state.place !== null && sceneFor(state, state.place) !== null;
    store.set({ scene: first.id, scenario: null, ...(isThere ? {} : { place: null, view: null }) });
  });
  let requests = new AbortController();
  store.watch([sceneOf], (state) => {
    requests.abort();
    requests = new AbortController();
    store.set({ places: [] });
    const scene = sceneOf(state);
    if (scene !== null) void loadPlaces(store, scene.id, requests.signal);
  });
}

async function loadPlaces(store: AppStore, scene: string, signal: AbortSignal): Promise<void> {
  try {
    store.set({ places: await api.places(scene, signal) });
  } catch (reason) {
    if (!signal.aborted) store.report(reason);
  }
}
