// The whole state: what a link holds, and the answers of the server.

import type { AreaSharesQuery, DarkerQuery, InfluenceQuery, NightQuery, SharesQuery, SkyParameters } from "../api/client.ts";
import type {
  AreaShares,
  Atmosphere,
  Bounds,
  Darker,
  InfluentialPixel,
  NamedPlace,
  Night,
  NightHours,
  Plan,
  Scenario,
  Scene,
  Shares,
  Site,
  SkyAnswer,
  SkyQuantities,
} from "../api/types.ts";
import type { Areas } from "../data/areas.ts";
import { EMPTY_PAINTING, type Painting } from "../lights/painting.ts";
import type { Change } from "../lights/plan-request.ts";
import type { Brush } from "../map/painter.ts";
import type { LayerState } from "../map/raster-layers.ts";
import { isOfLight } from "../sky/colour-maps.ts";
import type { SkyGrid, SkySample } from "../sky/grid.ts";
import type { Landscape } from "../sky/landscape.ts";
import { textFromRegion } from "../sky/region.ts";
import { PHOTOPIC, type Seen } from "../sky/seen.ts";
import { packsUnder } from "../ui/clouds.ts";
import type { LandKind, LayerName, Place, ViewState } from "./view-state.ts";

export interface Comparison {
  before: SkyQuantities;
  after: SkyQuantities;
}

export interface AppState extends ViewState {
  scenes: readonly Scene[];
  atmospheres: readonly Atmosphere[];
  /** The scene's named places. */
  places: readonly NamedPlace[];
  /** What went wrong last, until it is closed. */
  problem: { reason: unknown } | null;
  /** Whether the server does not answer. */
  isAway: boolean;
  /** When the oldest answer came that was kept for want of a network; null: all are the server's. */
  storedAtMs: number | null;
  /** The part that is there of what the server finds before it answers; null: it finds nothing. */
  foundPart: number | null;
  /** How much of the picked place's sky is there. */
  skyStage: "none" | "site" | "numbers" | "picture";
  /** Whether a sky is on its way. */
  isBusy: boolean;
  site: Site | null;
  answer: SkyAnswer | null;
  /** The night that the time lies in, over the picked place; without a time tonight. */
  night: Night | null;
  /** The same hour by hour: it comes after the sky. */
  nightHours: NightHours | null;
  /** What painted lights change: the numbers of the sky without and with them, both with the plan that they lie on. */
  comparison: Comparison | null;
  /** Whose light the sky is, or its marked part: it comes after the sky. */
  shares: Shares | null;
  /** Whether shares are asked for in the light that level ground receives, not overhead. */
  isOnGround: boolean;
  areas: Areas | null;
  /** The lights that do most to the sky while the map shows them; they come after the sky. */
  influences: readonly InfluentialPixel[];
  /** The same by those areas. */
  areaShares: AreaShares | null;
  /** Whether shares are on their way. */
  isSharing: boolean;
  /** Whether darker places are looked for, and shown. */
  isDarkerOpen: boolean;
  darker: Darker | null;
  /** The town that is shown on the map and in the sky while someone points at its name. */
  shownTown: NamedPlace | null;
  /** The numbers of the same place in the scene that is shown beside this one. */
  besideAnswer: SkyAnswer | null;
  panorama: SkyGrid | null;
  /** The panorama of today's lights or of that scene, where it is shown beside the other. */
  panoramaToday: SkyGrid | null;
  /** The land in light below each of them, where the state asks for it; it comes after the sky. */
  landscape: Landscape | null;
  landscapeToday: Landscape | null;
  /** Whether land is on its way. */
  isLandBusy: boolean;
  /** Width of the sky's plot by its height. */
  skyAspect: number;
  /** What is pointed at in the sky. */
  pointed: SkySample | null;
  /** Whether the next curve over the sky marks a region. */
  isDrawing: boolean;
  /** The plan or scenario that the state names, once it is there. */
  change: Change | null;
  isSearching: boolean;
  /** Whether the plan that is shown is one of many that are tried. */
  isTrying: boolean;
  painting: Painting;
  /** What strokes on the map paint with; null: they move it. */
  brush: Brush | null;
  layerStates: Readonly<Partial<Record<LayerName, LayerState>>>;
}

export function initialState(view: ViewState): AppState {
  return {
    ...view,
    scenes: [],
    atmospheres: [],
    places: [],
    problem: null,
    isAway: false,
    storedAtMs: null,
    foundPart: null,
    skyStage: "none",
    isBusy: false,
    site: null,
    answer: null,
    night: null,
    nightHours: null,
    comparison: null,
    besideAnswer: null,
    shares: null,
    isOnGround: false,
    areas: null,
    areaShares: null,
    influences: [],
    isSharing: false,
    isDarkerOpen: false,
    darker: null,
    shownTown: null,
    panorama: null,
    panoramaToday: null,
    landscape: null,
    landscapeToday: null,
    isLandBusy: false,
    skyAspect: 1,
    pointed: null,
    isDrawing: false,
    change: null,
    isSearching: false,
    isTrying: false,
    painting: EMPTY_PAINTING,
    brush: null,
    layerStates: {},
  };
}

