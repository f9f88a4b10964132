// What lights are to go: the least for a goal, or those of most influence. The sliders of the second work as they move.

import type { Plan } from "../api/types.ts";
import { words } from "../language/words.ts";
import { PLAN_MEASURES, type PlanMethod, type PlanWish } from "../planning.ts";
import type { Region } from "../sky/region.ts";
import { by_id, debounced } from "./dom.ts";
import { decimal } from "./format.ts";
import { wire_group } from "./group.ts";
import { set_region_option } from "./marking.ts";

export interface WishEvents {
  /** A plan is wanted; without `keep` it is one of many that are only tried. */
  wished: (wish: PlanWish, keep: boolean) => void;
}

/** A slider at rest for this long is tried. */
const TRIED_AFTER_MS = 120;

export class WishForm {
  private readonly reduction = by_id("plan-reduction", HTMLInputElement);
  private readonly cut = by_id("plan-cut", HTMLInputElement);
  private readonly least = by_id("plan-least", HTMLInputElement);
  private readonly most = by_id("plan-most", HTMLInputElement);
  private readonly gamma = by_id("plan-gamma", HTMLInputElement);
  private readonly measure = by_id("plan-measure", HTMLSelectElement);
  private readonly find = by_id("plan-find", HTMLButtonElement);
  private readonly press_method: (method: PlanMethod) => void;
  private readonly try_soon: ReturnType<typeof debounced<[]>>;
  private method: PlanMethod = "target";
  private region: Region | null = null;

  constructor(events: WishEvents) {
    this.try_soon = debounced(TRIED_AFTER_MS, () => events.wished(this.wish(), false));
    const moved = () => {
      this.show_values();
      if (this.method === "threshold") this.try_soon();
    };
    this.press_method = wire_group<PlanMethod>("plan-method", (method) => {
      this.rest();
      this.set_method(method);
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
    this.press_method(this.method);
    this.set_method(this.method);
  }

  /** The part of the sky that is marked, which a wish may be about. */
  set_region(region: Region | null): void {
    this.region = region;
    set_region_option(this.measure, region !== null);
  }

  /** What a slider was about to ask for is no longer wanted. */
  rest(): void {
    this.try_soon.cancel();
  }

  /** Whether the sky follows the sliders. */
  is_live(): boolean {
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
      this.set_method("threshold");
    } else {
      const wanted = site.target?.wanted;
      if (wanted === undefined || site.before <= 0) return;
      this.reduction.value = String(Math.round(100 * (1 - wanted / site.before)));
      this.cut.value = String(Math.round(100 * (plan.max_cut ?? 1)));
      this.set_method("target");
    }
    this.press_method(this.method);
    if ([...this.measure.options].some(({ value, disabled }) => value === site.measure && !disabled)) this.measure.value = site.measure;
    this.show_values();
  }

  private wish(): PlanWish {
    const measure = PLAN_MEASURES.find((name) => name === this.measure.value) ?? "zenith";
    const about = { measure, region: this.region };
    if (this.method === "target") return { ...about, method: "target", reduce_by: Number(this.reduction.value) / 100, max_cut: Number(this.cut.value) / 100 };
    return { ...about, method: "threshold", least_percent: Number(this.least.value), most_percent: Number(this.most.value), gamma: Number(this.gamma.value) / 100 };
  }

  private set_method(method: PlanMethod): void {
    this.method = method;
    by_id("plan-target", HTMLElement).hidden = method !== "target";
    by_id("plan-threshold", HTMLElement).hidden = method !== "threshold";
    const norm = [...this.measure.options].find(({ value }) => value === "norm");
    if (norm !== undefined) {
      norm.hidden = norm.disabled = method === "target";
      if (norm.disabled && this.measure.value === "norm") this.measure.value = "zenith";
    }
    const { lead, lead_threshold, find, find_threshold } = words().plan;
    by_id("plan-lead", HTMLElement).textContent = method === "target" ? lead : lead_threshold;
    this.find.textContent = method === "target" ? find : find_threshold;
    this.show_values();
  }

  private show_values(): void {
    for (const slider of [this.reduction, this.cut, this.least, this.most, this.gamma]) {
      const value = decimal(slider.value);
      by_id(`${slider.id}-value`, HTMLOutputElement).value = `${value} %`;
      slider.setAttribute("aria-valuetext", words().plan.percent(value));
    }
  }
}
