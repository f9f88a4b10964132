// What changes the lights: a plan is looked for, and what the state names is fetched again after a reload.

import { api, type PlanQuery } from "./api/client.ts";
import type { PlanBody } from "./api/schema.ts";
import type { Plan, Scenario } from "./api/types.ts";
import type { Region } from "./sky/region.ts";
import type { Place } from "./state.ts";

export const PLAN_MEASURES = ["zenith", "mean", "horizontal", "norm", "region"] as const;
export type PlanMeasure = (typeof PLAN_MEASURES)[number];

/** The least light for a goal. */
interface TargetRequest {
  method: "target";
  /** By this part of what it is, 0 to 1. */
  reduceBy: number;
  /** The largest part of a light that may go, 0 to 1. */
  maxCut: number;
}

/** The lights of most influence (q_a, q_b as percentiles of the lit pixels). */
interface ThresholdRequest {
  method: "threshold";
  /** So many percent of the pixels, those of least influence, are left alone. */
  lowerPercentile: number;
  /** Those above so many percent lose the most, those between less. */
  upperPercentile: number;
  /** The part that those lose, 0 to 1. */
  gamma: number;
}

/** What a plan is to reach. */
export type PlanRequest = (TargetRequest | ThresholdRequest) & {
  measure: PlanMeasure;
  /** The part of the sky that the measure `region` is of. */
  region: Region | null;
};
export type PlanMethod = PlanRequest["method"];

function bodyOf(wish: PlanRequest, { latitude_deg, longitude_deg }: Place): PlanBody {
  const { measure, region } = wish;
  const curve =
    measure !== "region" || region === null
      ? {}
      : { region: region.map(({ azimuthDeg, elevationDeg }): [number, number] => [azimuthDeg, elevationDeg]) };
  const place = { lat: latitude_deg, lon: longitude_deg };
  if (wish.method === "target")
    return { method: wish.method, max_cut: wish.maxCut, sites: [{ ...place, measure, reduce_by: wish.reduceBy, ...curve }] };
  return {
    method: wish.method,
    site: place,
    measure,
    q_a: `p${wish.lowerPercentile}`,
    q_b: `p${wish.upperPercentile}`,
    gamma: wish.gamma,
    ...curve,
  };
}

/** What changes the lights: a plan found by the server, or edits that somebody painted. */
export type Change = { kind: "plan"; plan: Plan } | { kind: "scenario"; scenario: Scenario };

/** As many of the dimmed pixels are listed, the ones with the most effect first. */
export const LISTED_PIXELS = 5000;

export interface PlanningEvents {
  /** A plan is looked for, or no longer. */
  searching: (on: boolean) => void;
  /** A plan was looked for and found; one that is only tried comes with what keeps it. */
  found: (change: Change, keep: (() => Promise<unknown>) | null) => void;
  /** What the state names is there. */
  loaded: (change: Change) => void;
  failed: (reason: unknown, what: "search" | "load") => void;
}

export class Planning {
  private known: Change | null = null;
  private loading: { id: string; controller: AbortController } | null = null;
  private search: AbortController | null = null;

  constructor(private readonly events: PlanningEvents) {}

  /** Looks for what a wish takes from the lights of a place's sky. What is known stays until it is found. */
  async find(
    scene: string,
    place: Place,
    conditions: Omit<PlanQuery, "limit" | "keep">,
    wish: PlanRequest,
    isStored: boolean,
  ): Promise<void> {
    const body = bodyOf(wish, place);
    this.search?.abort();
    const search = new AbortController();
    this.search = search;
    this.events.searching(true);
    try {
      const plan = await api.findPlan(
        scene,
        { ...conditions, limit: LISTED_PIXELS, keep: isStored ? "on" : "off" },
        body,
        search.signal,
      );
      this.endSearch();
      this.adopt({ kind: "plan", plan });
      const keep = () => api.findPlan(scene, { ...conditions, limit: 0, keep: "on" }, body, new AbortController().signal);
      this.events.found({ kind: "plan", plan }, isStored ? null : keep);
    } catch (reason) {
      if (search.signal.aborted) return;
      this.endSearch();
      this.events.failed(reason, "search");
    }
  }

  /** Ends a search: what it was for is no longer so. */
  stopSearch(): void {
    if (this.search === null) return;
    this.search.abort();
    this.endSearch();
  }

  private endSearch(): void {
    this.search = null;
    this.events.searching(false);
  }

  /** Fetches a change unless it is the one that is known or on its way; null forgets it. */
  async show(id: string | null): Promise<void> {
    if (id === this.loading?.id || (this.known !== null && id === idOf(this.known))) return;
    this.loading?.controller.abort();
    this.loading = null;
    this.known = null;
    if (id === null) return;
    const controller = new AbortController();
    const { signal } = controller;
    this.loading = { id, controller };
    try {
      const change: Change = id.startsWith("p-")
        ? { kind: "plan", plan: await api.plan(id, LISTED_PIXELS, signal) }
        : { kind: "scenario", scenario: await api.scenario(id, signal) };
      if (signal.aborted) return;
      this.loading = null;
      this.known = change;
      this.events.loaded(change);
    } catch (reason) {
      if (signal.aborted) return;
      // Asked for again, it is a new try.
      this.loading = null;
      this.events.failed(reason, "load");
    }
  }

  /** Takes a change that was asked for elsewhere. */
  adopt(change: Change): void {
    this.loading?.controller.abort();
    this.loading = null;
    this.known = change;
  }

  /** What is known of the change. */
  change(): Change | null {
    return this.known;
  }
}

export function idOf(change: Change): string {
  return change.kind === "plan" ? change.plan.id : change.scenario.id;
}
