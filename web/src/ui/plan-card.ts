// A reduction plan: the request, and the plan that the server found.

import { urlOf } from "../api/client.ts";
import type { DimmedPixel, NamedPlace, Plan } from "../api/types.ts";
import { isSamePlace } from "../data/darker-session.ts";
import { placeWords } from "../language/words.ts";
import type { Lights } from "../lights/lights.ts";
import { LISTED_PIXELS } from "../lights/plan-request.ts";
import { type AppState, planOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { comparisonRows, measureTitle, plannedRow } from "./comparison.ts";
import { byId, make } from "./dom.ts";
import { fixed, magnitude, percent, whole, withPrefix } from "./format.ts";
import { nearestPlace, placeName } from "./nearby.ts";
import { PlanForm } from "./plan-form.ts";

/** Number of towns that are named; the rest are summed up. */
const NAMED_TOWNS = 6;

/** Around which towns the dimmed pixels lie, with their parts of the plan's effect, the largest first. */
export function effectByTown(pixels: readonly DimmedPixel[], places: readonly NamedPlace[]): [string, number][] {
  const sums = new Map<string, number>();
  for (const pixel of pixels) {
    const town = nearestPlace(pixel, places)?.name ?? placeWords().plan.far;
    sums.set(town, (sums.get(town) ?? 0) + pixel.effect);
  }
  return [...sums].sort(([, a], [, b]) => b - a);
}

export class PlanCard {
  private readonly card = byId("plan-card", HTMLElement);
  private readonly progress = byId("plan-progress", HTMLElement);
  private readonly reached = byId("plan-reached", HTMLElement);
  private readonly answer = byId("plan-answer", HTMLElement);

  constructor(
    store: AppStore,
    private readonly lights: Lights,
  ) {
    const form = new PlanForm(store, lights);
    store.watch(["isSearching"], ({ isSearching }) => {
      this.card.setAttribute("aria-busy", String(isSearching));
      // Plans that follow a slider need no message: the sky shows them.
      this.progress.textContent = isSearching && !form.isLive() ? placeWords().plan.searching : "";
    });
    store.watch([planOf, "places"], (state) => {
      const plan = planOf(state);
      this.reached.replaceChildren(...(plan === null ? [] : this.goals(plan, state.places)));
    });
    store.watch([planOf, "places", "comparison"], (state) => {
      const plan = planOf(state);
      this.answer.replaceChildren(...(plan === null ? [] : [...this.plan(plan, state), this.drop()]));
    });
  }

  /** What the plan reaches, and why not more; screen readers announce it. */
  private goals(plan: Plan, places: readonly NamedPlace[]): HTMLElement[] {
    return plan.sites.flatMap((site) => {
      const where = measureTitle(site.measure);
      const name = placeName(site.observer, places);
      const reached = make(
        "p",
        "plan-reached",
        make("b", "", placeWords().plan.darker(percent(site.reduced_by))),
        ` ${where}, ${name}`,
      );
      reached.dataset.reducedBy = String(site.reduced_by);
      const { target, before } = site;
      const unmet = target == null || target.is_met || before <= 0 ? [] : [make("p", "warning", outOfReach(target, before))];
      return [reached, ...unmet];
    });
  }

  private plan(plan: Plan, { place, places, comparison, scenario }: Readonly<AppState>): HTMLElement[] {
    // Skies of the chosen time are those of the picture, where that is of the plan's site; a plan's own know no time.
    const [site, ...others] = plan.sites.map(({ observer }) => observer);
    const isHere = place !== null && site !== undefined && others.length === 0 && isSamePlace(site, place);
    const shown = isHere && scenario === plan.id ? comparison : null;
    const sites = plan.sites.flatMap((site) => {
      const { before: skyBefore, after: skyAfter } = shown ?? { before: site.sky_before, after: site.sky_after };
      const numbers = make(
        "dl",
        "number-list",
        changeRow(
          placeWords().plan.zenith,
          magnitude(skyBefore.zenith_brightness_mag_arcsec2 ?? null),
          magnitude(skyAfter.zenith_brightness_mag_arcsec2 ?? null),
          "mag/arcsec²",
        ),
        ...(skyBefore.bortle_class == null || skyAfter.bortle_class == null
          ? []
          : [changeRow(placeWords().numbers.bortleClass, String(skyBefore.bortle_class), String(skyAfter.bortle_class), "")]),
        ...(skyBefore.naked_eye_limit_mag == null || skyAfter.naked_eye_limit_mag == null
          ? []
          : [
              changeRow(
                placeWords().numbers.faintestStars,
                fixed(skyBefore.naked_eye_limit_mag, 2),
                fixed(skyAfter.naked_eye_limit_mag, 2),
                "mag",
              ),
            ]),
      );
      return [...plannedRow(site), numbers, ...comparisonRows({ before: skyBefore, after: skyAfter })];
    });
    const light = make(
      "p",
      "",
      placeWords().plan.light(
        percent(plan.flux_removed_share),
        withPrefix(plan.flux_removed_dnb_w, "W"),
        whole(plan.dimmed_pixels),
        whole(plan.lit_pixels_within_reach),
      ),
    );
    const more = plan.pixels.length < plan.dimmed_pixels ? [make("p", "", placeWords().plan.listed(whole(LISTED_PIXELS)))] : [];
    return [...sites, light, make("p", "lead", placeWords().plan.marked), ...more, ...towns(plan.pixels, places), files(plan.id)];
  }

  private drop(): HTMLElement {
    const button = make("button", "quiet", placeWords().plan.drop) as HTMLButtonElement;
    button.type = "button";
    button.id = "plan-drop";
    button.addEventListener("click", () => this.lights.drop());
    return button;
  }
}

/** Why a goal is not met: how far all lights together go. */
function outOfReach({ wanted, least }: { wanted: number; least: number }, before: number): string {
  return placeWords().plan.outOfReach(percent(1 - wanted / before), percent(1 - least / before));
}

function changeRow(title: string, before: string, after: string, unit: string): HTMLElement {
  const row = make(
    "div",
    "number-row",
    make("dt", "", title),
    make("dd", "", `${before} → `, make("b", "", after), unit === "" ? "" : ` ${unit}`),
  );
  return row;
}

function towns(pixels: readonly DimmedPixel[], places: readonly NamedPlace[]): HTMLElement[] {
  if (places.length === 0 || pixels.length === 0) return [];
  const all = effectByTown(pixels, places);
  const rest = all.slice(NAMED_TOWNS).reduce((sum, [, effect]) => sum + effect, 0);
  const shown: [string, number][] =
    rest > 0 ? [...all.slice(0, NAMED_TOWNS), [placeWords().plan.more(all.length - NAMED_TOWNS), rest]] : all;
  const rows = shown.map(([name, effect]) => {
    const bar = make("i", "");
    bar.style.width = `${100 * effect}%`;
    return make("li", "", make("span", "", name), make("b", "", percent(effect)), bar);
  });
  return [make("h3", "", placeWords().plan.towns), make("ul", "towns", ...rows)];
}

function files(id: string): HTMLElement {
  const link = (format: string, title: string) => {
    const anchor = make("a", "", format) as HTMLAnchorElement;
    anchor.href = urlOf("/api/v1/plans/{plan}", { plan: `${id}.${title}` }, { limit: 10_000 });
    anchor.target = "_blank";
    anchor.rel = "noopener";
    return anchor;
  };
  return make("p", "links", link("GeoTIFF", "tif"), link("GeoJSON", "geojson"), link("CSV", "csv"), link("JSON", "json"));
}
