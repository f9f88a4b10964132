// Searches for plans, one at a time: a newer one ends the one before.

import { api, type PlanQuery } from "../api/client.ts";
import type { Plan } from "../api/types.ts";
import type { Place } from "../state/view-state.ts";
import { LISTED_PIXELS, type PlanRequest, planBody } from "./plan-request.ts";
import type { StorePlan } from "./plan-trial.ts";

export interface PlanSearchEvents {
  searching: (on: boolean) => void;
  /** A plan that is only tried comes with what stores it. */
  found: (plan: Plan, storePlan: StorePlan | null) => void;
  failed: (reason: unknown) => void;
}

export class PlanSearch {
  private current: AbortController | null = null;

  constructor(private readonly events: PlanSearchEvents) {}

  /** Finds the plan of a request for a place's sky. */
  async find(
    scene: string,
    place: Place,
    conditions: Omit<PlanQuery, "limit" | "keep">,
    request: PlanRequest,
    isStored: boolean,
  ): Promise<void> {
    const body = planBody(request, place);
    this.current?.abort();
    const search = new AbortController();
    this.current = search;
    this.events.searching(true);
    try {
      const query = { ...conditions, limit: LISTED_PIXELS, keep: isStored ? "on" : "off" } as const;
      const plan = await api.findPlan(scene, query, body, search.signal);
      this.end();
      const storePlan = () => api.findPlan(scene, { ...conditions, limit: 0, keep: "on" }, body, new AbortController().signal);
      this.events.found(plan, isStored ? null : storePlan);
    } catch (reason) {
      if (search.signal.aborted) return;
      this.end();
      this.events.failed(reason);
    }
  }

  /** Cancels the search. */
  stop(): void {
    if (this.current === null) return;
    this.current.abort();
    this.end();
  }

  private end(): void {
    this.current = null;
    this.events.searching(false);
  }
}
