// What is asked for of a state's skies: the one that is shown, and those that it is compared with.

import type { SkyParameters } from "../api/client.ts";
import { type AppState, baseOf, besideScene, coordinatesOf, isCompared, skyConditions } from "../state/app-state.ts";
import type { Place } from "../state/view-state.ts";

/** The skies of a state. */
export interface SkyRequests {
  shown: SkyParameters;
  /** Whose picture is shown beside it. */
  beside: { scene: string; query: SkyParameters } | null;
  /** What changed lights change: without and with them, both with what they lie on. Where no time is chosen, a plan has its own. */
  compared: { before: SkyParameters; after: SkyParameters } | null;
}

export function requestsOf(state: Readonly<AppState>, scene: string, place: Place): SkyRequests {
  const shown = { ...coordinatesOf(place), ...skyConditions(state) };
  const { scenario: _, ...today } = shown;
  const isPainted = state.scenario?.startsWith("s-") === true;
  const changed = isPainted || state.time !== null ? state.scenario : null;
  const base = baseOf(state);
  const before = base === null ? today : { ...today, scenario: base };
  return {
    shown,
    beside: isCompared(state) ? { scene: besideScene(state)?.id ?? scene, query: today } : null,
    compared: changed === null ? null : { before, after: { ...today, scenario: changed } },
  };
}
