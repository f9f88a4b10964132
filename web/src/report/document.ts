// A report as a document: head, sentence, picture, numbers, whose light, what changes, what was assumed, whose data.

import type { NamedPlace } from "../api/types.ts";
import { placeWords, reportWords, words } from "../language/words.ts";
import type { Change } from "../lights/plan-request.ts";
import type { ViewState } from "../state/view-state.ts";
import { timeWithClock } from "../ui/captioned.ts";
import { assumedClouds } from "../ui/clouds.ts";
import { make } from "../ui/dom.ts";
import { coordinates, fixed, shortNumber } from "../ui/format.ts";
import { emissionTitle, lampTitle } from "../ui/lamps.ts";
import { placeName } from "../ui/nearby.ts";
import { terrainTitle, warning } from "../ui/numbers.ts";
import { scatteringTitle } from "../ui/scattering.ts";
import { glowSentence, summaryOf } from "../ui/summary.ts";
import { changeSection } from "./change-section.ts";
import type { ReportData } from "./report-data.ts";
import { numbersTable, picture, section, sharesSection } from "./sections.ts";

/** At the width of paper: large enough to look at, and numbers and shares still on the first page. */
const PICTURE_HEIGHT_PX = 400;

type Shown = Pick<ViewState, "time" | "lamp" | "emission" | "directUplight" | "groundReflectance">;

function facts(rows: readonly (readonly [string, string | Node])[]): HTMLElement {
  return make("dl", "facts", ...rows.map(([name, value]) => make("div", "", make("dt", "", name), make("dd", "", value))));
}

/** A report's title: the same as that of its page. */
export function reportTitle({ place }: ReportData, places: readonly NamedPlace[]): string {
  return reportWords().report.titleOf(placeName(place, places));
}

/** All of it. `madeMs`: when; `link`: the address of the live view. */
export function reportDocument(
  data: ReportData,
  shown: Shown,
  { places, change, madeMs, link }: { places: readonly NamedPlace[]; change: Change | null; madeMs: number; link: string },
): HTMLElement {
  const { place, today, after } = data;
  const { report } = reportWords();
  const { answer } = today;
  const name = placeName(place, places);
  const at = coordinates(place.latitude_deg, place.longitude_deg);
  const date = new Date(madeMs).toLocaleDateString(words().locale, { dateStyle: "long" });
  const [first = "", ...others] = summaryOf(answer);
  const sentences = [...others, glowSentence(answer, data.shares)].filter((sentence) => sentence !== "");
  const title = make("h1", "", make("small", "", report.title), " ", name);
  title.id = "report-title";
  const where = [
    ...(name === at ? [] : [at]),
    report.ground(String(Math.round(answer.observer.altitude_m))),
    timeWithClock(shown.time, place),
  ];
  return make(
    "article",
    "paper",
    make("header", "", make("p", "brand-line", report.brand, make("span", "", report.made(date))), title),
    make("p", "where", where.join(" · ")),
    make("p", "sentence", make("strong", "", first), ` ${sentences.join(" ")}`),
    picture(today, PICTURE_HEIGHT_PX, report.pictureOf(name), report.picture),
    section(report.numbers, numbersTable(answer)),
    sharesSection(data),
    ...(after === null ? [] : [changeSection(today, after, change, { name, places, eye: data.eye })]),
    assumptions(data, shown),
    credit(data, link),
  );
}

function assumptions({ scene, today: { answer } }: ReportData, shown: Shown): HTMLElement {
  const { assumptions: say, scene: ofScene } = words();
  const { numbers } = placeWords();
  const { report } = reportWords();
  const { directUplight, groundReflectance } = shown;
  const shares = [
    ...(directUplight === null ? [] : [`${say.directUplight}: ${fixed(100 * directUplight, 1)} %`]),
    ...(groundReflectance === null ? [] : [`${say.groundReflectance}: ${fixed(100 * groundReflectance, 0)} %`]),
  ];
  const warnings = answer.warnings.map((text) => warning(text, "note"));
  const known = facts([
    [say.turbidity, fixed(answer.turbidity, 1)],
    [say.scattering, scatteringTitle(answer.scattering)],
    [say.clouds, assumedClouds(answer)],
    [say.lamps, lampTitle(shown.lamp)],
    [say.emission, [emissionTitle(shown.emission), ...shares].join("; ")],
    [numbers.terrainHides, terrainTitle(answer)],
    [numbers.coverage, `${fixed(100 * answer.coverage, answer.coverage > 0.995 ? 0 : 1)} %`],
  ]);
  known.classList.add("in-columns");
  return section(
    report.assumptions,
    known,
    make("p", "note", report.assumedLamps),
    ...(answer.calibration === 1 ? [] : [make("p", "note", numbers.calibration(shortNumber(answer.calibration)))]),
    ...(scene.illustrative ? [make("p", "note strong-note", ofScene.illustrativeNote)] : []),
    ...warnings,
  );
}

function credit({ scene }: ReportData, link: string): HTMLElement {
  const { report } = reportWords();
  const address = make("a", "", link) as HTMLAnchorElement;
  address.href = link;
  const lights = [scene.title, scene.date ?? "", scene.attribution ?? ""].filter((part) => part !== "").join(" · ");
  return section(
    report.credit,
    facts([
      [report.lights, lights],
      ...(scene.places_source == null ? [] : [[report.places, scene.places_source] as const]),
      [report.method, report.methodText],
      [report.link, address],
    ]),
  );
}
