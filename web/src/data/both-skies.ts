// A sky before and after a change, seen by one eye: one that adapts to each would see them alike.

import { api, type SkyParameters } from "../api/client.ts";
import type { SkyAnswer } from "../api/types.ts";
import { SkyGrid } from "../sky/grid.ts";
import { adaptationOf } from "../sky/shading.ts";
import { type AppState, landCdM2Of, withCloudPattern } from "../state/app-state.ts";

/** What the eye is adapted to: the sky of today, unless it is kept; null where no eye sees the pictures. */
export async function eyeOfBoth(
  scene: string,
  { parameters, answer }: { parameters: SkyParameters; answer: Promise<SkyAnswer> },
  state: Readonly<AppState>,
  signal: AbortSignal,
): Promise<number | null> {
  if (state.colours !== "eye") return null;
  const [today, panorama] = await Promise.all([answer, api.panorama(scene, withCloudPattern(parameters), signal)]);
  return +adaptationOf(new SkyGrid(panorama), state, landCdM2Of({ ...state, answer: today })).toPrecision(3);
}