type State = Readonly<AppState>;
/** What the sky of any place depends on. */
export type SkyConditions = Omit<SkyParameters, "lat" | "lon">;
/** The same but for the time, which counts for the natural sky alone. */
export type Conditions = Omit<SkyConditions, "time">;

/** The scene that is shown; null until the list of scenes is known. */
export function sceneOf({ scenes, scene }: State): Scene | null {
  return scenes.find(({ id }) => id === scene) ?? null;
}

/** Whether the land of a scene can be shown in light: only eye and camera see it, and only where there is terrain. */
export function hasLand({ colours, terrain }: Pick<State, "colours" | "terrain">, scene: Scene | null): boolean {
  return isOfLight(colours) && terrain === "on" && scene?.terrain === true;
}

/** How it is shown. */
export function landOf(state: State, scene: Scene | null = sceneOf(state)): LandKind {
  return hasLand(state, scene) ? state.land : "dark";
}

/** Share of light that the ground reflects, as the server has it. */
const ALBEDO: Record<LandKind, number> = { dark: 0, lit: 0.15, snow: 0.75, water: 0.15 };
const W_M2_OF_NW_CM2 = 1e-5;

/** Luminance of the ground around the eye: what it reflects of the sky's light, and what its own lamps send up; 0 where it is dark. */
export function landCdM2Of(state: State): number {
  const { answer, site, sky } = state;
  const land = landOf(state);
  if (answer === null || land === "dark") return 0;
  const lx = sky === "total" ? answer.sky.horizontal_total_illuminance_lx : answer.sky.horizontal_illuminance_lx;
  const sentUp = (site?.radiance_nw_cm2_sr ?? 0) * W_M2_OF_NW_CM2 * answer.lamp.lumens_per_dnb_watt;
  return (ALBEDO[land] * lx) / Math.PI + sentUp;
}

function isInside([west = -180, south = -90, east = 180, north = 90]: Bounds, { latitude_deg, longitude_deg }: Place): boolean {
  const isAcross = west > east ? longitude_deg >= west || longitude_deg <= east : longitude_deg >= west && longitude_deg <= east;
  return isAcross && latitude_deg >= south && latitude_deg <= north;
}

/** Degrees by degrees: enough to tell a country's scene from a continent's. */
function sizeOf([west = -180, south = -90, east = 180, north = 90]: Bounds): number {
  return (east - west + (east < west ? 360 : 0)) * (north - south);
}

/** Measured scenes before illustrative ones. */
export function bestFirst(scenes: readonly Scene[]): Scene[] {
  return [...scenes].sort((a, b) => Number(a.illustrative) - Number(b.illustrative));
}

/** Scenes of one land in other years may differ by some pixels at their edges. */
const SAME_SIZE = 1.1;

/** The last day that a scene's date names, for order alone; those without a date come first. */
function lastDay({ date }: Scene): string {
  const [last = ""] = (date ?? "").match(/\d{4}(-\d{2}){0,2}/g)?.slice(-1) ?? [];
  // The whole of a year or a month ends with it.
  return last === "" ? "" : `${last}-99-99`.slice(0, 10);
}

/** By the dates of their light; of one date, by when they were ingested. */
function isNewer(scene: Scene, than: Scene): boolean {
  const [day, otherDay] = [lastDay(scene), lastDay(than)];
  return day === otherDay ? (scene.ingested ?? "") > (than.ingested ?? "") : day > otherDay;
}

/**
 * The scene that has a place: the one that is shown if it does, else a measured one, the smallest, and of several as small the newest;
 * null where none does.
 */
export function sceneFor({ scenes, scene }: Pick<State, "scenes" | "scene">, place: Place): Scene | null {
  const there = scenes.filter(({ bounds }) => isInside(bounds, place));
  const shown = there.find(({ id }) => id === scene);
  if (shown !== undefined) return shown;
  const [smallest] = bestFirst(there.sort((a, b) => sizeOf(a.bounds) - sizeOf(b.bounds)));
  if (smallest === undefined) return null;
  const alike = there.filter(
    ({ bounds, illustrative }) => illustrative === smallest.illustrative && sizeOf(bounds) <= SAME_SIZE * sizeOf(smallest.bounds),
  );
  // Where neither says anything, the smallest stays.
  return alike.reduce((newest, other) => (isNewer(other, newest) ? other : newest), smallest);
}

/** The packs under the clouds of the state. */
export function packsOf({ atmospheres, clouds }: State): Atmosphere[] {
  return packsUnder(atmospheres, clouds);
}

export function planOf({ change }: State): Plan | null {
  return change?.kind === "plan" ? change.plan : null;
}

export function scenarioOf({ change }: State): Scenario | null {
  return change?.kind === "scenario" ? change.scenario : null;
}

/** The plan or scenario that painted lights lie on; null: those of today, or it is not known yet. */
export function baseOf(state: State): string | null {
  const painted = scenarioOf(state);
  return painted !== null && painted.id === state.scenario ? (painted.base ?? null) : null;
}

/** What sees the picture of the sky. */
export function seenOf({ panorama }: State): Seen {
  return panorama?.seen ?? PHOTOPIC;
}

