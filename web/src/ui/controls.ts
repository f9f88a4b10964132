// The controls beside the map: what the sky depends on, and how it is shown.

import type { ScatteringName } from "../api/client.ts";
import type { Atmosphere, Scene } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { PictureStyle } from "../sky/colour-maps.ts";
import type { SkyKind } from "../sky/grid.ts";
import type { ProjectionName } from "../sky/projection.ts";
import type { BrightnessUnit } from "../sky/units.ts";
import { LAYERS, type LayerName, type LightsKind, type MeasureName, type TerrainKind, type ViewState } from "../state.ts";
import { cloudBases, cloudsTitle, packsUnder } from "./clouds.ts";
import { byId, debounced, make } from "./dom.ts";
import { decimal, fixed } from "./format.ts";
import { wireGroup } from "./group.ts";
import { emissions, lamps } from "./lamps.ts";
import { showLayerHint } from "./layers.ts";
import { setRegionOption } from "./marking.ts";
import { residentScatterings, SCATTERINGS, scatteringTitle, turbidityRange } from "./scattering.ts";

export interface ControlEvents {
  scene: (id: string) => void;
  turbidity: (turbidity: number) => void;
  /** null: the best that the server has. */
  scattering: (scattering: ScatteringName | null) => void;
  /** Base above sea level, metres; null: a clear sky. */
  clouds: (clouds: number | null) => void;
  lamp: (lamp: string) => void;
  emission: (emission: string) => void;
  terrain: (terrain: TerrainKind) => void;
  lights: (lights: LightsKind) => void;
  projection: (projection: ProjectionName) => void;
  sky: (sky: SkyKind) => void;
  colours: (colours: PictureStyle) => void;
  exposure: (exposureEv: number) => void;
  unit: (unit: BrightnessUnit) => void;
  measure: (measure: MeasureName) => void;
  layer: (layer: LayerName, opacity: number) => void;
}

/** What the server assumes where the request names none. */
export const DEFAULT_TURBIDITY = 2.5;
const WAIT_MS = 180;

function airWords(turbidity: number): string {
  const { mountainAir, clearNight, lightHaze, haze } = words().assumptions;
  if (turbidity < 1.75) return mountainAir;
  if (turbidity < 2.75) return clearNight;
  if (turbidity < 4) return lightHaze;
  return haze;
}

function fill(select: HTMLSelectElement, options: readonly (readonly [string, string])[], value: string): void {
  const known = options.some(([name]) => name === value);
  const all = known || value === "" ? options : [...options, [value, words().assumptions.own(value)] as const];
  select.replaceChildren(...all.map(([name, title]) => new Option(title, name, false, name === value)));
}

export class Controls {
  private readonly scene = byId("scene", HTMLSelectElement);
  private readonly sceneNote = byId("scene-note", HTMLElement);
  private readonly turbidity = byId("turbidity", HTMLInputElement);
  private readonly turbidityValue = byId("turbidity-value", HTMLOutputElement);
  private readonly scattering = byId("scattering", HTMLSelectElement);
  private readonly clouds = byId("clouds", HTMLSelectElement);
  private atmospheres: readonly Atmosphere[] = [];
  private readonly lamp = byId("lamp", HTMLSelectElement);
  private readonly emission = byId("emission", HTMLSelectElement);
  private readonly terrain = byId("terrain", HTMLSelectElement);
  private readonly colours = byId("colours", HTMLSelectElement);
  private readonly exposure = byId("exposure", HTMLInputElement);
  private readonly unit = byId("unit", HTMLSelectElement);
  private readonly measure = byId("measure", HTMLSelectElement);
  private readonly pressLights: (value: LightsKind) => void;
  private readonly pressProjection: (value: ProjectionName) => void;
  private readonly pressSky: (value: SkyKind) => void;

  constructor(events: ControlEvents) {
    this.scene.addEventListener("change", () => events.scene(this.scene.value));
    const changed = debounced(WAIT_MS, events.turbidity);
    this.turbidity.addEventListener("input", () => {
      this.showTurbidity();
      changed(Number(this.turbidity.value));
    });
    this.scattering.addEventListener("change", () => {
      const chosen = SCATTERINGS.find((name) => name === this.scattering.value) ?? null;
      events.scattering(chosen === residentScatterings(this.atmospheresBelow())[0] ? null : chosen);
    });
    this.clouds.addEventListener("change", () => events.clouds(this.chosenClouds()));
    this.lamp.addEventListener("change", () => events.lamp(this.lamp.value));
    this.emission.addEventListener("change", () => events.emission(this.emission.value));
    this.terrain.addEventListener("change", () => events.terrain(this.terrain.value as TerrainKind));
    this.colours.addEventListener("change", () => events.colours(this.colours.value as PictureStyle));
    this.exposure.addEventListener("input", () => events.exposure(Number(this.exposure.value)));
    this.unit.addEventListener("change", () => events.unit(this.unit.value as BrightnessUnit));
    this.measure.addEventListener("change", () => events.measure(this.measure.value as MeasureName));
    this.pressLights = wireGroup<LightsKind>("lights", events.lights);
    this.pressProjection = wireGroup<ProjectionName>("projection", events.projection);
    this.pressSky = wireGroup<SkyKind>("sky-kind", events.sky);
    for (const layer of LAYERS) {
      const box = byId(`layer-${layer}`, HTMLInputElement);
      const slider = byId(`opacity-${layer}`, HTMLInputElement);
      const tell = () => {
        slider.disabled = !box.checked;
        events.layer(layer, box.checked ? Number(slider.value) : 0);
      };
      box.addEventListener("change", tell);
      slider.addEventListener("input", tell);
    }
  }

