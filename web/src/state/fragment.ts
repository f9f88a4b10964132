// The form of the viewer's state in the URL's fragment, so that a link or a reload restores it.

import { STYLES } from "../sky/colour-maps.ts";
import { type Gaze, PROJECTIONS } from "../sky/projection.ts";
import { regionFromText, textFromRegion } from "../sky/region.ts";
import { UNITS } from "../sky/units.ts";
import {
  DEFAULT_STATE,
  EMISSION_KEEPS,
  LANDS,
  LAYERS,
  type LayerName,
  LIGHTS,
  layersFrom,
  MAX_PINS,
  MEASURES,
  type Place,
  RESPONSES,
  SCATTERINGS,
  SURFACES,
  type ViewState,
} from "./view-state.ts";

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

const SCENE_ID = /^[a-z0-9-]{1,64}$/;

/** Names that links of earlier viewers have. */
const FORMER_EMISSIONS: Readonly<Record<string, string>> = {
  garstang: "garstang_1986",
  shielded: "full_cutoff",
  lambert: "full_cutoff",
};

function emissionFromText(text: string | null): string {
  const name = matching(text, /^[a-z0-9_.,]{1,64}$/) ?? DEFAULT_STATE.emission;
  return FORMER_EMISSIONS[name] ?? name;
}

/** A time of the years that the server knows, as UTC in whole minutes; seconds, as programs write them, are left out. */
function timeFromText(text: string | null): string | null {
  const written = matching(text, /^(19|20)\d\d-\d\d-\d\dT\d\d:\d\d(:[0-5]\d)?Z$/);
  const instant = new Date(written === null ? "" : `${written.slice(0, 16)}Z`);
  return Number.isNaN(instant.getTime()) ? null : instant.toISOString().replace(".000", "");
}

/** `azimuth/elevation/field`, degrees. */
function gazeFromText(text: string | null): Gaze | null {
  const [azimuth, elevation, field] = (text ?? "").split("/");
  const azimuthDeg = numberIn(azimuth ?? null, 0, 360);
  const elevationDeg = numberIn(elevation ?? null, -10, 90);
  const fieldDeg = numberIn(field ?? null, 10, 120);
  return azimuthDeg === null || elevationDeg === null || fieldDeg === null ? null : { azimuthDeg, elevationDeg, fieldDeg };
}