/** The other scenes that have the picked place, such as those of other years. */
export function otherScenes({ scenes, scene, place }: Pick<State, "scenes" | "scene" | "place">): Scene[] {
  return place === null ? [] : scenes.filter(({ id, bounds }) => id !== scene && isInside(bounds, place));
}

/** The one of them that is shown beside this one. Changed lights are those of one scene, and are shown beside its own. */
export function besideScene(state: State): Scene | null {
  if (state.scenario !== null || state.beside === null) return null;
  return otherScenes(state).find(({ id }) => id === state.beside) ?? null;
}

/** Whether today's lights or those of another scene are shown beside these. */
export function isCompared(state: State): boolean {
  return state.scenario === null ? besideScene(state) !== null : state.lights === "both";
}

/** The pattern of clouds that pictures show. */
const CLOUD_PATTERN = 3;

/** Fields that `conditionsOf` depends on, and `skyConditions` but for the time. */
export const CONDITIONS = [
  "turbidity",
  "scattering",
  "clouds",
  "cloudCover",
  "lamp",
  "emission",
  "directUplight",
  "groundReflectance",
  "emissionKeep",
  "terrain",
  "scenario",
  "lights",
  "response",
] as const;

export function conditionsOf(state: State): Conditions {
  const { turbidity, scattering, clouds, cloudCover, lamp, emission, terrain, scenario, lights } = state;
  const { directUplight, groundReflectance, emissionKeep, response } = state;
  return {
    lamp,
    emission,
    ...(directUplight === null ? {} : { direct_uplight: directUplight }),
    ...(groundReflectance === null ? {} : { ground_reflectance: groundReflectance }),
    ...(emissionKeep === "flux" ? {} : { emission_keep: emissionKeep }),
    ...(terrain === "on" ? {} : { terrain }),
    ...(turbidity === null ? {} : { turbidity }),
    ...(scattering === null ? {} : { scattering }),
    ...(clouds === null ? {} : { clouds: String(clouds) }),
    ...(clouds === null || cloudCover >= 100 ? {} : { cloud_cover: cloudCover / 100 }),
    ...(scenario === null || lights === "today" ? {} : { scenario }),
    ...(response === "photopic" ? {} : { response }),
  };
}

/** Those of the sky's picture: one in the colours that an eye sees is of no other response. */
export function pictureConditions(state: State): Conditions {
  const { response: _, ...ofTheEye } = conditionsOf(state);
  return isOfLight(state.colours) ? ofTheEye : conditionsOf(state);
}

/** Those of the sky's numbers: of the picture's, at the time that is chosen. */
export function skyConditions(state: State): SkyConditions {
  const { time } = state;
  return { ...pictureConditions(state), ...(time === null ? {} : { time }) };
}

/** The same for a picture, in which clouds stand where one of their patterns has them: the mean of all would be a haze. */
export function withCloudPattern(parameters: SkyParameters): SkyParameters {
  return parameters.cloud_cover === undefined ? parameters : { ...parameters, cloud_pattern: CLOUD_PATTERN };
}

export function todaysConditions(state: State): Omit<Conditions, "scenario"> {
  const { scenario: _, ...today } = conditionsOf(state);
  return today;
}

/** As requests have them. Five decimals are a metre; a link restores the very same request. */
export function coordinatesOf({ latitude_deg, longitude_deg }: Place): { lat: number; lon: number } {
  return { lat: +latitude_deg.toFixed(5), lon: +longitude_deg.toFixed(5) };
}

export function influenceQuery({ measure, region }: State, place: Place, conditions: Conditions): InfluenceQuery {
  const marked = measure === "region" && region !== null ? { region: textFromRegion(region) } : {};
  return { ...coordinatesOf(place), ...conditions, measure, ...marked };
}

/** The shares of the zenith, of level ground, or of the part of the sky that is marked. */
export function sharesQuery(state: State, place: Place): SharesQuery {
  const { region, isOnGround } = state;
  const whole = isOnGround ? ("horizontal" as const) : ("zenith" as const);
  const marked = region === null ? { measure: whole } : { measure: "region" as const, region: textFromRegion(region) };
  return { ...coordinatesOf(place), ...pictureConditions(state), ...marked };
}

/** The same of the areas of a file, under the names that were chosen. */
export function areaSharesQuery(state: State, place: Place, { nameField }: Pick<Areas, "nameField">): AreaSharesQuery {
  return { ...sharesQuery(state, place), ...(nameField === null ? {} : { name_field: nameField }) };
}

/** Darker places are looked for under a clear sky. */
export function darkerQuery(state: State, place: Place): DarkerQuery {
  const { clouds: _, cloud_cover: _cover, ...clear } = pictureConditions(state);
  return { ...coordinatesOf(place), ...clear };
}

/** Hours are told of a clear sky, in total light. */
export function nightQuery(state: State, place: Place, date: string): NightQuery {
  const { clouds: _clouds, cloud_cover: _cover, response: _response, ...clear } = conditionsOf(state);
  return { ...coordinatesOf(place), ...clear, date };
}
