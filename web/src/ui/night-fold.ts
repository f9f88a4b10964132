// What the natural sky of a time is made of, for who unfolds it.

import type { NightSky } from "../api/types.ts";
import { placeWords } from "../language/words.ts";
import { compassName } from "../sky/projection.ts";
import { make } from "./dom.ts";
import { magnitude, whole } from "./format.ts";
import { row } from "./row.ts";

/** Whether it is unfolded: it is made anew with every time. */
let isOpen = false;

function whereabouts(altitudeDeg: number, azimuthDeg: number): string {
  const { upTowards, belowHorizon } = placeWords().numbers;
  const degrees = whole(Math.abs(Math.round(altitudeDeg)));
  return altitudeDeg < 0 ? belowHorizon(degrees) : upTowards(degrees, compassName(azimuthDeg));
}

/** Components of the natural sky at the zenith, the brightest first, Sun and Moon, and how many stars are seen. */
export function nightFold({ components, moon, sun, stars }: NightSky): HTMLElement {
  const say = placeWords().numbers;
  const lit = components
    .filter(({ zenith_luminance_cd_m2 }) => zenith_luminance_cd_m2 > 0)
    .sort((a, b) => b.zenith_luminance_cd_m2 - a.zenith_luminance_cd_m2);
  const list = make(
    "dl",
    "number-list",
    row(say.starsSeen, whole(stars.visible), say.starsOf(whole(stars.above_horizon)), "stars"),
    ...lit.map(({ component, zenith_brightness_mag_arcsec2 }) =>
      row(say.component[component], magnitude(zenith_brightness_mag_arcsec2 ?? null), "mag/arcsec²", `component_${component}`),
    ),
    row(say.sunStands, whereabouts(sun.true_altitude_deg, sun.azimuth_deg), "", "sun"),
    row(say.moonStands, whereabouts(moon.apparent_altitude_deg, moon.azimuth_deg), "", "moon"),
  );
  const fold = make("details", "more", make("summary", "", say.components), list) as HTMLDetailsElement;
  fold.id = "night-sky";
  fold.open = isOpen;
  fold.addEventListener("toggle", () => {
    isOpen = fold.open;
  });
  return fold;
}
