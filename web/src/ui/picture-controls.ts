// How the sky is shown: which light, in which projection, colours and unit.

import { words } from "../language/words.ts";
import { isOfLight, type PictureStyle } from "../sky/colour-maps.ts";
import type { SkyKind } from "../sky/grid.ts";
import type { ProjectionName } from "../sky/projection.ts";
import { exposureTimeS } from "../sky/realistic.ts";
import { type BrightnessUnit, unitFor } from "../sky/units.ts";
import { hasLand, landCdM2Of, sceneOf, seenOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import type { LandKind } from "../state/view-state.ts";
import { byId } from "./dom.ts";
import { decimal, exposureTime } from "./format.ts";
import { wireGroup } from "./group.ts";

export function mountPictureControls(store: AppStore): void {
  const colours = byId("colours", HTMLSelectElement);
  const exposure = byId("exposure", HTMLInputElement);
  const land = byId("land", HTMLSelectElement);
  const unit = byId("unit", HTMLSelectElement);
  colours.addEventListener("change", () => store.set({ colours: colours.value as PictureStyle }));
  exposure.addEventListener("input", () => store.set({ exposureEv: Number(exposure.value) }));
  land.addEventListener("change", () => store.set({ land: land.value as LandKind }));
  unit.addEventListener("change", () => store.set({ unit: unit.value as BrightnessUnit }));
  const pressProjection = wireGroup<ProjectionName>("projection", (projection) => store.set({ projection }));
  const pressSky = wireGroup<SkyKind>("sky-kind", (sky) => store.set({ sky }));
  store.watch(["projection"], ({ projection }) => pressProjection(projection));
  store.watch(["sky"], ({ sky }) => pressSky(sky));
  store.watch(["unit", seenOf], (state) => {
    const seen = seenOf(state);
    for (const option of unit.options) option.disabled = unitFor(option.value as BrightnessUnit, seen) !== option.value;
    byId("unit-of-values", HTMLOptionElement).textContent = seen.unit;
    unit.value = unitFor(state.unit, seen);
  });
  store.watch(["colours"], (state) => {
    colours.value = state.colours;
    byId("exposure-field", HTMLElement).hidden = !isOfLight(state.colours);
  });
  store.watch(["colours", "land", "terrain", sceneOf], (state) => {
    land.value = state.land;
    byId("land-field", HTMLElement).hidden = !hasLand(state, sceneOf(state));
  });
  const keep = byId("keep-adaptation", HTMLButtonElement);
  keep.title = words().sky.keepAdaptationWhy;
  keep.addEventListener("click", () => void toggleAdaptation(store));
  store.watch(["colours", "adaptationCdM2", "panorama"], ({ colours, adaptationCdM2, panorama }) => {
    keep.hidden = colours !== "eye" || panorama === null;
    keep.setAttribute("aria-pressed", String(adaptationCdM2 !== null));
  });
  store.watch(["colours", "exposureEv"], ({ colours, exposureEv }) => {
    exposure.value = String(exposureEv);
    const { cameraTime, cameraWhy } = words().sky;
    const isCamera = colours === "realistic";
    const stops = `${exposureEv > 0 ? "+" : ""}${decimal(exposureEv)} EV`;
    const told = isCamera ? `${stops}: ${cameraTime(exposureTime(exposureTimeS(exposureEv)))}` : stops;
    byId("exposure-value", HTMLOutputElement).value = told;
    byId("exposure-field", HTMLElement).title = isCamera ? cameraWhy : "";
    exposure.setAttribute("aria-valuetext", told);
  });
}

/** The eye stays adapted to the sky that is shown, or follows it again. */
async function toggleAdaptation(store: AppStore): Promise<void> {
  const { panorama, adaptationCdM2 } = store.state;
  if (panorama === null) return;
  const { adaptationOf } = await import("../sky/shading.ts");
  store.set({
    adaptationCdM2: adaptationCdM2 === null ? +adaptationOf(panorama, store.state, landCdM2Of(store.state)).toPrecision(3) : null,
  });
}
