// From a picked place to its sky: site, then numbers, then picture. A newer pick cancels an older one.

import { api, type SkyParameters } from "../api/client.ts";
import { SkyGrid } from "../sky/grid.ts";
import { CONDITIONS, conditionsOf, coordinatesOf, isCompared, sceneOf, todaysConditions } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";

const NO_SKY = { skyStage: "none", site: null, answer: null, panorama: null, panoramaToday: null } as const;

export class SkySession {
  private controller = new AbortController();
  private requested = "";
  private requestedSite = "";

  constructor(private readonly store: AppStore) {
    store.watch([sceneOf, "place", ...CONDITIONS], (state) => {
      const scene = sceneOf(state);
      if (scene === null || state.place === null) {
        this.cancel();
        return;
      }
      const coordinates = coordinatesOf(state.place);
      const today = isCompared(state) ? { ...coordinates, ...todaysConditions(state) } : null;
      void this.load(scene.id, { ...coordinates, ...conditionsOf(state) }, today);
    });
  }

  /** Requests a sky, and today's to compare it with, unless these are the last requests. */
  private async load(scene: string, parameters: SkyParameters, today: SkyParameters | null): Promise<void> {
    const requested = JSON.stringify([scene, parameters, today]);
    if (requested === this.requested) return;
    this.restart();
    const { signal } = this.controller;
    this.requested = requested;
    const requestedSite = JSON.stringify([scene, parameters.lat, parameters.lon]);
    performance.clearMarks("sky:asked");
    performance.mark("sky:asked");
    this.store.set({ isBusy: true });
    try {
      if (requestedSite !== this.requestedSite) {
        this.store.set({ ...NO_SKY, site: await api.site(scene, parameters, signal), skyStage: "site" });
        this.requestedSite = requestedSite;
        performance.measure("sky:site", "sky:asked");
      }
      this.store.set({ answer: await api.sky(scene, parameters, signal), skyStage: "numbers" });
      performance.measure("sky:numbers", "sky:asked");
      const both = today === null ? [parameters] : [parameters, today];
      const answers = await Promise.all(both.map((query) => api.panorama(scene, query, signal)));
      const [panorama = null, panoramaToday = null] = answers.map((answer) => new SkyGrid(answer));
      this.store.set({ panorama, panoramaToday, skyStage: "picture" });
      performance.measure("sky:picture", "sky:asked");
      this.store.set({ isBusy: false });
    } catch (reason) {
      if (signal.aborted) return;
      // Asking for the same again is then a new try.
      this.cancel();
      this.store.report(reason);
    }
  }

  /** Forgets the sky and cancels its requests. */
  private cancel(): void {
    this.restart();
    this.requested = "";
    this.requestedSite = "";
    this.store.set({ ...NO_SKY, isBusy: false });
  }

  private restart(): void {
    this.controller.abort();
    this.controller = new AbortController();
  }
}
