// What a plan is asked to reach, and what then changes the lights.

import type { PlanBody } from "../api/schema.ts";
import type { Plan, Scenario } from "../api/types.ts";
import type { Region } from "../sky/region.ts";
import type { Place } from "../state/view-state.ts";

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

/** As many of the dimmed pixels are listed, the ones with the most effect first. */
export const LISTED_PIXELS = 5000;

export function idOf(change: Change): string {
  return change.kind === "plan" ? change.plan.id : change.scenario.id;
}
