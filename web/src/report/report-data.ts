// What a report says: the sky of today, and of changed lights beside it. It asks for itself what the page may not show.

import { api, type SkyParameters } from "../api/client.ts";
import type { AreaShares, Scene, Shares, SkyAnswer } from "../api/types.ts";
import { eyeOfBoth } from "../data/both-skies.ts";
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
  /** What the eye is adapted to that sees both; null: there is one sky, or no eye. */
  eye: { adaptationCdM2: number; isKept: boolean } | null;
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
  const { scenario: _, ...query } = sharesQuery({ ...state, region: null, isOnGround: false }, place);
  const { areas, scenario } = state;
  const changed = scenario === null ? null : { ...today, scenario };
  const answer = api.sky(scene.id, today, signal);
  const [before, after, adaptationCdM2, shares, areaShares] = await Promise.all([
    answer,
    changed === null ? null : api.sky(scene.id, changed, signal),
    changed === null ? null : eyeOfBoth(scene.id, { parameters: today, answer }, state, signal),
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
  const eye = adaptationCdM2 === null ? null : { adaptationCdM2, isKept: state.adaptationCdM2 !== null };
  const adapted = eye === null ? {} : { adaptation: eye.adaptationCdM2 };
  const reported = (answer: SkyAnswer, parameters: SkyParameters): ReportedSky => ({
    answer,
    pictureUrl: (heightPx) =>
      pictureUrl(scene.id, parameters, look, { width: PICTURE_WIDTH_PX, height_px: heightPx, legend, ...adapted }),
  });
  return {
    place,
    scene,
    today: reported(before, today),
    after: after === null || changed === null ? null : reported(after, changed),
    eye,
    shares,
    areas: areas === null || areaShares === null ? null : { fileName: areas.fileName, shares: areaShares },
  };
}
