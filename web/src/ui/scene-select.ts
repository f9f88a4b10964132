// The choice of the scene, and a note about the chosen one.

import type { Scene } from "../api/types.ts";
import { words } from "../language/words.ts";
import { besideScene, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { sideTitles } from "./beside.ts";
import { byId } from "./dom.ts";

/** What calls a scene illustrative in English, at the end of its title or in its credit. */
const SAID_IN_TITLE = /\s*\([^()]*illustrative[^()]*\)$/i;
const SAID_IN_CREDIT = /illustrative/i;

function option({ id, title, illustrative }: Scene): HTMLOptionElement {
  return new Option(illustrative ? words().scene.illustrativeTitle(title.replace(SAID_IN_TITLE, "")) : title, id);
}

/** `when`: of both scenes where two are shown side by side. */
function note({ illustrative, attribution }: Scene, when: string): string {
  // It is said in the language of the page, and once.
  const warning = illustrative ? words().scene.illustrative : "";
  const credit = illustrative && SAID_IN_CREDIT.test(attribution ?? "") ? "" : (attribution ?? "");
  return [warning, when, credit].filter((part) => part !== "").join(" · ");
}

export function mountSceneSelect(store: AppStore): void {
  const select = byId("scene", HTMLSelectElement);
  const container = byId("scene-note", HTMLElement);
  select.addEventListener("change", () => store.push({ scene: select.value, place: null, scenario: null, view: null }));
  store.watch(["scenes"], ({ scenes }) => {
    select.replaceChildren(...scenes.map(option));
    select.disabled = scenes.length === 0;
    // A choice of one is none.
    byId("scene-field", HTMLElement).hidden = scenes.length < 2;
  });
  store.watch([sceneOf, besideScene], (state) => {
    const scene = sceneOf(state);
    if (scene === null) return;
    select.value = scene.id;
    const isBeside = besideScene(state) !== null;
    container.textContent = note(scene, isBeside ? words().scene.sides(...sideTitles(state)) : (scene.date ?? ""));
    container.classList.toggle("illustrative", scene.illustrative);
  });
}
