// How the viewer asks the server: paths, parameters and answers are those of the OpenAPI document.

import { ApiError, problem_from_response } from "./problem.ts";
import type { Gets } from "./schema.ts";

type Path = keyof Gets;
type PathValues<P extends Path> = Gets[P]["path"];
type Query<P extends Path> = Gets[P]["query"];

/** What the sky depends on besides the scene. */
export type SkyParameters = Pick<Query<"/api/v1/scenes/{scene}/sky">, "lat" | "lon" | "turbidity" | "scattering" | "clouds" | "lamp" | "emission">;
export type ScatteringName = NonNullable<SkyParameters["scattering"]>;

/** How often a busy server (429, 503) is asked again before the viewer gives up. */
const RETRIES = 3;
const LONGEST_WAIT_S = 10;

/** Absolute, so that it also holds inside the map's worker; below a reverse proxy's prefix if there is one. */
export function url_of<P extends Path>(path: P, values: PathValues<P>, query: Query<P>): string {
  const filled = path.replace(/\{(\w+)\}/g, (_, name: string) => encodeURIComponent(String((values as Record<string, unknown>)[name])));
  const url = new URL(filled.slice(1), document.baseURI);
  url.hash = "";
  for (const [name, value] of Object.entries(query)) if (value !== undefined && value !== null) url.searchParams.set(name, String(value));
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

async function get<P extends Path>(path: P, values: PathValues<P>, query: Query<P>, signal: AbortSignal): Promise<Gets[P]["answer"]> {
  for (let attempt = 0; ; attempt++) {
    let response: Response;
    try {
      response = await fetch(url_of(path, values, query), { signal, headers: { accept: "application/json" } });
    } catch (reason) {
      if (signal.aborted) throw reason;
      throw new ApiError(0, { title: "The server does not answer", detail: "Is it running? Check the connection and try again." });
    }
    if (response.ok) return (await response.json()) as Gets[P]["answer"];
    const busy = response.status === 503 || response.status === 429;
    if (!busy || attempt >= RETRIES) throw new ApiError(response.status, await problem_from_response(response));
    const wait_s = Number(response.headers.get("retry-after") ?? NaN);
    await pause(Math.min(Number.isFinite(wait_s) ? Math.max(wait_s, 0.2) : 1, LONGEST_WAIT_S), signal);
  }
}

export const api = {
  scenes: (signal: AbortSignal) => get("/api/v1/scenes", {}, {}, signal),
  places: (scene: string, signal: AbortSignal) => get("/api/v1/scenes/{scene}/places", { scene }, {}, signal),
  atmospheres: (signal: AbortSignal) => get("/api/v1/atmospheres", {}, {}, signal),
  site: (scene: string, { lat, lon }: SkyParameters, signal: AbortSignal) =>
    get("/api/v1/scenes/{scene}/site", { scene }, { lat, lon }, signal),
  sky: (scene: string, parameters: SkyParameters, signal: AbortSignal) =>
    get("/api/v1/scenes/{scene}/sky", { scene }, parameters, signal),
  panorama: (scene: string, parameters: SkyParameters, signal: AbortSignal) =>
    get("/api/v1/scenes/{scene}/panorama.json", { scene }, parameters, signal),
};
