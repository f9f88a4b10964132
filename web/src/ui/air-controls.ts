// The assumptions about the air: clouds, the scattering that is tabulated under them, and the turbidities of that scattering.

import { words } from "../language/words.ts";
import { type AppState, packsOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { DEFAULT_TURBIDITY, SCATTERINGS } from "../state/view-state.ts";
import { cloudBases, cloudsTitle, coverTitle, packsUnder } from "./clouds.ts";
import { byId, debounced, make } from "./dom.ts";
import { decimal, fixed } from "./format.ts";
import { clampTurbidity, residentScatterings, scatteringTitle, turbidityRange } from "./scattering.ts";
import { fillSelect } from "./select.ts";

/** A slider at rest for this long changes the sky. */
const WAIT_MS = 180;
const NO_CLOUDS = "none";

function airWords(turbidity: number): string {
  const { mountainAir, clearNight, lightHaze, haze } = words().assumptions;
  if (turbidity < 1.75) return mountainAir;
  if (turbidity < 2.75) return clearNight;
  if (turbidity < 4) return lightHaze;
  return haze;
}

export class AirControls {
  private readonly turbidity = byId("turbidity", HTMLInputElement);
  private readonly turbidityValue = byId("turbidity-value", HTMLOutputElement);
  private readonly scattering = byId("scattering", HTMLSelectElement);
  private readonly clouds = byId("clouds", HTMLSelectElement);
  private readonly cover = byId("cloud-cover", HTMLInputElement);
  private readonly coverValue = byId("cloud-cover-value", HTMLOutputElement);

  constructor(private readonly store: AppStore) {
    const setSoon = debounced(WAIT_MS, (turbidity: number) => store.set({ turbidity }));
    this.turbidity.addEventListener("input", () => {
      this.showTurbidity();
      setSoon(Number(this.turbidity.value));
    });
    this.scattering.addEventListener("change", () => this.chooseScattering());
    this.clouds.addEventListener("change", () => {
      this.chooseClouds(this.clouds.value === NO_CLOUDS ? null : Number(this.clouds.value));
    });
    const coverSoon = debounced(WAIT_MS, (cloudCover: number) => store.set({ cloudCover }));
    this.cover.addEventListener("input", () => {
      this.showCover();
      coverSoon(Number(this.cover.value));
    });
    store.watch(["atmospheres", "clouds", "cloudCover", "scattering", "turbidity"], (state) => this.show(state));
  }

  private chooseScattering(): void {
    const packs = packsOf(this.store.state);
    const chosen = SCATTERINGS.find((name) => name === this.scattering.value) ?? null;
    const scattering = chosen === residentScatterings(packs)[0] ? null : chosen;
    this.store.set({ scattering, turbidity: clampTurbidity(packs, scattering, this.store.state.turbidity) });
  }

  /** Scattering and turbidity stay where the packs under these clouds serve them. */
  private chooseClouds(clouds: number | null): void {
    const { state } = this.store;
    const packs = packsUnder(state.atmospheres, clouds);
    const scattering = residentScatterings(packs).find((name) => name === state.scattering) ?? null;
    const wanted = state.turbidity ?? DEFAULT_TURBIDITY;
    const nearest = clampTurbidity(packs, scattering, wanted);
    const isReached = turbidityRange(packs, scattering) !== null && nearest === wanted;
    this.store.set({ clouds, scattering, turbidity: isReached ? state.turbidity : nearest });
  }

  private show(state: Readonly<AppState>): void {
    const { atmospheres, clouds, cloudCover, scattering } = state;
    const bases = cloudBases(atmospheres);
    const choices = [null, ...bases].map((base) => [String(base ?? NO_CLOUDS), cloudsTitle(base)] as const);
    fillSelect(this.clouds, choices, String(clouds ?? NO_CLOUDS));
    // A choice of one is none.
    byId("clouds-field", HTMLElement).hidden = bases.length === 0;
    byId("cloud-cover-field", HTMLElement).hidden = clouds === null;
    this.cover.value = String(cloudCover);
    this.showCover();
    const packs = packsOf(state);
    const resident = residentScatterings(packs);
    const [best] = resident;
    if (best !== undefined) {
      const titles = resident.map((name) => [name, scatteringTitle(name)] as const);
      fillSelect(this.scattering, titles, scattering ?? best);
    }
    this.scattering.disabled = resident.length < 2;
    const range = turbidityRange(packs, scattering);
    if (range !== null) this.showRange(...range);
    this.turbidity.value = String(state.turbidity ?? DEFAULT_TURBIDITY);
    this.showTurbidity();
  }

  private showRange(min: number, max: number): void {
    this.turbidity.min = String(min);
    this.turbidity.max = String(max);
    this.turbidity.disabled = min === max;
    byId("turbidity-ends", HTMLElement).replaceChildren(
      make("span", "", words().assumptions.minTurbidity(decimal(min))),
      make("span", "", words().assumptions.maxTurbidity(decimal(max))),
    );
  }

  private showCover(): void {
    const percent = Number(this.cover.value);
    this.coverValue.value = coverTitle(percent);
    this.cover.setAttribute("aria-valuetext", this.coverValue.value);
    byId("cloud-cover-note", HTMLElement).hidden = percent >= 100;
  }

  private showTurbidity(): void {
    const turbidity = Number(this.turbidity.value);
    this.turbidityValue.value = `${fixed(turbidity, 1)} · ${airWords(turbidity)}`;
    this.turbidity.setAttribute("aria-valuetext", this.turbidityValue.value);
  }
}
