// Darker places around the picked one: looked for while their fold is open, once the sky is shown.

import { api, type DarkerQuery } from "../api/client.ts";
import type { Darker } from "../api/types.ts";
import { type AppState, CONDITIONS, darkerQuery, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import type { Place } from "../state/view-state.ts";

export const WITHIN_KM = 60;
const LISTED_PLACES = 6;
/** A link keeps a place to five decimals. */
const SAME_PLACE_DEG = 2e-5;

export function isSamePlace(a: Place, b: Place): boolean {
  const isNear = (x: number, y: number) => Math.abs(x - y) < SAME_PLACE_DEG;
  return isNear(a.latitude_deg, b.latitude_deg) && isNear(a.longitude_deg, b.longitude_deg);
}

export class DarkerSession {
  private controller = new AbortController();
  private requested = "";
  /** What the answer that is shown depends on besides the place. */
  private shownConditions = "";

  constructor(private readonly store: AppStore) {
    const parts = ["isDarkerOpen", sceneOf, "place", "isAway", "skyStage", "isBusy", "isTrying", ...CONDITIONS] as const;
    store.watch(parts, (state) => this.follow(state));
  }

  private follow(state: Readonly<AppState>): void {
    const { place, darker, isDarkerOpen } = state;
    const scene = sceneOf(state);
    if (scene === null || place === null || !isDarkerOpen) {
      this.forget();
      return;
    }
    const { lat: _lat, lon: _lon, ...conditions } = darkerQuery(state, place);
    const conditionsKey = JSON.stringify([scene.id, conditions]);
    // Who goes to one of them keeps the list.
    const isListed = darker?.places.some((other) => isSamePlace(other, place)) === true;
    if (isListed && conditionsKey === this.shownConditions) return;
    const query = darkerQuery(state, place);
    const request = JSON.stringify([scene.id, query]);
    if (request === this.requested) return;
    this.forget();
    if (state.skyStage !== "picture" || state.isBusy || state.isTrying || state.isAway) return;
    this.requested = request;
    this.shownConditions = conditionsKey;
    void this.load(scene.id, query);
  }

  private forget(): void {
    this.controller.abort();
    this.requested = "";
    if (this.store.state.darker !== null) this.store.set({ darker: null });
  }

  private async load(scene: string, query: DarkerQuery): Promise<void> {
    this.controller = new AbortController();
    const { signal } = this.controller;
    try {
      const darker: Darker = await api.darker(scene, { ...query, within_km: WITHIN_KM, limit: LISTED_PLACES }, signal);
      if (!signal.aborted) this.store.set({ darker });
    } catch (reason) {
      if (signal.aborted) return;
      this.requested = "";
      // Opening it again is a new try.
      this.store.set({ isDarkerOpen: false });
      this.store.report(reason);
    }
  }
}
