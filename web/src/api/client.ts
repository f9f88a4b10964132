// How the viewer asks the server: paths, parameters and answers are those of the OpenAPI document.

import { readCompactPanorama } from "../sky/compact.ts";
import { ApiError, noAnswer, problemFromResponse } from "./problem.ts";
import type { PlanBody, paths, ScenarioBody } from "./schema.ts";

/** Of answers that the service worker kept: when they came. The worker is built alone, so it has the name once more. */
export const STORED_HEADER = "x-skyglow-stored";

type Method = "get" | "post";
/** Paths that take a method; under any other path the document's types have it as `never`. */
type Path<M extends Method> = { [P in keyof paths]: paths[P] extends Record<M, object> ? P : never }[keyof paths];
type Operation<M extends Method, P extends Path<M>> = paths[P][M];
type Parameters<O, Place extends "path" | "query"> = O extends { parameters: { [K in Place]?: infer V } }
  ? [NonNullable<V>] extends [never]
    ? Record<string, never>
    : NonNullable<V>
  : never;
type Body<O> = O extends { requestBody?: { content: { "application/json": infer B } } } ? B : never;
/** What a success answers. */
type Json<O, Status extends number> = O extends { responses: { [S in Status]: { content: { "application/json": infer A } } } }
  ? A
  : never;

type PathValues<P extends Path<"get">> = Parameters<Operation<"get", P>, "path">;
type Query<P extends Path<"get">> = Parameters<Operation<"get", P>, "query">;

/** What the sky depends on besides the scene. */
export type SkyParameters = Pick<
  Query<"/api/v1/scenes/{scene}/sky">,
  | "lat"
  | "lon"
  | "turbidity"
  | "scattering"
  | "clouds"
  | "cloud_cover"
  | "cloud_pattern"
  | "lamp"
  | "emission"
  | "direct_uplight"
  | "ground_reflectance"
  | "emission_keep"
  | "terrain"
  | "scenario"
  | "response"
  | "time"
>;
/** What the tiles of a layer depend on besides the scene. */
export type LayerQuery = Query<"/api/v1/scenes/{scene}/tiles/{layer}/tilejson.json">;
/** What the influences of lights on a sky depend on besides the scene. */
export type InfluenceQuery = Query<"/api/v1/scenes/{scene}/influence.tif">;
/** What the shares of towns and areas in a sky depend on besides the scene. */
export type SharesQuery = Query<"/api/v1/scenes/{scene}/shares">;
/** The same of areas. */
export type AreaSharesQuery = Parameters<Operation<"post", "/api/v1/scenes/{scene}/shares">, "query">;
/** What darker places around one depend on besides the scene. */
export type DarkerQuery = Query<"/api/v1/scenes/{scene}/darker">;
/** What a night over a place depends on besides the scene. */
export type NightQuery = Query<"/api/v1/scenes/{scene}/night">;
/** What a plan depends on besides its sites. */
export type PlanQuery = Parameters<Operation<"post", "/api/v1/scenes/{scene}/plans">, "query">;
/** A GeoJSON FeatureCollection of areas. */
export type AreasBody = Body<Operation<"post", "/api/v1/scenes/{scene}/shares">>;
export type ScatteringName = NonNullable<SkyParameters["scattering"]>;
export type EmissionKeepName = NonNullable<SkyParameters["emission_keep"]>;

/** Retries of a busy server (429, 503). */
const RETRIES = 3;
const MAX_RETRY_WAIT_S = 10;
/** Interval and limit of polling a layer of tiles; after the limit its tiles report the error. */
const LAYER_WAIT_S = 0.7;
const MAX_LAYER_WAIT_S = 3600;

/** Absolute, so that it also holds inside the map's worker; below a reverse proxy's prefix if there is one. */
export function urlOf<P extends Path<"get">>(path: P, values: PathValues<P>, query: Query<P>): string {
  return buildUrl(path, values, query);
}

