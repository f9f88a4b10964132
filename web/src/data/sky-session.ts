// From a picked place to its sky: site, then numbers, then picture. A newer pick cancels an older one.

import { api, type SkyParameters } from "../api/client.ts";
import { isWithoutAnswer } from "../api/problem.ts";
import { isOfLight } from "../sky/colour-maps.ts";
import { SkyGrid } from "../sky/grid.ts";
import { type AppState, baseOf, besideScene, CONDITIONS, sceneOf, withCloudPattern } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { requestsOf, type SkyRequests } from "./sky-requests.ts";

const NO_SKY = {
  skyStage: "none",
  site: null,
  answer: null,
  comparison: null,
  besideAnswer: null,
  panorama: null,
  panoramaToday: null,
} as const;

function siteKey(scene: string, { lat, lon }: SkyParameters): string {
  return JSON.stringify([scene, lat, lon]);
}

export class SkySession {
  private controller = new AbortController();
  private requested = "";
  private requestedSite = "";

  constructor(private readonly store: AppStore) {
    const inLight = ({ colours }: Readonly<AppState>) => isOfLight(colours);
    store.watch([sceneOf, besideScene, baseOf, "place", "time", "isAway", inLight, ...CONDITIONS], (state) => {
      const scene = sceneOf(state);
      if (scene === null || state.place === null) {
        this.cancel();
        return;
      }
      const requests = requestsOf(state, scene.id, state.place);
      if (state.isAway) this.wait(scene.id, requests);
      else void this.load(scene.id, requests);
    });
  }

  /** Requests a sky, and what it is compared with, unless these are the last requests. */
  private async load(scene: string, requests: SkyRequests): Promise<void> {
    const { shown, beside, compared } = requests;
    const requested = JSON.stringify([scene, requests]);
    if (requested === this.requested) return;
    this.restart();
    const { signal } = this.controller;
    this.requested = requested;
    const requestedSite = siteKey(scene, shown);
    performance.clearMarks("sky:asked");
    performance.mark("sky:asked");
    this.store.set({ isBusy: true });
    try {
      // Both at once: the numbers do not wait for the place's name.
      const site = requestedSite === this.requestedSite ? null : api.site(scene, shown, signal);
      const sky = api.sky(scene, shown, signal);
      // What fails is told once, by whoever waits for it first.
      sky.catch(() => undefined);
      if (site !== null) {
        this.store.set({ ...NO_SKY, site: await site, skyStage: "site" });
        this.requestedSite = requestedSite;
        performance.measure("sky:site", "sky:asked");
      }
      const answer = await sky;
      this.store.set({ answer, skyStage: "numbers" });
      performance.measure("sky:numbers", "sky:asked");
      const both = [{ scene, query: shown }, ...(beside === null ? [] : [beside])];
      // What is shown is one of those that are compared, or the lights of today that both differ from.
      const compare = (query: SkyParameters) => (query.scenario === shown.scenario ? answer : api.sky(scene, query, signal));
      const [answers, before, after, besideAnswer] = await Promise.all([
        Promise.all(both.map((each) => api.panorama(each.scene, withCloudPattern(each.query), signal))),
        compared === null ? null : compare(compared.before),
        compared === null ? null : compare(compared.after),
        beside === null || beside.scene === scene ? null : api.sky(beside.scene, beside.query, signal),
        // What draws it: whoever is told of a picture then sees one.
        import("../sky/sky-view.ts"),
      ]);
      const comparison = before === null || after === null ? null : { before: before.sky, after: after.sky };
      const [panorama = null, panoramaToday = null] = answers.map((answer) => new SkyGrid(answer));
      this.store.set({ panorama, panoramaToday, comparison, besideAnswer, skyStage: "picture" });
      performance.measure("sky:picture", "sky:asked");
      this.store.set({ isBusy: false });
    } catch (reason) {
      if (signal.aborted) return;
      if (isWithoutAnswer(reason)) {
        this.restart();
        this.requested = "";
        this.store.set({ isBusy: false });
        this.store.report(reason);
        return;
      }
      // Asking for the same again is then a new try.
      this.cancel();
      this.store.report(reason);
    }
  }

  /** Until the server is back, the sky of the same place stays; that of another one goes. */
  private wait(scene: string, { shown }: SkyRequests): void {
    if (siteKey(scene, shown) !== this.requestedSite) this.cancel();
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
