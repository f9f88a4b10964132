// The request for a reduction plan: the least light for a target, or the lights above thresholds of influence, live as sliders move.

import type { Plan } from "../api/types.ts";
import { placeWords } from "../language/words.ts";
import type { Lights } from "../lights/lights.ts";
import { PLAN_MEASURES, type PlanMethod, type PlanRequest } from "../lights/plan-request.ts";
import { planOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import type { MeasureName } from "../state/view-state.ts";
import { byId } from "./dom.ts";
import { decimal } from "./format.ts";
import { wireGroup } from "./group.ts";
import { setRegionOption } from "./select.ts";

export class PlanForm {
  private readonly reduction = byId("plan-reduction", HTMLInputElement);
  private readonly cut = byId("plan-cut", HTMLInputElement);
  private readonly lower = byId("plan-least", HTMLInputElement);
  private readonly upper = byId("plan-most", HTMLInputElement);
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
    this.lower.addEventListener("input", () => {
      if (Number(this.upper.value) < Number(this.lower.value)) this.upper.value = this.lower.value;
      moved();
    });
    this.upper.addEventListener("input", () => {
      if (Number(this.lower.value) > Number(this.upper.value)) this.lower.value = this.upper.value;
      moved();
    });
    // What of the sky it is about is chosen once, for the plan and for the map's lights that cause it.
    this.measure.addEventListener("change", () => {
      store.set({ measure: this.measure.value as MeasureName });
      moved();
    });
    this.find.addEventListener("click", () => lights.find(this.request()));
    this.pressMethod(this.method);
    this.setMethod(this.method);
    store.watch(["region", "measure"], ({ region, measure }) => {
      setRegionOption(this.measure, region !== null);
      this.showMeasure(measure);
    });
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

  /** Shows the request of a plan, after a reload too. */
  private show(plan: Plan): void {
    const [site] = plan.sites;
    if (site === undefined) return;
    if (plan.method === "threshold") {
      // Thresholds in the measure's unit have no place on sliders of percentiles.
      const percents = plan.threshold_levels?.map((level) => (level.startsWith("p") ? Number(level.slice(1)) : NaN)) ?? [];
      const [lower = NaN, upper = NaN] = percents;
      if (lower <= 100 && upper <= 100) [this.lower.value, this.upper.value] = [String(lower), String(upper)];
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
    this.showMeasure(site.measure);
    this.showValues();
  }

  /** Where a plan can be about it. */
  private showMeasure(measure: string): void {
    if ([...this.measure.options].some(({ value, disabled }) => value === measure && !disabled)) this.measure.value = measure;
  }

  private request(): PlanRequest {
    const measure = PLAN_MEASURES.find((name) => name === this.measure.value) ?? "zenith";
    const about = { measure, region: this.store.state.region };
    if (this.method === "target")
      return { ...about, method: "target", reduceBy: Number(this.reduction.value) / 100, maxCut: Number(this.cut.value) / 100 };
    return {
      ...about,
      method: "threshold",
      lowerPercentile: Number(this.lower.value),
      upperPercentile: Number(this.upper.value),
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
      else this.showMeasure(this.store.state.measure);
    }
    const { lead, leadThreshold, find, findThreshold } = placeWords().plan;
    byId("plan-lead", HTMLElement).textContent = method === "target" ? lead : leadThreshold;
    this.find.textContent = method === "target" ? find : findThreshold;
    this.showValues();
  }

  private showValues(): void {
    for (const slider of [this.reduction, this.cut, this.lower, this.upper, this.gamma]) {
      const value = decimal(slider.value);
      byId(`${slider.id}-value`, HTMLOutputElement).value = `${value} %`;
      slider.setAttribute("aria-valuetext", placeWords().plan.percent(value));
    }
  }
}
