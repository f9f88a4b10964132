// What changed lights change for eyes by day, eyes at night, and a meter.

import type { PlannedSite, SkyQuantities } from "../api/types.ts";
import { typeset } from "../api/units.ts";
import { placeWords, words } from "../language/words.ts";
import type { PlanMeasure } from "../lights/plan-request.ts";
import type { Comparison } from "../state/app-state.ts";
import { make } from "./dom.ts";
import { bothWithPrefix, decimal, fixed, magnitude, ratio } from "./format.ts";

/** From this factor on a change is told as one. */
const TOLD_AS_FACTOR = 10;
/** Changes of S/P by less than this are no change of colour. */
const SAME_COLOUR = 0.03;

/** A change as people say it: +12 %, −0.4 %, 25 ×; null where there was nothing before. */
export function changeOf(before: number, after: number): string | null {
  if (before <= 0) return null;
  const factor = after / before;
  if (factor >= TOLD_AS_FACTOR) return `${ratio(factor)} ×`;
  const percent = 100 * (factor - 1);
  const digits = Math.abs(percent) < 9.95 ? percent.toFixed(1) : percent.toFixed(0);
  if (Number(digits) === 0) return `±0 %`;
  return `${percent > 0 ? "+" : "−"}${decimal(digits.replace("-", ""))} %`;
}

function changeRow(key: string, name: string, change: string, detail: string): HTMLElement {
  const shown = make("dd", "", make("b", "", change), make("small", "", detail));
  shown.dataset.change = key;
  return make("div", "number-row", make("dt", "", name), shown);
}

function luminanceRow(key: string, name: string, before: number, after: number): HTMLElement {
  const [from, to, unit] = bothWithPrefix(before, after, "cd/m²");
  return changeRow(key, name, changeOf(before, after) ?? "–", `${from} → ${to} ${unit}`);
}

/** A meter's number is smaller where the sky is brighter, so it is said which it is. */
function meterRow(before: SkyQuantities, after: SkyQuantities): HTMLElement {
  const { meter, brighter, darker } = placeWords().comparison;
  const from = before.sqm_total_brightness_mag_arcsec2 ?? null;
  const to = after.sqm_total_brightness_mag_arcsec2 ?? null;
  const detail = `${magnitude(from)} → ${magnitude(to)} mag/arcsec²`;
  if (from === null || to === null) return changeRow("sqm", meter, "–", detail);
  const size = fixed(Math.abs(to - from), 2);
  const change = Number(Math.abs(to - from).toFixed(2)) === 0 ? "±0" : to < from ? brighter(size) : darker(size);
  return changeRow("sqm", meter, change, detail);
}

/** Title of the measure that a plan reduces. */
export function measureTitle(measure: string): string {
  const { zenith, mean, horizontal, norm, regionOfSky: region } = words().measures;
  const known: Record<PlanMeasure, string> = { zenith, mean, horizontal, norm, region };
  return known[measure as PlanMeasure] ?? measure;
}

/** What a plan was to reduce, where that is another measure than those of every comparison: its title, values and change. */
export function plannedChange(
  site: Pick<PlannedSite, "measure" | "before" | "after" | "unit">,
): Readonly<Record<"name" | "from" | "to" | "unit" | "change", string>> | null {
  const { measure, before, after } = site;
  if (measure === "zenith") return null;
  const [from, to, unit] = bothWithPrefix(before, after, typeset(site.unit));
  return { name: placeWords().comparison.planned(measureTitle(measure)), from, to, unit, change: changeOf(before, after) ?? "–" };
}

/** The same as a row. */
export function plannedRow(site: PlannedSite): HTMLElement[] {
  const planned = plannedChange(site);
  if (planned === null) return [];
  const { name, from, to, unit, change } = planned;
  return [make("dl", "number-list comparison", changeRow("planned", name, change, `${from} → ${to} ${unit}`))];
}

/** What painted lights lie on, which the sky before has too; empty where that is today's. */
export function baseNote(base: string | null): string {
  const { onPlan, onOthers } = placeWords().comparison;
  return base === null ? "" : base.startsWith("p-") ? onPlan : onOthers;
}

/** Photopic and scotopic luminance of artificial light at the zenith and the meter's reading, before and after. */
export function comparisonRows({ before, after }: Comparison): HTMLElement[] {
  const { comparison: say } = placeWords();
  const { responses } = words();
  const list = make(
    "dl",
    "number-list comparison",
    luminanceRow("photopic", responses.photopic, before.zenith_luminance_cd_m2, after.zenith_luminance_cd_m2),
    luminanceRow("scotopic", responses.scotopic, before.zenith_scotopic_luminance_cd_m2, after.zenith_scotopic_luminance_cd_m2),
    meterRow(before, after),
  );
  const note = colourNote(before, after);
  return [make("h3", "", say.title), list, ...(note === "" ? [] : [make("p", "lead", note)])];
}

type Colours = Pick<SkyQuantities, "zenith_scotopic_photopic_ratio" | "zenith_scotopic_luminance_cd_m2">;

/** Whether the light is bluer or redder than before, and what that is to eyes at night, in words; empty where it is neither. */
export function colourNote(before: Colours, after: Colours): string {
  const [from, to] = [before, after].map(({ zenith_scotopic_photopic_ratio: ratio }) => ratio ?? null);
  if (from == null || to == null || from <= 0) return "";
  const change = to / from - 1;
  if (Math.abs(change) < SAME_COLOUR) return "";
  const isMore = after.zenith_scotopic_luminance_cd_m2 > before.zenith_scotopic_luminance_cd_m2;
  const { bluer, bluerYetLess, redder, redderYetMore } = placeWords().comparison;
  return change > 0 ? (isMore ? bluer : bluerYetLess) : isMore ? redderYetMore : redder;
}
