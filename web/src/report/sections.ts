// The parts of a report, as elements: what the sky is like, in numbers with their meaning, and whose light it is.

import type { SkyAnswer } from "../api/types.ts";
import { placeWords, reportWords, words } from "../language/words.ts";
import { brightnessMagArcsec2 } from "../photometry.ts";
import { make } from "../ui/dom.ts";
import { fixed, magnitude, percent, ratio, whole, withPrefix } from "../ui/format.ts";
import { listedTowns, othersTitle, whereabouts } from "../ui/shares.ts";
import { cell, headed, table } from "../ui/table.ts";
import type { ReportData, ReportedSky } from "./report-data.ts";

/** Towns that are named: more have no room on the first page. */
const MAX_TOWNS = 7;
const MAG = "mag/arcsec²";

export function section(title: string, ...content: HTMLElement[]): HTMLElement {
  return make("section", "", make("h2", "", title), ...content);
}

/** The picture all around, and below it what it shows. */
export function picture({ pictureUrl }: ReportedSky, heightPx: number, alt: string, caption: string): HTMLElement {
  const image = document.createElement("img");
  image.src = pictureUrl(heightPx);
  image.alt = alt;
  return make("figure", "", image, make("figcaption", "", caption));
}

function upperFirst(text: string): string {
  return `${text.charAt(0).toLocaleUpperCase(words().locale)}${text.slice(1)}`;
}

/** Numbers, each with what it means. */
export function numbersTable(answer: SkyAnswer): HTMLElement {
  const { numbers: say, bortle } = placeWords();
  const { report } = reportWords();
  const { sky, night_sky: night } = answer;
  const natural = brightnessMagArcsec2(sky.zenith_total_luminance_cd_m2 - sky.zenith_luminance_cd_m2);
  const row = (name: string, value: string, unit: string, meaning: string) =>
    headed(name, cell(make("span", "", make("b", "", value), unit === "" ? "" : ` ${unit}`), "value"), cell(meaning));
  const isClear = answer.clouds === "none";
  const rows = [
    row(
      say.zenithTotal,
      magnitude(sky.zenith_total_brightness_mag_arcsec2 ?? null),
      MAG,
      natural === null || !isClear ? report.zenithOf : report.zenith(fixed(natural, 2)),
    ),
    ...(sky.bortle_class == null
      ? []
      : [
          row(
            say.bortleClass,
            String(sky.bortle_class),
            say.bortleOf,
            report.bortle(upperFirst(bortle[sky.bortle_class - 1] ?? "")),
          ),
        ]),
    row(say.ratio, `${ratio(sky.ratio_to_natural)} ×`, "", report.ratio),
    ...(sky.naked_eye_limit_mag == null ? [] : [row(say.faintestStars, fixed(sky.naked_eye_limit_mag, 2), "mag", report.faintest)]),
    ...(night == null ? [] : [row(say.starsSeen, whole(night.stars.visible), "", report.stars(whole(night.stars.above_horizon)))]),
    row(say.sqm, magnitude(sky.sqm_total_brightness_mag_arcsec2 ?? null), MAG, report.sqm),
    row(
      say.illuminance,
      withPrefix(sky.horizontal_total_illuminance_lx, "lx"),
      "",
      report.illuminance(withPrefix(sky.horizontal_illuminance_lx, "lx")),
    ),
  ];
  return table([report.what, "", report.meaning], rows, "numbers");
}

/** A share as a number and as a bar. */
function shareCells(share: number): HTMLElement[] {
  const bar = make("i", "bar");
  bar.style.setProperty("--share", String(Math.min(share, 1)));
  return [cell(percent(share), "value"), cell(bar, "bars")];
}

/** Names with their shares. */
export function shareTable(columns: [string, string], parts: readonly (readonly [string, number])[]): HTMLElement {
  const rows = parts.map(([name, share]) => headed(name, ...shareCells(share)));
  return table([...columns, ""], rows, "shares-table");
}

/** Whose light it is, by town, and by the areas of a file. */
export function sharesSection({ shares, areas }: ReportData): HTMLElement {
  const { shares: say, plan } = placeWords();
  const { report } = reportWords();
  if (!(shares.total > 0)) return section(report.shares, make("p", "", say.none));
  const { named, others, elsewhere } = listedTowns(shares, MAX_TOWNS);
  const rest = [
    [othersTitle(others.count, named.length > 0), others.share],
    [plan.far, elsewhere],
  ] as const;
  const rows = [
    ...named.map((town) => headed(town.name, cell(whereabouts(town)), ...shareCells(town.share))),
    ...rest.filter(([, share]) => share > 0).map(([name, share]) => headed(name, cell(""), ...shareCells(share))),
  ];
  const byArea =
    areas === null
      ? []
      : [
          make("h3", "", report.areas(areas.fileName)),
          shareTable(
            [report.area, report.share],
            [
              ...areas.shares.areas.map(({ name, share }) => [name, share] as const),
              [say.outside, areas.shares.outside.share] as const,
            ],
          ),
        ];
  return section(
    report.shares,
    make("p", "lead", report.sharesLead),
    table([report.town, report.where, report.share, ""], rows, "shares-table"),
    ...byArea,
  );
}