function buildUrl(path: string, values: object, query: object): string {
  const filled = path.replace(/\{(\w+)\}/g, (_, name: string) =>
    encodeURIComponent(String((values as Record<string, unknown>)[name])),
  );
  const url = new URL(filled.slice(1), document.baseURI);
  url.hash = "";
  for (const [name, value] of Object.entries(query))
    if (value !== undefined && value !== null) url.searchParams.set(name, String(value));
  return url.href;
}

function pause(seconds: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(resolve, seconds * 1000);
    signal.addEventListener("abort", () => {
      clearTimeout(timer);
      reject(signal.reason as Error);
    });
  });
}

function get<P extends Path<"get">>(
  path: P,
  values: PathValues<P>,
  query: Query<P>,
  signal: AbortSignal,
): Promise<Json<Operation<"get", P>, 200>> {
  return request(urlOf(path, values, query), { signal, headers: { accept: "application/json" } });
}

function post<P extends Path<"post">, O extends Operation<"post", P>>(
  path: P,
  values: Parameters<O, "path">,
  query: Parameters<O, "query">,
  body: Body<O>,
  signal: AbortSignal,
): Promise<Json<O, 200> | Json<O, 201>> {
  const headers = { accept: "application/json", "content-type": "application/json" };
  return request(buildUrl(path, values, query), { method: "POST", signal, headers, body: JSON.stringify(body) });
}

async function request<A>(url: string, init: RequestInit & { signal: AbortSignal }): Promise<A> {
  return (await (await answered(url, init)).json()) as A;
}

/** Hears of every answer whether it is one that was kept, and when that came; null: the server answered. */
let tellStored: (date: string | null) => void = () => {};
export function onStored(heard: typeof tellStored): void {
  tellStored = heard;
}

/** Hears of what is found before requests can be answered: the part that is there; null: all is. */
let tellFinding: (part: number | null) => void = () => {};
export function onFinding(heard: typeof tellFinding): void {
  tellFinding = heard;
}

/** Repeats a request while the server is busy, and for as long as it makes what is asked for. All requests are idempotent. */
async function answered(url: string, init: RequestInit & { signal: AbortSignal }): Promise<Response> {
  const { signal } = init;
  let isFinding = false;
  try {
    for (let attempt = 0; ; attempt++) {
      let response: Response;
      try {
        response = await fetch(url, init);
      } catch (reason) {
        if (signal.aborted) throw reason;
        throw noAnswer();
      }
      if (response.ok) {
        tellStored(response.headers.get(STORED_HEADER));
        return response;
      }
      const busy = response.status === 503 || response.status === 429;
      const retryAfterS = Number(response.headers.get("retry-after") ?? NaN);
      const waitS = Number.isFinite(retryAfterS) ? Math.max(retryAfterS, 0.2) : 1;
      const problem = await problemFromResponse(response);
      const isMade = problem.type === "/problems/being-made";
      if (!busy || (attempt >= RETRIES && !isMade) || waitS > MAX_RETRY_WAIT_S) throw new ApiError(response.status, problem);
      if (isMade) {
        isFinding = true;
        tellFinding(problem.progress ?? 0);
      }
      await pause(waitS, signal);
    }
  } finally {
    if (isFinding) tellFinding(null);
  }
}

