// What lights are to go: the least for a goal, or those of most influence. The sliders of the second work as they move.

import type { Plan } from "../api/types.ts";
import { words } from "../language/words.ts";
import { PLAN_MEASURES, type PlanMethod, type PlanRequest } from "../planning.ts";
import type { Region } from "../sky/region.ts";
import { byId, debounced } from "./dom.ts";
import { decimal } from "./format.ts";
import { wireGroup } from "./group.ts";
import { setRegionOption } from "./marking.ts";

export interface WishEvents {
  /** A plan is wanted; without `keep` it is one of many that are only tried. */
  wished: (wish: PlanRequest, keep: boolean) => void;
}

/** A slider at rest for this long is tried. */
const TRIED_AFTER_MS = 120;

export class WishForm {
  private readonly reduction = byId("plan-reduction", HTMLInputElement);
  private readonly cut = byId("plan-cut", HTMLInputElement);
  private readonly least = byId("plan-least", HTMLInputElement);
  private readonly most = byId("plan-most", HTMLInputElement);
  private readonly gamma = byId("plan-gamma", HTMLInputElement);
  private readonly measure = byId("plan-measure", HTMLSelectElement);
  private readonly find = byId("plan-find", HTMLButtonElement);
  private readonly pressMethod: (method: PlanMethod) => void;
  private readonly trySoon: ReturnType<typeof debounced<[]>>;
  private method: PlanMethod = "target";
  private region: Region | null = null;

  constructor(events: WishEvents) {
    this.trySoon = debounced(TRIED_AFTER_MS, () => events.wished(this.wish(), false));
    const moved = () => {
      this.showValues();
      if (this.method === "threshold") this.trySoon();
    };
    this.pressMethod = wireGroup<PlanMethod>("plan-method", (method) => {
      this.rest();
      this.setMethod(method);
    });
    for (const slider of [this.reduction, this.cut, this.gamma]) slider.addEventListener("input", moved);
    // Neither goes past the other.
    this.least.addEventListener("input", () => {
      if (Number(this.most.value) < Number(this.least.value)) this.most.value = this.least.value;
      moved();
    });
    this.most.addEventListener("input", () => {
      if (Number(this.least.value) > Number(this.most.value)) this.least.value = this.most.value;
      moved();
    });
    this.measure.addEventListener("change", moved);
    this.find.addEventListener("click", () => {
      this.rest();
      events.wished(this.wish(), true);
    });
    this.pressMethod(this.method);
    this.setMethod(this.method);
  }

  /** The part of the sky that is marked, which a wish may be about. */
  setRegion(region: Region | null): void {
    this.region = region;
    setRegionOption(this.measure, region !== null);
  }

  /** What a slider was about to ask for is no longer wanted. */
  rest(): void {
    this.trySoon.cancel();
  }

  /** Whether the sky follows the sliders. */
  isLive(): boolean {
    return this.method === "threshold";
  }

  searching(on: boolean): void {
    // Sliders go on while the last of their plans is on its way.
    this.find.disabled = on && this.method === "target";
  }

  /** The wish that a plan was found for, after a reload too. */
  show(plan: Plan): void {
    const [site] = plan.sites;
    if (site === undefined) return;
    if (plan.method === "threshold") {
      // Thresholds in the measure's unit have no place on sliders of percentiles.
      const percents = plan.threshold_levels?.map((level) => (level.startsWith("p") ? Number(level.slice(1)) : NaN)) ?? [];
      const [least = NaN, most = NaN] = percents;
      if (least <= 100 && most <= 100) [this.least.value, this.most.value] = [String(least), String(most)];
      this.gamma.value = String(Math.round(100 * (plan.gamma ?? 1)));
      this.setMethod("threshold");
    } else {
      const wanted = site.target?.wanted;
      if (wanted === undefined || site.before <= 0) return;
      this.reduction.value = String(Math.round(100 * (1 - wanted / site.before)));
      this.cut.value = String(Math.round(100 * (plan.max_cut ?? 1)));
      this.setMethod("target");
    }
    this.pressMethod(this.method);
    if ([...this.measure.options].some(({ value, disabled }) => value === site.measure && !disabled))
      this.measure.value = site.measure;
    this.showValues();
  }

  private wish(): PlanRequest {
    const measure = PLAN_MEASURES.find((name) => name === this.measure.value) ?? "zenith";
    const about = { measure, region: this.region };
    if (this.method === "target")
      return { ...about, method: "target", reduceBy: Number(this.reduction.value) / 100, maxCut: Number(this.cut.value) / 100 };
    return {
      ...about,
      method: "threshold",
      lowerPercentile: Number(this.least.value),
      upperPercentile: Number(this.most.value),
      gamma: Number(this.gamma.value) / 100,
    };
  }

  private setMethod(method: PlanMethod): void {
    this.method = method;
    byId("plan-target", HTMLElement).hidden = method !== "target";
    byId("plan-threshold", HTMLElement).hidden = method !== "threshold";
    const norm = [...this.measure.options].find(({ value }) => value === "norm");
    if (norm !== undefined) {
      norm.hidden = norm.disabled = method === "target";
      if (norm.disabled && this.measure.value === "norm") this.measure.value = "zenith";
    }
    const { lead, leadThreshold, find, findThreshold } = words().plan;
    byId("plan-lead", HTMLElement).textContent = method === "target" ? lead : leadThreshold;
    this.find.textContent = method === "target" ? find : findThreshold;
    this.showValues();
  }

  private showValues(): void {
    for (const slider of [this.reduction, this.cut, this.least, this.most, this.gamma]) {
      const value = decimal(slider.value);
      byId(`${slider.id}-value`, HTMLOutputElement).value = `${value} %`;
      slider.setAttribute("aria-valuetext", words().plan.percent(value));
    }
  }
}
