// What the viewer shows, as far as a link holds it.

import type { EmissionKeepName, ScatteringName } from "../api/client.ts";
import type { NamedPlace } from "../api/types.ts";
import type { PictureStyle } from "../sky/colour-maps.ts";
import type { SkyKind } from "../sky/grid.ts";
import type { Gaze, ProjectionName } from "../sky/projection.ts";
import type { Region } from "../sky/region.ts";
import type { BrightnessUnit } from "../sky/units.ts";

/** A point on the ground, as the API names it. */
export type Place = Pick<NamedPlace, "latitude_deg" | "longitude_deg">;
export type MapView = Place & { zoom: number };

/** The best first. */
export const SCATTERINGS: readonly ScatteringName[] = ["multiple", "single"];

/** What the server assumes where the request names none. */
export const DEFAULT_TURBIDITY = 2.5;

/** From the lowest to the highest on the map. */
export const LAYERS = ["elevation", "brightness", "radiance", "influence"] as const;
export type LayerName = (typeof LAYERS)[number];
/** Layers in the colours of a scale, from the lowest to the highest: over each other they say nothing. */
const COLOURED: readonly LayerName[] = ["brightness", "radiance", "influence"];

/** What of the sky lights have their part in, as far as the viewer shows it. */
export const MEASURES = ["zenith", "mean", "horizontal", "norm", "region"] as const;
export type MeasureName = (typeof MEASURES)[number];

/** Surfaces of which a map of all places shows the light, though no light has its part in that: what only maps have. */
export const SURFACES = ["slope", "vertical_largest", "cylindrical"] as const;
export type SurfaceName = (typeof SURFACES)[number];

/** What of the sky a map of all places shows. */
export type MapMeasure = "zenith" | "mean" | "horizontal" | SurfaceName;

/** The measure of a map of all places: a surface where one is chosen, else that of the influences where maps have it, else the zenith. */
export function mapMeasure({ measure, surface }: Pick<ViewState, "measure" | "surface">): MapMeasure {
  return surface ?? (measure === "mean" || measure === "horizontal" ? measure : "zenith");
}

/** What sees the sky, as far as the viewer offers it; the default first. */
export const RESPONSES = ["photopic", "scotopic", "johnson_b", "johnson_v", "johnson_r", "sqm", "melanopic", "dnb"] as const;
export type ResponseName = (typeof RESPONSES)[number];

/** More than these are no longer seen side by side. */
export const MAX_PINS = 5;

/** How the land below the skyline is shown to eye and camera: as a silhouette, in the light that falls on it, so under snow, or with calm water. */
export const LANDS = ["dark", "lit", "snow", "water"] as const;
export type LandKind = (typeof LANDS)[number];

export type TerrainKind = "on" | "off";

/** What of a light the satellite's radiance says; the default first. */
export const EMISSION_KEEPS: readonly EmissionKeepName[] = ["flux", "nadir_radiance"];

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
  /** Id of a scene whose sky and map of the same place are shown beside those of `scene`, such as of another year; null: there is none. */
  beside: string | null;
  /** How far today's sky and map, or those of the other scene, reach from the left where both are shown, 0 to 1. */
  split: number;
  /** null: fit the scene. */
  view: MapView | null;
  /** When the natural sky is that of, as UTC in whole minutes such as `2026-08-12T22:30:00Z`; null: of no time, a dark sky. */
  time: string | null;
  /** null: the server's default. */
  turbidity: number | null;
  /** null: the best that the server has. */
  scattering: ScatteringName | null;
  /** Base of a closed layer of cloud above sea level, metres; null: a clear sky. */
  clouds: number | null;
  /** Per cent of that layer that is cloud; 100: all of it. */
  cloudCover: number;
  lamp: string;
  emission: string;
  /** Share of the lamps' light that goes above the horizon directly, 0..1; null: that of the emission. */
  directUplight: number | null;
  /** Share of the rest that the ground sends back, 0..1; null: that of the emission. */
  groundReflectance: number | null;
  emissionKeep: EmissionKeepName;
  /** Whether terrain hides the sky below the horizon. */
  terrain: TerrainKind;
  /** What sees the sky in false colour and the map's layers. */
  response: ResponseName;
  projection: ProjectionName;
  /** Where the perspective looks; null: towards the brightest light. */
  gaze: Gaze | null;
  sky: SkyKind;
  colours: PictureStyle;
  /** Of the pictures of eye and camera, stops. */
  exposureEv: number;
  /** Luminance that the eye stays adapted to, cd m⁻²; null: it follows the sky. */
  adaptationCdM2: number | null;
  land: LandKind;
  unit: BrightnessUnit;
  /** Of the layers of influence and of brightness; `region` only where there is one. */
  measure: MeasureName;
  /** Of the layer of brightness instead; null: there is none. */
  surface: SurfaceName | null;
  /** The part of the sky that is marked. */
  region: Region | null;
  /** Places that are compared. */
  pins: readonly Place[];
  /** Whether the place's report is shown. */
  isReport: boolean;
  /** Opacity 0..1; 0 is off. */
  layers: Record<LayerName, number>;
}

export const DEFAULT_STATE: Readonly<ViewState> = {
  scene: null,
  place: null,
  scenario: null,
  lights: "changed",
  beside: null,
  split: 0.5,
  view: null,
  time: null,
  turbidity: null,
  scattering: null,
  clouds: null,
  cloudCover: 100,
  lamp: "mixed",
  emission: "modern_city",
  directUplight: null,
  groundReflectance: null,
  emissionKeep: "flux",
  terrain: "on",
  response: "photopic",
  projection: "equirectangular",
  gaze: null,
  sky: "total",
  colours: "eye",
  exposureEv: 0,
  adaptationCdM2: null,
  land: "dark",
  unit: "magnitude",
  measure: "zenith",
  surface: null,
  region: null,
  pins: [],
  isReport: false,
  layers: { elevation: 0, brightness: 0, radiance: 0.85, influence: 0 },
};

/** The layers with one of another opacity: of those with a colour scale one is on at a time. */
export function withLayer(layers: ViewState["layers"], name: LayerName, opacity: number): ViewState["layers"] {
  const isAlone = opacity > 0 && COLOURED.includes(name);
  const others = isAlone ? Object.fromEntries(COLOURED.map((other) => [other, 0])) : {};
  return { ...layers, ...others, [name]: opacity };
}

/** The same as a link has them. Of several with a colour scale that it names the highest is on, and of none the default. */
export function layersFrom(named: Readonly<Partial<Record<LayerName, number>>>): ViewState["layers"] {
  const layers = { ...DEFAULT_STATE.layers, ...named };
  const on = COLOURED.filter((name) => (named[name] ?? 0) > 0).at(-1);
  return on === undefined ? layers : withLayer(layers, on, layers[on]);
}
