// Another scene of the same place, such as of another year, beside the one that is shown: which, and how much the sky differs.

import type { Scene, SkyAnswer } from "../api/types.ts";
import { placeWords, words } from "../language/words.ts";
import { type AppState, besideScene, otherScenes, scenarioOf, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId } from "./dom.ts";
import { magnitude, percent } from "./format.ts";

/** Less of a difference is none. */
const SAME_SHARE = 5e-4;

/** What tells a scene from another: its date, or its title where both have the same. */
export function yearOf(scene: Pick<Scene, "title" | "date">, other: Pick<Scene, "title" | "date">): string {
  return scene.date == null || scene.date === other.date ? scene.title : scene.date;
}

/** How the artificial light overhead differs from that of the other scene, in a sentence; empty where there is none. */
export function besideSentence(answer: Pick<SkyAnswer, "sky">, other: Pick<SkyAnswer, "sky">, year: string): string {
  const say = placeWords().beside;
  const [before, after] = [other.sky.zenith_luminance_cd_m2, answer.sky.zenith_luminance_cd_m2];
  if (before <= 0) return "";
  const share = after / before - 1;
  const [from, to] = [other, answer].map(({ sky }) => magnitude(sky.zenith_total_brightness_mag_arcsec2 ?? null));
  const amount = percent(Math.abs(share));
  const first = Math.abs(share) < SAME_SHARE ? say.same(year) : share > 0 ? say.brighter(amount, year) : say.darker(amount, year);
  return `${first} ${say.zenith(from ?? "", to ?? "")}`;
}

/** What the two sides of a comparison show: two years, or the lights of today and others. */
export function sideTitles(state: Readonly<AppState>): [left: string, right: string] {
  const { withPlan, asPainted, today } = words().sky;
  const [scene, beside] = [sceneOf(state), besideScene(state)];
  if (scene !== null && beside !== null) return [yearOf(beside, scene), yearOf(scene, beside)];
  return [today, scenarioOf(state) === null ? withPlan : asPainted];
}

export function mountBeside(store: AppStore): void {
  const field = byId("beside-field", HTMLElement);
  const select = byId("beside", HTMLSelectElement);
  const told = byId("beside-told", HTMLElement);
  select.addEventListener("change", () => store.set({ beside: select.value === "" ? null : select.value }));
  store.watch(["scenes", "scene", "place", "scenario", "beside"], (state) => {
    const scene = sceneOf(state);
    const others = otherScenes(state);
    // Changed lights have a comparison of their own.
    field.hidden = scene === null || others.length === 0 || state.scenario !== null;
    if (scene === null) return;
    const options = others.map((other) => new Option(yearOf(other, scene), other.id));
    select.replaceChildren(new Option(placeWords().beside.none, ""), ...options);
    select.value = besideScene(state)?.id ?? "";
  });
  store.watch([besideScene, "answer", "besideAnswer"], (state) => {
    const { answer, besideAnswer } = state;
    const [scene, beside] = [sceneOf(state), besideScene(state)];
    const isThere = scene !== null && beside !== null && answer !== null && besideAnswer !== null;
    told.textContent = isThere ? besideSentence(answer, besideAnswer, yearOf(beside, scene)) : "";
    told.hidden = told.textContent === "";
  });
}
