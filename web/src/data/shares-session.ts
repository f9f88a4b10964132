// Whose light the sky is: asked for once the sky itself is shown, for where a place is new it takes seconds.

import { type AreaSharesQuery, api, type SharesQuery } from "../api/client.ts";
import { isWithoutAnswer } from "../api/problem.ts";
import { placeWords } from "../language/words.ts";
import { type AppState, areaSharesQuery, CONDITIONS, sceneOf, sharesQuery } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { debounced } from "../ui/dom.ts";
import { type Areas, refusalOf } from "./areas.ts";

/** Towns that are asked for; the rest are summed up. */
export const LISTED_TOWNS = 12;
/** A sky that is shown for this long is looked at. */
const WAIT_MS = 250;

export class SharesSession {
  private controller = new AbortController();
  private requested = "";
  private requestedAreas: Areas | null = null;
  /** Of what is shown: another place's shares go at once. */
  private placeKey = "";

  constructor(private readonly store: AppStore) {
    const loadSoon = debounced(WAIT_MS, () => void this.load());
    const parts = [
      sceneOf,
      "place",
      "isAway",
      "skyStage",
      "isBusy",
      "isTrying",
      "region",
      "isOnGround",
      "areas",
      ...CONDITIONS,
    ] as const;
    store.watch(parts, (state) => {
      if (JSON.stringify(requestOf(state)) === this.requested && state.areas === this.requestedAreas) return;
      this.forget(JSON.stringify([sceneOf(state)?.id, state.place, state.region, state.isOnGround]));
      loadSoon();
    });
  }

  /** Ends what is under way. What is shown stays while only the air or the lights are others. */
  private forget(placeKey: string): void {
    this.controller.abort();
    this.requested = "";
    if (placeKey === this.placeKey) return;
    this.placeKey = placeKey;
    const { shares, areaShares, isSharing } = this.store.state;
    if (shares !== null || areaShares !== null || isSharing)
      this.store.set({ shares: null, areaShares: null, isSharing: false, shownTown: null });
  }

  private async load(): Promise<void> {
    const { state } = this.store;
    const request = requestOf(state);
    if (request === null || state.skyStage !== "picture" || state.isBusy || state.isTrying || state.isAway) return;
    const { areas } = state;
    this.requested = JSON.stringify(request);
    this.requestedAreas = areas;
    this.controller = new AbortController();
    const { signal } = this.controller;
    const { scene, query } = request;
    this.store.set({ isSharing: true });
    try {
      const [shares, areaShares] = await Promise.all([
        api.shares(scene, { ...query, limit: LISTED_TOWNS }, signal),
        areas === null || state.place === null
          ? null
          : this.areaShares(scene, areaSharesQuery(state, state.place, areas), areas, signal),
      ]);
      if (signal.aborted) return;
      this.store.set({ shares, areaShares, isSharing: false });
    } catch (reason) {
      if (signal.aborted) return;
      this.store.set({ shares: null, areaShares: null, isSharing: false });
      this.requested = isWithoutAnswer(reason) ? "" : this.requested;
      this.store.report(reason);
    }
  }

  /** Areas that the server cannot read are told once and forgotten; towns are shown all the same. */
  private async areaShares(scene: string, query: AreaSharesQuery, areas: Areas, signal: AbortSignal) {
    try {
      return await api.areaShares(scene, query, areas.body, signal);
    } catch (reason) {
      if (signal.aborted || isWithoutAnswer(reason)) throw reason;
      const refusal = refusalOf(reason);
      if (refusal !== null) {
        this.requestedAreas = null;
        this.store.set({ areas: null });
      }
      const { outsideScene, swapped } = placeWords().shares;
      const words = { outside: outsideScene, swapped, unreadable: null }[refusal ?? "unreadable"];
      this.store.report(words === null ? reason : new Error(words(areas.fileName)));
      return null;
    }
  }
}

function requestOf(state: Readonly<AppState>): { scene: string; query: SharesQuery } | null {
  const scene = sceneOf(state);
  return scene === null || state.place === null ? null : { scene: scene.id, query: sharesQuery(state, state.place) };
}
