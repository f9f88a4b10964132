// The controls beside the map: what the sky depends on, and how it is shown.

import type { ScatteringName } from "../api/client.ts";
import type { Atmosphere, Scene } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { PictureStyle } from "../sky/colour_maps.ts";
import type { SkyKind } from "../sky/grid.ts";
import type { ProjectionName } from "../sky/projection.ts";
import type { BrightnessUnit } from "../sky/units.ts";
import { LAYERS, type LayerName, type LightsKind, type MeasureName, type TerrainKind, type ViewState } from "../state.ts";
import { cloud_bases, clouds_title, packs_under } from "./clouds.ts";
import { by_id, debounced, make } from "./dom.ts";
import { decimal, fixed } from "./format.ts";
import { wire_group } from "./group.ts";
import { show_layer_hint } from "./layers.ts";
import { emissions, lamps } from "./lamps.ts";
import { set_region_option } from "./marking.ts";
import { resident_scatterings, scattering_title, SCATTERINGS, turbidity_ends } from "./scattering.ts";

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
  exposure: (exposure_ev: number) => void;
  unit: (unit: BrightnessUnit) => void;
  measure: (measure: MeasureName) => void;
  layer: (layer: LayerName, opacity: number) => void;
}

/** What the server assumes where the request names none. */
export const DEFAULT_TURBIDITY = 2.5;
const WAIT_MS = 180;

function air_words(turbidity: number): string {
  const { mountain_air, clear_night, light_haze, haze } = words().assumptions;
  if (turbidity < 1.75) return mountain_air;
  if (turbidity < 2.75) return clear_night;
  if (turbidity < 4) return light_haze;
  return haze;
}

function fill(select: HTMLSelectElement, options: readonly (readonly [string, string])[], value: string): void {
  const known = options.some(([name]) => name === value);
  const all = known || value === "" ? options : [...options, [value, words().assumptions.own(value)] as const];
  select.replaceChildren(...all.map(([name, title]) => new Option(title, name, false, name === value)));
}

export class Controls {
  private readonly scene = by_id("scene", HTMLSelectElement);
  private readonly scene_note = by_id("scene-note", HTMLElement);
  private readonly turbidity = by_id("turbidity", HTMLInputElement);
  private readonly turbidity_value = by_id("turbidity-value", HTMLOutputElement);
  private readonly scattering = by_id("scattering", HTMLSelectElement);
  private readonly clouds = by_id("clouds", HTMLSelectElement);
  private atmospheres: readonly Atmosphere[] = [];
  private readonly lamp = by_id("lamp", HTMLSelectElement);
  private readonly emission = by_id("emission", HTMLSelectElement);
  private readonly terrain = by_id("terrain", HTMLSelectElement);
  private readonly colours = by_id("colours", HTMLSelectElement);
  private readonly exposure = by_id("exposure", HTMLInputElement);
  private readonly unit = by_id("unit", HTMLSelectElement);
  private readonly measure = by_id("measure", HTMLSelectElement);
  private readonly press_lights: (value: LightsKind) => void;
  private readonly press_projection: (value: ProjectionName) => void;
  private readonly press_sky: (value: SkyKind) => void;

  constructor(events: ControlEvents) {
    this.scene.addEventListener("change", () => events.scene(this.scene.value));
    const changed = debounced(WAIT_MS, events.turbidity);
    this.turbidity.addEventListener("input", () => {
      this.show_turbidity();
      changed(Number(this.turbidity.value));
    });
    this.scattering.addEventListener("change", () => {
      const chosen = SCATTERINGS.find((name) => name === this.scattering.value) ?? null;
      events.scattering(chosen === resident_scatterings(this.atmospheres_below())[0] ? null : chosen);
    });
    this.clouds.addEventListener("change", () => events.clouds(this.chosen_clouds()));
    this.lamp.addEventListener("change", () => events.lamp(this.lamp.value));
    this.emission.addEventListener("change", () => events.emission(this.emission.value));
    this.terrain.addEventListener("change", () => events.terrain(this.terrain.value as TerrainKind));
    this.colours.addEventListener("change", () => events.colours(this.colours.value as PictureStyle));
    this.exposure.addEventListener("input", () => events.exposure(Number(this.exposure.value)));
    this.unit.addEventListener("change", () => events.unit(this.unit.value as BrightnessUnit));
    this.measure.addEventListener("change", () => events.measure(this.measure.value as MeasureName));
    this.press_lights = wire_group<LightsKind>("lights", events.lights);
    this.press_projection = wire_group<ProjectionName>("projection", events.projection);
    this.press_sky = wire_group<SkyKind>("sky-kind", events.sky);
    for (const layer of LAYERS) {
      const box = by_id(`layer-${layer}`, HTMLInputElement);
      const slider = by_id(`opacity-${layer}`, HTMLInputElement);
      const tell = () => {
        slider.disabled = !box.checked;
        events.layer(layer, box.checked ? Number(slider.value) : 0);
      };
      box.addEventListener("change", tell);
      slider.addEventListener("input", tell);
    }
  }

