// Which lights are shown: those of today, those of a plan or painting, or one beside the other.

import { placeWords, words } from "../language/words.ts";
import { besideScene, isCompared, scenarioOf, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import type { LightsKind } from "../state/view-state.ts";
import { sideTitles } from "./beside.ts";
import { byId } from "./dom.ts";
import { wireGroup } from "./group.ts";

export function mountLightsControls(store: AppStore): void {
  const press = wireGroup<LightsKind>("lights", (lights) => store.set({ lights }));
  const split = byId("split", HTMLInputElement);
  split.addEventListener("input", () => store.set({ split: Number(split.value) / 100 }));
  store.watch(["lights"], ({ lights }) => press(lights));
  store.watch(["scenario"], ({ scenario }) => {
    byId("lights", HTMLElement).hidden = scenario === null;
  });
  store.watch([isCompared], (state) => {
    byId("split-field", HTMLElement).hidden = !isCompared(state);
  });
  store.watch(["split"], (state) => {
    split.value = String(Math.round(100 * state.split));
    split.setAttribute("aria-valuetext", placeWords().plan.percent(split.value));
  });
  store.watch([scenarioOf, besideScene, sceneOf], (state) => {
    const { withPlan, asPainted } = words().sky;
    // One name for one thing: beside the slider too.
    const name = scenarioOf(state) === null ? withPlan : asPainted;
    byId("lights-changed", HTMLButtonElement).textContent = name;
    const [left, right] = sideTitles(state);
    byId("split-before", HTMLElement).textContent = left;
    byId("split-changed", HTMLElement).textContent = right;
  });
}
