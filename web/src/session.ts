// From a picked place to its sky: site, then numbers, then picture. A newer pick cancels an older one.

import { api, type SkyParameters } from "./api/client.ts";
import type { Site, SkyAnswer } from "./api/types.ts";
import { SkyGrid } from "./sky/grid.ts";

export interface SessionEvents {
  started: () => void;
  site: (site: Site) => void;
  numbers: (answer: SkyAnswer) => void;
  /** And the sky of the same place to compare it with, where one was asked for. */
  picture: (grid: SkyGrid, other: SkyGrid | null) => void;
  failed: (reason: unknown) => void;
  ended: () => void;
}

export class SkySession {
  private controller = new AbortController();
  private asked = "";
  private siteAsked = "";

  constructor(private readonly events: SessionEvents) {}

  /** Asks for a sky, and for another to compare it with, unless they are the ones already asked for. */
  async show(scene: string, parameters: SkyParameters, other: SkyParameters | null = null): Promise<void> {
    const asked = JSON.stringify([scene, parameters, other]);
    if (asked === this.asked) return;
    this.restart();
    const { signal } = this.controller;
    this.asked = asked;
    const siteAsked = JSON.stringify([scene, parameters.lat, parameters.lon]);
    performance.clearMarks("sky:asked");
    performance.mark("sky:asked");
    this.events.started();
    try {
      if (siteAsked !== this.siteAsked) {
        this.events.site(await api.site(scene, parameters, signal));
        this.siteAsked = siteAsked;
        performance.measure("sky:site", "sky:asked");
      }
      this.events.numbers(await api.sky(scene, parameters, signal));
      performance.measure("sky:numbers", "sky:asked");
      const both = [parameters, ...(other === null ? [] : [other])].map((asked) => api.panorama(scene, asked, signal));
      const [grid, compared] = (await Promise.all(both)).map((answer) => new SkyGrid(answer));
      if (grid !== undefined) this.events.picture(grid, compared ?? null);
      performance.measure("sky:picture", "sky:asked");
      this.events.ended();
    } catch (reason) {
      if (signal.aborted) return;
      // Asking for the same again is then a new try.
      this.asked = "";
      this.siteAsked = "";
      this.events.failed(reason);
      this.events.ended();
    }
  }

  /** Forgets what was asked; answers still on their way are dropped. */
  cancel(): void {
    this.restart();
    this.asked = "";
    this.siteAsked = "";
  }

  private restart(): void {
    this.controller.abort();
    this.controller = new AbortController();
  }
}