  set_scenes(scenes: readonly Scene[]): void {
    this.scene.replaceChildren(
      ...scenes.map(({ id, title, illustrative }) => {
        const said = !illustrative || /illustrative/i.test(title);
        return new Option(said ? title : words().scene.illustrative_title(title), id);
      }),
    );
    this.scene.disabled = scenes.length === 0;
  }

  set_atmospheres(atmospheres: readonly Atmosphere[]): void {
    this.atmospheres = atmospheres;
    this.show_air(null, null);
  }

  /** Base of the clouds that the control stands on, metres; null for a clear sky. */
  private chosen_clouds(): number | null {
    return this.clouds.value === "none" ? null : Number(this.clouds.value);
  }

  /** The packs under the clouds that the control stands on. */
  private atmospheres_below(): readonly Atmosphere[] {
    return packs_under(this.atmospheres, this.chosen_clouds());
  }

  /** What can be chosen of clouds, of scattering under them, and of turbidity with that scattering. */
  private show_air(scattering: ScatteringName | null, clouds: number | null): void {
    const bases = cloud_bases(this.atmospheres);
    const choices = [null, ...bases].map((base) => [String(base ?? "none"), clouds_title(base)] as const);
    fill(this.clouds, choices, String(clouds ?? "none"));
    // A choice of one is none.
    by_id("clouds-field", HTMLElement).hidden = bases.length === 0;
    const atmospheres = packs_under(this.atmospheres, clouds);
    const resident = resident_scatterings(atmospheres);
    const best = resident[0];
    if (best !== undefined) {
      fill(this.scattering, resident.map((name) => [name, scattering_title(name)] as const), scattering ?? best);
    }
    this.scattering.disabled = resident.length < 2;
    const ends = turbidity_ends(atmospheres, scattering);
    if (ends === null) return;
    const [least, most] = ends;
    this.turbidity.min = String(least);
    this.turbidity.max = String(most);
    this.turbidity.disabled = least === most;
    by_id("turbidity-ends", HTMLElement).replaceChildren(
      make("span", "", words().assumptions.least_turbidity(decimal(least))),
      make("span", "", words().assumptions.most_turbidity(decimal(most))),
    );
    this.show_turbidity();
  }

  /** Puts every control where the state says. */
  show(state: ViewState, scene: Scene | null): void {
    if (scene !== null) {
      this.scene.value = scene.id;
      const parts = [scene.illustrative && !/illustrative/i.test(scene.attribution ?? "") ? words().scene.illustrative : "", scene.date ?? "", scene.attribution ?? ""];
      this.scene_note.textContent = parts.filter((part) => part !== "").join(" · ");
      this.scene_note.classList.toggle("illustrative", scene.illustrative);
      show_layer_hint("elevation", scene.terrain ? null : words().layers.no_terrain);
      this.terrain.disabled = !scene.terrain;
    }
    show_layer_hint("brightness", state.clouds === null ? null : words().layers.clear_sky_alone);
    show_layer_hint("influence", state.place === null ? words().layers.place_first : null);
    this.show_air(state.scattering, state.clouds);
    this.turbidity.value = String(state.turbidity ?? DEFAULT_TURBIDITY);
    this.show_turbidity();
    fill(this.lamp, lamps(), state.lamp);
    fill(this.emission, emissions(), state.emission);
    this.terrain.value = state.terrain;
    this.colours.value = state.colours;
    by_id("exposure-field", HTMLElement).hidden = state.colours !== "realistic";
    this.exposure.value = String(state.exposure_ev);
    const stops = `${state.exposure_ev > 0 ? "+" : ""}${decimal(state.exposure_ev)} EV`;
    by_id("exposure-value", HTMLOutputElement).value = stops;
    this.exposure.setAttribute("aria-valuetext", stops);
    this.unit.value = state.unit;
    set_region_option(this.measure, state.region !== null);
    this.measure.value = state.measure;
    this.measure.hidden = state.layers.influence === 0;
    by_id("lights", HTMLElement).hidden = state.scenario === null;
    this.press_lights(state.lights);
    by_id("split-field", HTMLElement).hidden = state.scenario === null || state.lights !== "both";
    this.press_projection(state.projection);
    this.press_sky(state.sky);
    for (const layer of LAYERS) {
      const box = by_id(`layer-${layer}`, HTMLInputElement);
      const slider = by_id(`opacity-${layer}`, HTMLInputElement);
      box.checked = state.layers[layer] > 0 && !box.disabled;
      slider.disabled = !box.checked;
      if (state.layers[layer] > 0) slider.value = String(state.layers[layer]);
    }
  }

  private show_turbidity(): void {
    const turbidity = Number(this.turbidity.value);
    this.turbidity_value.value = `${fixed(turbidity, 1)} · ${air_words(turbidity)}`;
    this.turbidity.setAttribute("aria-valuetext", this.turbidity_value.value);
  }
}
