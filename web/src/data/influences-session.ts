// The lights that do most to the sky, while the map shows them and a mouse can point at them.

import { api, type InfluenceQuery } from "../api/client.ts";
import { type AppState, CONDITIONS, conditionsOf, influenceQuery, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";

/** As many as are worth pointing at. */
const LIGHTS = 2000;

function requestOf(state: Readonly<AppState>): { scene: string; query: InfluenceQuery } | null {
  const scene = sceneOf(state);
  const { place, layers, isAway, isTrying, skyStage, measure } = state;
  // What does not add up has no shares.
  const isShown = layers.influence > 0 && measure !== "norm" && matchMedia("(hover: hover)").matches;
  if (!isShown || scene === null || place === null || isAway || isTrying || skyStage !== "picture") return null;
  return { scene: scene.id, query: influenceQuery(state, place, conditionsOf(state)) };
}

export function followInfluences(store: AppStore): void {
  let requests = new AbortController();
  let requested = "";
  const parts = [sceneOf, "place", "layers", "measure", "region", "isAway", "isTrying", "skyStage", ...CONDITIONS] as const;
  store.watch(parts, (state) => {
    const request = requestOf(state);
    const key = JSON.stringify(request);
    if (key === requested) return;
    requested = key;
    requests.abort();
    requests = new AbortController();
    if (state.influences.length > 0) store.set({ influences: [] });
    if (request === null) return;
    const { signal } = requests;
    api
      .influences(request.scene, request.query, LIGHTS, signal)
      .then(({ pixels }) => store.set({ influences: pixels }))
      // The layer itself says what is wrong.
      .catch(() => {
        if (!signal.aborted) requested = "";
      });
  });
}
