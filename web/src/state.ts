// What the viewer shows, and its form in the URL's fragment, so that a link or a reload restores it.

import type { ScatteringName } from "./api/client.ts";
import type { NamedPlace } from "./api/types.ts";
import { type PictureStyle, STYLES } from "./sky/colour-maps.ts";
import type { SkyKind } from "./sky/grid.ts";
import { type Gaze, PROJECTIONS, type ProjectionName } from "./sky/projection.ts";
import { type Region, regionFromText, textFromRegion } from "./sky/region.ts";
import { type BrightnessUnit, UNITS } from "./sky/units.ts";

/** A point on the ground, as the API names it. */
export type Place = Pick<NamedPlace, "latitude_deg" | "longitude_deg">;
export type MapView = Place & { zoom: number };

const SCATTERING_NAMES: readonly ScatteringName[] = ["multiple", "single"];

/** From the lowest to the highest on the map. */
export const LAYERS = ["elevation", "brightness", "radiance", "influence"] as const;
export type LayerName = (typeof LAYERS)[number];

/** What of the sky lights have their part in, as far as the viewer shows it. */
export const MEASURES = ["zenith", "mean", "horizontal", "norm", "region"] as const;
export type MeasureName = (typeof MEASURES)[number];

export type TerrainKind = "on" | "off";

/** The scene's lights as they are, as the scenario has them, or one beside the other. */
export const LIGHTS = ["today", "both", "changed"] as const;
export type LightsKind = (typeof LIGHTS)[number];

export interface ViewState {
  /** null until the list of scenes is known. */
  scene: string | null;
  place: Place | null;
  /** Id of the plan or scenario that changes the scene's lights; null: there is none. */
  scenario: string | null;
  /** Which lights are shown where there is a scenario. */
  lights: LightsKind;
  /** How far today's sky and map reach from the left where both are shown, 0 to 1. */
  split: number;
  /** null: fit the scene. */
  view: MapView | null;
  /** null: the server's default. */
  turbidity: number | null;
  /** null: the best that the server has. */
  scattering: ScatteringName | null;
  /** Base of a closed layer of cloud above sea level, metres; null: a clear sky. */
  clouds: number | null;
  lamp: string;
  emission: string;
  /** Whether terrain hides the sky below the horizon. */
  terrain: TerrainKind;
  projection: ProjectionName;
  /** Where the perspective looks; null: towards the brightest light. */
  gaze: Gaze | null;
  sky: SkyKind;
  colours: PictureStyle;
  /** Of the realistic picture, stops. */
  exposureEv: number;
  unit: BrightnessUnit;
  /** Of the layer of influence; `region` only where there is one. */
  measure: MeasureName;
  /** The part of the sky that is marked. */
  region: Region | null;
  /** Opacity 0..1; 0 is off. */
  layers: Record<LayerName, number>;
}

export const DEFAULT_STATE: Readonly<ViewState> = {
  scene: null,
  place: null,
  scenario: null,
  lights: "changed",
  split: 0.5,
  view: null,
  turbidity: null,
  scattering: null,
  clouds: null,
  lamp: "mixed",
  emission: "garstang",
  terrain: "on",
  projection: "equirectangular",
  gaze: null,
  sky: "artificial",
  colours: "inferno",
  exposureEv: 0,
  unit: "magnitude",
  measure: "zenith",
  region: null,
  layers: { elevation: 0, brightness: 0, radiance: 0.85, influence: 0 },
};

function numberIn(text: string | null, min: number, max: number): number | null {
  if (text === null || text.trim() === "") return null;
  const value = Number(text);
  return Number.isFinite(value) && value >= min && value <= max ? value : null;
}

function oneOf<T extends string>(text: string | null, allowed: readonly T[], otherwise: T): T {
  return allowed.find((name) => name === text) ?? otherwise;
}

function matching(text: string | null, pattern: RegExp): string | null {
  return text !== null && pattern.test(text) ? text : null;
}

/** `azimuth/elevation/field`, degrees. */
function gazeFromText(text: string | null): Gaze | null {
  const [azimuth, elevation, field] = (text ?? "").split("/");
  const azimuthDeg = numberIn(azimuth ?? null, 0, 360);
  const elevationDeg = numberIn(elevation ?? null, -10, 90);
  const fieldDeg = numberIn(field ?? null, 10, 120);
  return azimuthDeg === null || elevationDeg === null || fieldDeg === null ? null : { azimuthDeg, elevationDeg, fieldDeg };
}

