// What a plan or other lights change: the sky before and after, in pictures and numbers, and whose light is dimmed.

import type { NamedPlace } from "../api/types.ts";
import { placeWords, reportWords, words } from "../language/words.ts";
import type { Change } from "../lights/plan-request.ts";
import { changeTable } from "../ui/change-table.ts";
import { colourNote, plannedChange } from "../ui/comparison.ts";
import { make } from "../ui/dom.ts";
import { percent, whole, withPrefix } from "../ui/format.ts";
import { effectByTown } from "../ui/plan-card.ts";
import type { ReportData, ReportedSky } from "./report-data.ts";
import { picture, section, shareTable } from "./sections.ts";

/** Towns that are named; the rest are summed up. */
const NAMED_TOWNS = 6;
/** Two of them, with the table, on one page. */
const PICTURE_HEIGHT_PX = 256;

/** What the change is, in a sentence. */
function lead(change: Change | null): string {
  const { report } = reportWords();
  if (change === null) return "";
  if (change.kind === "scenario") {
    const { title, changed_pixels, base } = change.scenario;
    const name = title == null || title === "" ? "" : `${title}. `;
    const on = base == null ? "" : ` ${base.startsWith("p-") ? report.withItsPlan : report.withItsBase}`;
    return `${name}${report.paintedLead(whole(changed_pixels))}${on}`;
  }
  const { flux_removed_share, flux_removed_dnb_w, dimmed_pixels } = change.plan;
  return report.planLead(percent(flux_removed_share), withPrefix(flux_removed_dnb_w, "W"), whole(dimmed_pixels));
}

/** A caption that says which eye both pictures are seen by: one that adapts to each would see them alike. */
function seenBy(title: string, eye: ReportData["eye"]): string {
  const { report } = reportWords();
  if (eye === null) return title;
  return eye.isKept ? report.toKeptEye(title, withPrefix(eye.adaptationCdM2, "cd/m²")) : report.toTodaysEye(title);
}

/** Whose light a plan dims. */
function effect(change: Change | null, places: readonly NamedPlace[]): HTMLElement[] {
  if (change?.kind !== "plan" || places.length === 0 || change.plan.pixels.length === 0) return [];
  const { report } = reportWords();
  const all = effectByTown(change.plan.pixels, places);
  const rest = all.slice(NAMED_TOWNS);
  const more: [string, number][] =
    rest.length === 0 ? [] : [[placeWords().plan.more(rest.length), rest.reduce((sum, [, part]) => sum + part, 0)]];
  return [make("h3", "", report.effect), shareTable([report.town, report.share], [...all.slice(0, NAMED_TOWNS), ...more])];
}

export function changeSection(
  today: ReportedSky,
  after: ReportedSky,
  change: Change | null,
  { name, places, eye }: { name: string; places: readonly NamedPlace[]; eye: ReportData["eye"] },
): HTMLElement {
  const { report } = reportWords();
  const { withPlan, asPainted } = words().sky;
  const isPainted = change?.kind === "scenario";
  const [before, now] = [today.answer.sky, after.answer.sky];
  const fluxes =
    change?.kind === "scenario" ? ([change.scenario.flux_before_dnb_w, change.scenario.flux_after_dnb_w] as const) : null;
  const note = colourNote(before, now);
  // A plan may be for several places: the sky here is that of the first.
  const [site] = change?.kind === "plan" ? change.plan.sites : [];
  const alt = report.pictureOf(name);
  const shown = section(
    isPainted ? report.painted : report.plan,
    ...(change === null ? [] : [make("p", "lead", lead(change))]),
    picture(today, PICTURE_HEIGHT_PX, alt, seenBy(report.today, eye)),
    picture(after, PICTURE_HEIGHT_PX, alt, seenBy(isPainted ? asPainted : withPlan, eye)),
    changeTable(before, now, { fluxesDnbW: fluxes, energyRatio: null, planned: site === undefined ? null : plannedChange(site) }),
    ...(note === "" ? [] : [make("p", "note", note)]),
    ...effect(change, places),
  );
  shown.classList.add("change");
  return shown;
}
