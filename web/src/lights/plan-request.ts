// Requests for reduction plans, and the changes of the lights that result.

import type { PlanBody } from "../api/schema.ts";
import type { Plan, Scenario } from "../api/types.ts";
import type { Region } from "../sky/region.ts";
import type { Place } from "../state/view-state.ts";

export const PLAN_MEASURES = ["zenith", "mean", "horizontal", "norm", "region"] as const;
export type PlanMeasure = (typeof PLAN_MEASURES)[number];

/** The least light to remove for a target. */
interface TargetRequest {
  method: "target";
  /** Relative reduction of the measure, 0 to 1. */
  reduceBy: number;
  /** Largest part of a light that may be removed, 0 to 1. */
  maxCut: number;
}

/** The lights above thresholds of influence (q_a, q_b as percentiles of the lit pixels). */
interface ThresholdRequest {
  method: "threshold";
  /** Pixels below this percentile of influence are left alone. */
  lowerPercentile: number;
  /** Pixels above this percentile are dimmed in full, those between in part. */
  upperPercentile: number;
  /** The part of their light that is removed in full dimming, 0 to 1. */
  gamma: number;
}

/** What a plan is to reach. */
export type PlanRequest = (TargetRequest | ThresholdRequest) & {
  measure: PlanMeasure;
  /** The part of the sky that the measure `region` is of. */
  region: Region | null;
};
export type PlanMethod = PlanRequest["method"];

export function planBody(request: PlanRequest, { latitude_deg, longitude_deg }: Place): PlanBody {
  const { measure, region } = request;
  const curve =
    measure !== "region" || region === null
      ? {}
      : { region: region.map(({ azimuthDeg, elevationDeg }): [number, number] => [azimuthDeg, elevationDeg]) };
  const place = { lat: latitude_deg, lon: longitude_deg };
  if (request.method === "target")
    return {
      method: request.method,
      max_cut: request.maxCut,
      sites: [{ ...place, measure, reduce_by: request.reduceBy, ...curve }],
    };
  return {
    method: request.method,
    site: place,
    measure,
    q_a: `p${request.lowerPercentile}`,
    q_b: `p${request.upperPercentile}`,
    gamma: request.gamma,
    ...curve,
  };
}

/** What changes the lights: a plan found by the server, or edits that somebody painted. */
export type Change = { kind: "plan"; plan: Plan } | { kind: "scenario"; scenario: Scenario };

/** Number of dimmed pixels that are listed, by effect. */
export const LISTED_PIXELS = 5000;

export function idOf(change: Change): string {
  return change.kind === "plan" ? change.plan.id : change.scenario.id;
}