export const api = {
  scenes: (signal: AbortSignal) => get("/api/v1/scenes", {}, {}, signal),
  /** Fails unless the server itself answers. */
  reach: async (signal: AbortSignal): Promise<void> => {
    await answered(urlOf("/api/v1/scenes", {}, {}), { signal, cache: "no-store", headers: { accept: "application/json" } });
  },
  places: (scene: string, signal: AbortSignal) => get("/api/v1/scenes/{scene}/places", { scene }, {}, signal),
  /** Places of the world by name. */
  worldPlaces: (name: string, signal: AbortSignal) => get("/api/v1/places", {}, { name }, signal),
  /** The night that begins on the evening of a date. */
  night: ({ lat, lon }: SkyParameters, date: string, signal: AbortSignal) => get("/api/v1/night", {}, { lat, lon, date }, signal),
  /** The same night hour by hour, with the lights of the scene. */
  nightHours: (scene: string, query: NightQuery, signal: AbortSignal) =>
    get("/api/v1/scenes/{scene}/night", { scene }, query, signal),
  atmospheres: (signal: AbortSignal) => get("/api/v1/atmospheres", {}, {}, signal),
  site: (scene: string, { lat, lon }: SkyParameters, signal: AbortSignal) =>
    get("/api/v1/scenes/{scene}/site", { scene }, { lat, lon }, signal),
  sky: (scene: string, parameters: SkyParameters, signal: AbortSignal) =>
    get("/api/v1/scenes/{scene}/sky", { scene }, parameters, signal),
  panorama: async (scene: string, parameters: SkyParameters, signal: AbortSignal) => {
    const url = urlOf("/api/v1/scenes/{scene}/panorama.sky", { scene }, parameters);
    const answer = await answered(url, { signal });
    return readCompactPanorama(await answer.arrayBuffer());
  },
  /** Whose light it is, by town. */
  shares: (scene: string, query: SharesQuery, signal: AbortSignal) =>
    get("/api/v1/scenes/{scene}/shares", { scene }, query, signal),
  /** The same by areas. */
  areaShares: (scene: string, query: AreaSharesQuery, areas: AreasBody, signal: AbortSignal) =>
    post("/api/v1/scenes/{scene}/shares", { scene }, query, areas, signal),
  areaSharesFile: async (scene: string, query: AreaSharesQuery, areas: AreasBody, signal: AbortSignal): Promise<Blob> => {
    const url = buildUrl("/api/v1/scenes/{scene}/shares.csv", { scene }, query);
    const headers = { accept: "text/csv", "content-type": "application/json" };
    return (await answered(url, { method: "POST", signal, headers, body: JSON.stringify(areas) })).blob();
  },
  darker: (scene: string, query: DarkerQuery, signal: AbortSignal) =>
    get("/api/v1/scenes/{scene}/darker", { scene }, query, signal),
  /** The operator's basemap; without tiles where there is none. */
  basemap: (signal: AbortSignal) => get("/api/v1/basemap", {}, {}, signal),
  /** The lights that do most to a sky. */
  influences: (scene: string, query: InfluenceQuery, limit: number, signal: AbortSignal) =>
    get("/api/v1/scenes/{scene}/influence.json", { scene }, { ...query, limit }, signal),
  /** How long the nights of a month are dark. */
  nights: ({ lat, lon }: Pick<SkyParameters, "lat" | "lon">, month: string, signal: AbortSignal) =>
    get("/api/v1/nights", {}, { lat, lon, month }, signal),
  /** A picture at an address of the API. */
  picture: async (url: string, signal: AbortSignal): Promise<Blob> => (await answered(url, { signal })).blob(),
  /** Finds what to dim. */
  findPlan: (scene: string, query: PlanQuery, body: PlanBody, signal: AbortSignal) =>
    post("/api/v1/scenes/{scene}/plans", { scene }, query, body, signal),
  /** Keeps what was painted. */
  storeScenario: (scene: string, body: ScenarioBody, signal: AbortSignal) =>
    post("/api/v1/scenes/{scene}/scenarios", { scene }, {}, body, signal),
  plan: (plan: string, limit: number, signal: AbortSignal) => get("/api/v1/plans/{plan}", { plan }, { limit }, signal),
  scenario: (scenario: string, signal: AbortSignal) => get("/api/v1/scenarios/{scenario}", { scenario }, {}, signal),
  /** The description of a layer, once it is computed. */
  layer: async (scene: string, layer: string, query: LayerQuery, signal: AbortSignal, progress: (part: number) => void) => {
    for (let waitedS = 0; ; waitedS += LAYER_WAIT_S) {
      const description = await get("/api/v1/scenes/{scene}/tiles/{layer}/tilejson.json", { scene, layer }, query, signal);
      if (description.ready || waitedS > MAX_LAYER_WAIT_S) return description;
      if (description.progress != null) progress(description.progress);
      await pause(LAYER_WAIT_S, signal);
    }
  },
};
