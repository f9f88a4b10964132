// What a report says: the sky of today, and of changed lights beside it. It asks for itself what the page may not show.

import { api, type SkyParameters } from "../api/client.ts";
import type { AreaShares, Scene, Shares, SkyAnswer } from "../api/types.ts";
import { LISTED_TOWNS } from "../data/shares-session.ts";
import { isOfLight } from "../sky/colour-maps.ts";
import { type AppState, coordinatesOf, sceneOf, sharesQuery, skyConditions } from "../state/app-state.ts";
import type { Place } from "../state/view-state.ts";
import { pictureUrl } from "../ui/picture-url.ts";

/** For paper: 180 mm wide, some 300 dots an inch. */
const PICTURE_WIDTH_PX = 2048;

/** A sky with the addresses of its pictures. */
export interface ReportedSky {
  answer: SkyAnswer;
  /** As high as this. */
  pictureUrl: (heightPx: number) => string;
}

export interface ReportData {
  place: Place;
  scene: Scene;
  today: ReportedSky;
  /** With the lights of the plan or scenario that the page shows. */
  after: ReportedSky | null;
  /** Of today's light overhead, by town. */
  shares: Shares;
  /** The same by the areas of a file. */
  areas: { fileName: string; shares: AreaShares } | null;
}

/** The request for what a report of this state says; null without a place. */
export function reportRequest(state: Readonly<AppState>): { scene: Scene; place: Place; today: SkyParameters } | null {
  const { place } = state;
  const scene = sceneOf(state);
  if (place === null || scene === null) return null;
  const { scenario: _, ...today } = { ...coordinatesOf(place), ...skyConditions(state) };
  return { scene, place, today };
}

export async function loadReport(state: Readonly<AppState>, signal: AbortSignal): Promise<ReportData | null> {
  const request = reportRequest(state);
  if (request === null) return null;
  const { scene, place, today } = request;
  // All around, whatever the page looks at. Colours of a scale need their legend; those of light say what they are.
  const look = { ...state, projection: "equirectangular" } as const;
  const legend = isOfLight(state.colours) ? "off" : "on";
  const sky = async (parameters: SkyParameters): Promise<ReportedSky> => ({
    answer: await api.sky(scene.id, parameters, signal),
    pictureUrl: (heightPx) => pictureUrl(scene.id, parameters, look, { width: PICTURE_WIDTH_PX, height_px: heightPx, legend }),
  });
  const { scenario: _, ...query } = sharesQuery({ ...state, region: null }, place);
  const { areas, scenario } = state;
  const [before, after, shares, areaShares] = await Promise.all([
    sky(today),
    scenario === null ? null : sky({ ...today, scenario }),
    api.shares(scene.id, { ...query, limit: LISTED_TOWNS }, signal),
    areas === null
      ? null
      : api.areaShares(
          scene.id,
          { ...query, ...(areas.nameField === null ? {} : { name_field: areas.nameField }) },
          areas.body,
          signal,
        ),
  ]);
  return {
    place,
    scene,
    today: before,
    after,
    shares,
    areas: areas === null || areaShares === null ? null : { fileName: areas.fileName, shares: areaShares },
  };
}
