// What lights are to go: the least for a goal, or those of most influence. The sliders of the second work as they move.

import type { Plan } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { Lights } from "../lights/lights.ts";
import { PLAN_MEASURES, type PlanMethod, type PlanRequest } from "../lights/plan-request.ts";
import { planOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId } from "./dom.ts";
import { decimal } from "./format.ts";
import { wireGroup } from "./group.ts";
import { setRegionOption } from "./select.ts";

export class PlanForm {
  private readonly reduction = byId("plan-reduction", HTMLInputElement);
  private readonly cut = byId("plan-cut", HTMLInputElement);
  private readonly least = byId("plan-least", HTMLInputElement);
  private readonly most = byId("plan-most", HTMLInputElement);
  private readonly gamma = byId("plan-gamma", HTMLInputElement);
  private readonly measure = byId("plan-measure", HTMLSelectElement);
  private readonly find = byId("plan-find", HTMLButtonElement);
  private readonly pressMethod: (method: PlanMethod) => void;
  private method: PlanMethod = "target";

  constructor(
    private readonly store: AppStore,
    lights: Lights,
  ) {
    const moved = () => {
      this.showValues();
      if (this.method === "threshold") lights.try(this.request());
    };
    this.pressMethod = wireGroup<PlanMethod>("plan-method", (method) => {
      lights.stopTrying();
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
    this.find.addEventListener("click", () => lights.find(this.request()));
    this.pressMethod(this.method);
    this.setMethod(this.method);
    store.watch(["region"], ({ region }) => setRegionOption(this.measure, region !== null));
    store.watch(["isSearching"], ({ isSearching }) => {
      // Sliders go on while the last of their plans is on its way.
      this.find.disabled = isSearching && this.method === "target";
    });
    // A slider that goes on moving is not put back to where it was.
    store.watch([planOf], (state) => {
      const plan = planOf(state);
      if (plan !== null && !state.isTrying) this.show(plan);
    });
  }

  /** Whether the sky follows the sliders. */
  isLive(): boolean {
    return this.method === "threshold";
  }

  /** What a plan was found for, after a reload too. */
  private show(plan: Plan): void {
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

  private request(): PlanRequest {
    const measure = PLAN_MEASURES.find((name) => name === this.measure.value) ?? "zenith";
    const about = { measure, region: this.store.state.region };
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