/** `latitude,longitude;…` */
function pinsFromText(text: string | null): Place[] {
  const pins = (text ?? "").split(";").map((pin) => {
    const [latitude, longitude] = pin.split(",");
    return { latitude_deg: numberIn(latitude ?? null, -90, 90), longitude_deg: numberIn(longitude ?? null, -180, 180) };
  });
  return pins.filter((pin): pin is Place => pin.latitude_deg !== null && pin.longitude_deg !== null).slice(0, MAX_PINS);
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
  const named: Partial<Record<LayerName, number>> = {};
  for (const name of LAYERS) {
    const opacity = numberIn(query.get(name), 0, 1);
    if (opacity !== null) named[name] = opacity;
  }
  return {
    scene: matching(query.get("scene"), SCENE_ID),
    place: latitudeDeg !== null && longitudeDeg !== null ? { latitude_deg: latitudeDeg, longitude_deg: longitudeDeg } : null,
    scenario: matching(query.get("scenario"), /^[ps]-[0-9a-f]{20}$/),
    lights: oneOf(query.get("lights"), LIGHTS, DEFAULT_STATE.lights),
    beside: matching(query.get("beside"), SCENE_ID),
    split: numberIn(query.get("split"), 0, 1) ?? DEFAULT_STATE.split,
    view:
      view.zoom !== null && view.latitude_deg !== null && view.longitude_deg !== null
        ? { zoom: view.zoom, latitude_deg: view.latitude_deg, longitude_deg: view.longitude_deg }
        : null,
    time: timeFromText(query.get("time")),
    turbidity: numberIn(query.get("turbidity"), 1, 100),
    scattering: SCATTERINGS.find((name) => name === query.get("scattering")) ?? null,
    clouds: numberIn(matching(query.get("clouds"), /^[0-9]+$/), 200, 12_000),
    cloudCover: numberIn(query.get("cover"), 0, 100) ?? DEFAULT_STATE.cloudCover,
    lamp: matching(query.get("lamp"), /^[a-z0-9_.,:]{1,4096}$/) ?? DEFAULT_STATE.lamp,
    emission: emissionFromText(query.get("emission")),
    directUplight: numberIn(query.get("uplight"), 0, 1),
    groundReflectance: numberIn(query.get("ground"), 0, 1),
    emissionKeep: oneOf(query.get("keep"), EMISSION_KEEPS, DEFAULT_STATE.emissionKeep),
    terrain: oneOf(query.get("terrain"), ["on", "off"], DEFAULT_STATE.terrain),
    response: oneOf(query.get("response"), RESPONSES, DEFAULT_STATE.response),
    projection: oneOf(query.get("projection"), PROJECTIONS, DEFAULT_STATE.projection),
    gaze: gazeFromText(query.get("look")),
    sky: oneOf(query.get("sky"), ["artificial", "total"], DEFAULT_STATE.sky),
    colours: oneOf(query.get("colours"), STYLES, DEFAULT_STATE.colours),
    exposureEv: numberIn(query.get("exposure"), -4, 6) ?? DEFAULT_STATE.exposureEv,
    adaptationCdM2: numberIn(query.get("adaptation"), 1e-4, 1e5),
    land: oneOf(query.get("land"), LANDS, DEFAULT_STATE.land),
    unit: oneOf(query.get("unit"), UNITS, DEFAULT_STATE.unit),
    measure: measure === "region" && region === null ? DEFAULT_STATE.measure : measure,
    surface: SURFACES.find((name) => name === query.get("surface")) ?? null,
    region,
    pins: pinsFromText(query.get("pins")),
    isReport: query.get("report") === "on",
    layers: layersFrom(named),
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
  if (state.scenario !== null) add("lights", state.lights, DEFAULT_STATE.lights);
  add("beside", state.beside, null);
  if (state.scenario !== null || state.beside !== null) add("split", +state.split.toFixed(2), DEFAULT_STATE.split);
  if (state.view !== null) {
    const { zoom, latitude_deg, longitude_deg } = state.view;
    parts.push(`map=${+zoom.toFixed(2)}/${+latitude_deg.toFixed(4)}/${+longitude_deg.toFixed(4)}`);
  }
  add("time", state.time?.replace(":00Z", "Z") ?? null, null);
  add("turbidity", state.turbidity, null);
  add("scattering", state.scattering, null);
  add("clouds", state.clouds, null);
  if (state.clouds !== null) add("cover", state.cloudCover, DEFAULT_STATE.cloudCover);
  add("lamp", state.lamp, DEFAULT_STATE.lamp);
  add("emission", state.emission, DEFAULT_STATE.emission);
  add("uplight", state.directUplight, null);
  add("ground", state.groundReflectance, null);
  add("keep", state.emissionKeep, DEFAULT_STATE.emissionKeep);
  add("terrain", state.terrain, DEFAULT_STATE.terrain);
  add("response", state.response, DEFAULT_STATE.response);
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
  add("adaptation", state.adaptationCdM2, null);
  add("land", state.land, DEFAULT_STATE.land);
  add("unit", state.unit, DEFAULT_STATE.unit);
  add("measure", state.measure, DEFAULT_STATE.measure);
  add("surface", state.surface, null);
  add("region", state.region === null ? null : textFromRegion(state.region), null);
  const pins = state.pins.map(({ latitude_deg, longitude_deg }) => `${+latitude_deg.toFixed(5)},${+longitude_deg.toFixed(5)}`);
  add("pins", pins.join(";"), "");
  add("report", state.isReport ? "on" : null, null);
  for (const name of LAYERS.toReversed()) add(name, +state.layers[name].toFixed(2), DEFAULT_STATE.layers[name]);
  return parts.length === 0 ? "" : `#${parts.join("&")}`;
}