/** Reads a fragment such as `#scene=demo&lat=…`. What is missing or makes no sense takes its default. */
export function stateFromFragment(fragment: string): ViewState {
  const query = new URLSearchParams(fragment.replace(/^#/, ""));
  const latitudeDeg = numberIn(query.get("lat"), -90, 90);
  const longitudeDeg = numberIn(query.get("lon"), -180, 180);
  const [zoom, viewLatitude, viewLongitude] = (query.get("map") ?? "").split("/");
  const view = {
    zoom: numberIn(zoom ?? null, 0, 22),
    latitude_deg: numberIn(viewLatitude ?? null, -90, 90),
    longitude_deg: numberIn(viewLongitude ?? null, -540, 540),
  };
  const region = regionFromText(query.get("region"));
  const measure = oneOf(query.get("measure"), MEASURES, DEFAULT_STATE.measure);
  const layers = { ...DEFAULT_STATE.layers };
  for (const name of LAYERS) layers[name] = numberIn(query.get(name), 0, 1) ?? layers[name];
  return {
    scene: matching(query.get("scene"), /^[a-z0-9-]{1,64}$/),
    place: latitudeDeg !== null && longitudeDeg !== null ? { latitude_deg: latitudeDeg, longitude_deg: longitudeDeg } : null,
    scenario: matching(query.get("scenario"), /^[ps]-[0-9a-f]{20}$/),
    lights: oneOf(query.get("lights"), LIGHTS, DEFAULT_STATE.lights),
    split: numberIn(query.get("split"), 0, 1) ?? DEFAULT_STATE.split,
    view:
      view.zoom !== null && view.latitude_deg !== null && view.longitude_deg !== null
        ? { zoom: view.zoom, latitude_deg: view.latitude_deg, longitude_deg: view.longitude_deg }
        : null,
    turbidity: numberIn(query.get("turbidity"), 1, 100),
    scattering: SCATTERING_NAMES.find((name) => name === query.get("scattering")) ?? null,
    clouds: numberIn(matching(query.get("clouds"), /^[0-9]+$/), 200, 12_000),
    lamp: matching(query.get("lamp"), /^[a-z0-9_.,]{1,64}$/) ?? DEFAULT_STATE.lamp,
    emission: matching(query.get("emission"), /^[a-z0-9_.,]{1,64}$/) ?? DEFAULT_STATE.emission,
    terrain: oneOf(query.get("terrain"), ["on", "off"], DEFAULT_STATE.terrain),
    projection: oneOf(query.get("projection"), PROJECTIONS, DEFAULT_STATE.projection),
    gaze: gazeFromText(query.get("look")),
    sky: oneOf(query.get("sky"), ["artificial", "total"], DEFAULT_STATE.sky),
    colours: oneOf(query.get("colours"), STYLES, DEFAULT_STATE.colours),
    exposureEv: numberIn(query.get("exposure"), -4, 6) ?? DEFAULT_STATE.exposureEv,
    unit: oneOf(query.get("unit"), UNITS, DEFAULT_STATE.unit),
    measure: measure === "region" && region === null ? DEFAULT_STATE.measure : measure,
    region,
    layers,
  };
}

/** The fragment that `stateFromFragment` reads; defaults are left out to keep links short. */
export function fragmentFromState(state: ViewState): string {
  const parts: string[] = [];
  const add = (name: string, value: string | number | null, otherwise: string | number | null) => {
    if (value !== null && value !== otherwise) parts.push(`${name}=${value}`);
  };
  add("scene", state.scene, null);
  add("lat", state.place === null ? null : +state.place.latitude_deg.toFixed(5), null);
  add("lon", state.place === null ? null : +state.place.longitude_deg.toFixed(5), null);
  add("scenario", state.scenario, null);
  if (state.scenario !== null) {
    add("lights", state.lights, DEFAULT_STATE.lights);
    add("split", +state.split.toFixed(2), DEFAULT_STATE.split);
  }
  if (state.view !== null) {
    const { zoom, latitude_deg, longitude_deg } = state.view;
    parts.push(`map=${+zoom.toFixed(2)}/${+latitude_deg.toFixed(4)}/${+longitude_deg.toFixed(4)}`);
  }
  add("turbidity", state.turbidity, null);
  add("scattering", state.scattering, null);
  add("clouds", state.clouds, null);
  add("lamp", state.lamp, DEFAULT_STATE.lamp);
  add("emission", state.emission, DEFAULT_STATE.emission);
  add("terrain", state.terrain, DEFAULT_STATE.terrain);
  add("projection", state.projection, DEFAULT_STATE.projection);
  add(
    "look",
    state.gaze === null
      ? null
      : [state.gaze.azimuthDeg, state.gaze.elevationDeg, state.gaze.fieldDeg].map((degrees) => +degrees.toFixed(1)).join("/"),
    null,
  );
  add("sky", state.sky, DEFAULT_STATE.sky);
  add("colours", state.colours, DEFAULT_STATE.colours);
  add("exposure", state.exposureEv, DEFAULT_STATE.exposureEv);
  add("unit", state.unit, DEFAULT_STATE.unit);
  add("measure", state.measure, DEFAULT_STATE.measure);
  add("region", state.region === null ? null : textFromRegion(state.region), null);
  for (const name of LAYERS.toReversed()) add(name, +state.layers[name].toFixed(2), DEFAULT_STATE.layers[name]);
  return parts.length === 0 ? "" : `#${parts.join("&")}`;
}
