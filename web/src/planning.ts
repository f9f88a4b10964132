// The change of lights that the state names: a plan is looked for, or fetched again after a reload.

import { api, type PlanQuery } from "./api/client.ts";
import type { Plan, Scenario } from "./api/types.ts";
import type { Region } from "./sky/region.ts";
import type { Place } from "./state.ts";

export const PLAN_MEASURES = ["zenith", "mean", "horizontal", "region"] as const;
export type PlanMeasure = (typeof PLAN_MEASURES)[number];

/** What a plan is to reach. */
export interface PlanWish {
  measure: PlanMeasure;
  /** By this part of what it is, 0 to 1. */
  reduce_by: number;
  /** The largest part of a light that may go, 0 to 1. */
  max_cut: number;
  /** The part of the sky that the measure `region` is of. */
  region: Region | null;
}

/** What changes the lights: a plan found by the server, or edits that somebody painted. */
export type Change = { kind: "plan"; plan: Plan } | { kind: "scenario"; scenario: Scenario };

/** As many of the dimmed pixels are listed, the ones with the most effect first. */
export const LISTED_PIXELS = 5000;

export interface PlanningEvents {
  searching: () => void;
  found: (change: Change) => void;
  failed: (reason: unknown) => void;
}

export class Planning {
  private controller = new AbortController();
  private known: Change | null = null;
  private asked: string | null = null;
  private searching = false;

  constructor(private readonly events: PlanningEvents) {}

  /** Looks for the least light whose loss makes a place's sky as dark as wished. */
  async find(scene: string, place: Place, conditions: Omit<PlanQuery, "limit">, { measure, reduce_by, max_cut, region }: PlanWish): Promise<void> {
    const curve = measure !== "region" || region === null ? {} : { region: region.map(({ azimuth_deg, elevation_deg }): [number, number] => [azimuth_deg, elevation_deg]) };
    const site = { lat: place.latitude_deg, lon: place.longitude_deg, measure, reduce_by, ...curve };
    const body = { method: "target", max_cut, sites: [site] };
    await this.settle(null, async (signal) => ({
      kind: "plan",
      plan: await api.find_plan(scene, { ...conditions, limit: LISTED_PIXELS }, body, signal),
    }));
  }

  /** Fetches a change unless it is the one that is known or on its way. */
  async show(id: string): Promise<void> {
    if (id === this.asked || (this.known !== null && id === id_of(this.known))) return;
    await this.settle(id, async (signal) =>
      id.startsWith("p-")
        ? { kind: "plan", plan: await api.plan(id, LISTED_PIXELS, signal) }
        : { kind: "scenario", scenario: await api.scenario(id, signal) },
    );
  }

  /** Takes a change that was asked for elsewhere. */
  adopt(change: Change): void {
    this.cancel();
    this.known = change;
  }

  /** Forgets the change; answers still on their way are dropped. */
  cancel(): void {
    this.controller.abort();
    this.controller = new AbortController();
    this.known = null;
    this.asked = null;
    this.searching = false;
  }

  private async settle(id: string | null, ask: (signal: AbortSignal) => Promise<Change>): Promise<void> {
    const before = this.known;
    this.cancel();
    const { signal } = this.controller;
    this.asked = id;
    this.searching = true;
    this.events.searching();
    try {
      const found = await ask(signal);
      this.known = found;
      this.asked = null;
      this.searching = false;
      this.events.found(found);
    } catch (reason) {
      if (signal.aborted) return;
      // A search that fails loses nothing: what was found before is still there.
      this.known = id === null ? before : null;
      this.asked = null;
      this.searching = false;
      this.events.failed(reason);
    }
  }

  is_searching(): boolean {
    return this.searching;
  }

  /** What is known of the change. */
  change(): Change | null {
    return this.known;
  }
}

export function id_of(change: Change): string {
  return change.kind === "plan" ? change.plan.id : change.scenario.id;
}