  setScenes(scenes: readonly Scene[]): void {
    this.scene.replaceChildren(
      ...scenes.map(({ id, title, illustrative }) => {
        const said = !illustrative || /illustrative/i.test(title);
        return new Option(said ? title : words().scene.illustrativeTitle(title), id);
      }),
    );
    this.scene.disabled = scenes.length === 0;
  }

  setAtmospheres(atmospheres: readonly Atmosphere[]): void {
    this.atmospheres = atmospheres;
    this.showAir(null, null);
  }

  /** Base of the clouds that the control stands on, metres; null for a clear sky. */
  private chosenClouds(): number | null {
    return this.clouds.value === "none" ? null : Number(this.clouds.value);
  }

  /** The packs under the clouds that the control stands on. */
  private atmospheresBelow(): readonly Atmosphere[] {
    return packsUnder(this.atmospheres, this.chosenClouds());
  }

  /** What can be chosen of clouds, of scattering under them, and of turbidity with that scattering. */
  private showAir(scattering: ScatteringName | null, clouds: number | null): void {
    const bases = cloudBases(this.atmospheres);
    const choices = [null, ...bases].map((base) => [String(base ?? "none"), cloudsTitle(base)] as const);
    fill(this.clouds, choices, String(clouds ?? "none"));
    // A choice of one is none.
    byId("clouds-field", HTMLElement).hidden = bases.length === 0;
    const atmospheres = packsUnder(this.atmospheres, clouds);
    const resident = residentScatterings(atmospheres);
    const best = resident[0];
    if (best !== undefined) {
      fill(
        this.scattering,
        resident.map((name) => [name, scatteringTitle(name)] as const),
        scattering ?? best,
      );
    }
    this.scattering.disabled = resident.length < 2;
    const ends = turbidityRange(atmospheres, scattering);
    if (ends === null) return;
    const [least, most] = ends;
    this.turbidity.min = String(least);
    this.turbidity.max = String(most);
    this.turbidity.disabled = least === most;
    byId("turbidity-ends", HTMLElement).replaceChildren(
      make("span", "", words().assumptions.minTurbidity(decimal(least))),
      make("span", "", words().assumptions.maxTurbidity(decimal(most))),
    );
    this.showTurbidity();
  }

  /** Puts every control where the state says. */
  show(state: ViewState, scene: Scene | null): void {
    if (scene !== null) {
      this.scene.value = scene.id;
      const parts = [
        scene.illustrative && !/illustrative/i.test(scene.attribution ?? "") ? words().scene.illustrative : "",
        scene.date ?? "",
        scene.attribution ?? "",
      ];
      this.sceneNote.textContent = parts.filter((part) => part !== "").join(" · ");
      this.sceneNote.classList.toggle("illustrative", scene.illustrative);
      showLayerHint("elevation", scene.terrain ? null : words().layers.noTerrain);
      this.terrain.disabled = !scene.terrain;
    }
    showLayerHint("brightness", state.clouds === null ? null : words().layers.clearSkyAlone);
    showLayerHint("influence", state.place === null ? words().layers.placeFirst : null);
    this.showAir(state.scattering, state.clouds);
    this.turbidity.value = String(state.turbidity ?? DEFAULT_TURBIDITY);
    this.showTurbidity();
    fill(this.lamp, lamps(), state.lamp);
    fill(this.emission, emissions(), state.emission);
    this.terrain.value = state.terrain;
    this.colours.value = state.colours;
    byId("exposure-field", HTMLElement).hidden = state.colours !== "realistic";
    this.exposure.value = String(state.exposureEv);
    const stops = `${state.exposureEv > 0 ? "+" : ""}${decimal(state.exposureEv)} EV`;
    byId("exposure-value", HTMLOutputElement).value = stops;
    this.exposure.setAttribute("aria-valuetext", stops);
    this.unit.value = state.unit;
    setRegionOption(this.measure, state.region !== null);
    this.measure.value = state.measure;
    this.measure.hidden = state.layers.influence === 0;
    byId("lights", HTMLElement).hidden = state.scenario === null;
    this.pressLights(state.lights);
    byId("split-field", HTMLElement).hidden = state.scenario === null || state.lights !== "both";
    this.pressProjection(state.projection);
    this.pressSky(state.sky);
    for (const layer of LAYERS) {
      const box = byId(`layer-${layer}`, HTMLInputElement);
      const slider = byId(`opacity-${layer}`, HTMLInputElement);
      box.checked = state.layers[layer] > 0 && !box.disabled;
      slider.disabled = !box.checked;
      if (state.layers[layer] > 0) slider.value = String(state.layers[layer]);
    }
  }

  private showTurbidity(): void {
    const turbidity = Number(this.turbidity.value);
    this.turbidityValue.value = `${fixed(turbidity, 1)} · ${airWords(turbidity)}`;
    this.turbidity.setAttribute("aria-valuetext", this.turbidityValue.value);
  }
}
