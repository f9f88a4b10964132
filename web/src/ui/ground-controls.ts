// The assumptions about the ground: its lamps, and whether terrain hides sky and lights.

import { sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import type { TerrainKind } from "../state/view-state.ts";
import { byId } from "./dom.ts";
import { lampGroups, lampTitle } from "./lamps.ts";
import { fillGroups } from "./select.ts";

export function mountGroundControls(store: AppStore): void {
  const lamp = byId("lamp", HTMLSelectElement);
  const terrain = byId("terrain", HTMLSelectElement);
  lamp.addEventListener("change", () => store.set({ lamp: lamp.value }));
  terrain.addEventListener("change", () => store.set({ terrain: terrain.value as TerrainKind }));
  store.watch(["lamp"], (state) => fillGroups(lamp, lampGroups(), state.lamp, lampTitle));
  store.watch(["terrain", sceneOf], (state) => {
    terrain.value = state.terrain;
    terrain.disabled = sceneOf(state)?.terrain === false;
  });
}
