// Every URL of the server that the viewer asks for, and how its answers and errors are read.

import { ApiError, problem_from_response } from "./problem.ts";
import type { Atmosphere, NamedPlace, PanoramaAnswer, Scene, Site, SkyAnswer } from "./types.ts";

/** What the sky depends on besides the place. */
export interface SkyParameters {
  latitude_deg: number;
  longitude_deg: number;
  /** null: the server's default. */
  turbidity: number | null;
  lamp: string;
  emission: string;
}

/** How often a busy server (429, 503) is asked again before the viewer gives up. */
const RETRIES = 3;
const LONGEST_WAIT_S = 10;

/** Absolute, so that it also holds inside the map's worker; below a reverse proxy's prefix if there is one. */
function api_url(path: string): string {
  return new URL(`api/v1/${path}`, document.baseURI).href;
}

function scene_url(scene: string, path: string): string {
  return api_url(`scenes/${encodeURIComponent(scene)}/${path}`);
}

function sky_query(parameters: SkyParameters): string {
  const query = new URLSearchParams({
    lat: String(parameters.latitude_deg),
    lon: String(parameters.longitude_deg),
    lamp: parameters.lamp,
    emission: parameters.emission,
  });
  if (parameters.turbidity !== null) query.set("turbidity", String(parameters.turbidity));
  return query.toString();
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

async function get_json<T>(url: string, signal: AbortSignal): Promise<T> {
  for (let attempt = 0; ; attempt++) {
    let response: Response;
    try {
      response = await fetch(url, { signal, headers: { accept: "application/json" } });
    } catch (reason) {
      if (signal.aborted) throw reason;
      throw new ApiError(0, { title: "The server does not answer", detail: "Is it running? Check the connection and try again." });
    }
    if (response.ok) return (await response.json()) as T;
    const busy = response.status === 503 || response.status === 429;
    if (!busy || attempt >= RETRIES) throw new ApiError(response.status, await problem_from_response(response));
    const wait_s = Number(response.headers.get("retry-after") ?? NaN);
    await pause(Math.min(Number.isFinite(wait_s) ? Math.max(wait_s, 0.2) : 1, LONGEST_WAIT_S), signal);
  }
}

export const api = {
  scenes: (signal: AbortSignal) => get_json<Scene[]>(api_url("scenes"), signal),
  places: (scene: string, signal: AbortSignal) => get_json<NamedPlace[]>(scene_url(scene, "places"), signal),
  atmospheres: (signal: AbortSignal) => get_json<Atmosphere[]>(api_url("atmospheres"), signal),
  site: (scene: string, parameters: SkyParameters, signal: AbortSignal) => {
    const query = new URLSearchParams({ lat: String(parameters.latitude_deg), lon: String(parameters.longitude_deg) });
    return get_json<Site>(scene_url(scene, `site?${query.toString()}`), signal);
  },
  sky: (scene: string, parameters: SkyParameters, signal: AbortSignal) =>
    get_json<SkyAnswer>(scene_url(scene, `sky?${sky_query(parameters)}`), signal),
  panorama: (scene: string, parameters: SkyParameters, signal: AbortSignal) =>
    get_json<PanoramaAnswer>(scene_url(scene, `panorama.json?${sky_query(parameters)}`), signal),
  /** For links and downloads. */
  panorama_url: (scene: string, parameters: SkyParameters, extension: "json" | "png" | "exr" | "tif", more = "") =>
    scene_url(scene, `panorama.${extension}?${sky_query(parameters)}${more}`),
  tilejson_url: (scene: string, layer: string) => scene_url(scene, `tiles/${layer}/tilejson.json`),
  docs_url: () => new URL("api/docs", document.baseURI).href,
};
