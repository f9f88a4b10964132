// The card of numbers for the picked place.

import type { Scene, Site, SkyAnswer } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { SkyKind } from "../sky/grid.ts";
import { compass_name } from "../sky/projection.ts";
import type { BrightnessUnit } from "../sky/units.ts";
import { lamp_title } from "./lamps.ts";
import { in_english, make } from "./dom.ts";
import { fixed, in_unit, magnitude, ratio, short_number, with_prefix } from "./format.ts";
import { clouds_title } from "./clouds.ts";
import { scattering_title } from "./scattering.ts";

function row(name: string, value: string, unit: string, key: string, note = ""): HTMLElement {
  const shown = make("dd", "", make("b", "", value), unit === "" ? "" : ` ${unit}`);
  shown.dataset["value"] = key;
  if (note !== "") shown.append(make("small", "", note));
  return make("div", "number-row", make("dt", "", name), shown);
}

/** What is known right after a click, before the sky is computed. */
export function show_site(container: HTMLElement, site: Site): void {
  const { terrain_altitude_m: terrain_m, radiance_nw_cm2_sr: radiance } = site;
  const no_number = (value: number | null | undefined): value is null | undefined => value === null || value === undefined;
  const { ground, unknown, above_sea, upward, no_data } = words().numbers;
  const rows = [
    no_number(terrain_m) ? row(ground, unknown, "", "terrain") : row(ground, `${Math.round(terrain_m)}`, above_sea, "terrain"),
    no_number(radiance) ? row(upward, no_data, "", "radiance") : row(upward, short_number(radiance), "nW cm⁻² sr⁻¹", "radiance"),
  ];
  container.replaceChildren(...rows);
}

/** What terrain hides, in words. */
export function terrain_title(answer: Pick<SkyAnswer, "terrain_occlusion" | "hidden_lights">): string {
  const { hides_nothing, hides_sky, hides_sky_and_lights } = words().numbers;
  if (!answer.terrain_occlusion) return hides_nothing;
  return answer.hidden_lights ? hides_sky_and_lights : hides_sky;
}

/** What the server had to do without, in its own words. */
function warning(text: string): HTMLElement {
  const shown = in_english(make("p", "warning", `${text.charAt(0).toUpperCase()}${text.slice(1)}.`));
  shown.dataset["value"] = "warning";
  return shown;
}

/** The numbers of a sky; the zenith figures follow the switch between artificial and total. */
export function show_numbers(container: HTMLElement, answer: SkyAnswer, kind: SkyKind, unit: BrightnessUnit, lamp: string, scene: Scene): void {
  const { sky } = answer;
  const say = words().numbers;
  const total = kind === "total";
  const zenith_mag = (total ? sky.zenith_total_brightness_mag_arcsec2 : sky.zenith_brightness_mag_arcsec2) ?? null;
  const zenith_cd_m2 = total ? sky.zenith_total_luminance_cd_m2 : sky.zenith_luminance_cd_m2;
  const illuminance_lx = total ? sky.horizontal_total_illuminance_lx : sky.horizontal_illuminance_lx;

  // The server's own magnitude, wherever it stands.
  const mag = make("b", "", magnitude(zenith_mag));
  mag.dataset["value"] = "zenith_mag";
  const by_unit = unit === "magnitude";
  const [value, name] = by_unit ? [mag, "mag/arcsec²"] : [make("b", "", in_unit(zenith_cd_m2, unit)[0]), in_unit(zenith_cd_m2, unit)[1]];
  const other = by_unit ? [with_prefix(zenith_cd_m2, "cd/m²")] : [mag, " mag/arcsec²"];
  const zenith = make(
    "div",
    "zenith",
    make("span", "zenith-name", total ? say.zenith_total : say.zenith_artificial),
    make("div", "zenith-value", value, make("small", "", name)),
    make("span", "zenith-luminance", ...other),
  );

  const bortle_class = sky.bortle_class ?? null;
  const bortle_number = make("b", "", bortle_class === null ? "–" : String(bortle_class));
  bortle_number.dataset["value"] = "bortle_class";
  const steps = make("div", "bortle-steps");
  for (let step = 1; step <= 9; step++) {
    const mark = make("i", step === bortle_class ? "here" : "");
    mark.dataset["step"] = String(step);
    steps.append(mark);
  }
  steps.setAttribute("aria-hidden", "true");
  const bortle = make("div", "bortle", make("span", "zenith-name", say.bortle_class), make("div", "zenith-value", bortle_number, make("small", "", say.bortle_of)), steps, make("span", "bortle-name", bortle_class === null ? say.overcast : (words().bortle[bortle_class - 1] ?? "")));

  const brightest = say.brightest_at(compass_name(sky.brightest_azimuth_deg), sky.brightest_elevation_deg.toFixed(0));
  const { ground_albedo } = answer;
  const ground = ground_albedo === null || ground_albedo === undefined ? "" : say.albedo(short_number(ground_albedo));
  const limit = sky.naked_eye_limit_mag;
  const list = make(
    "dl",
    "number-list",
    row(say.ratio, `${ratio(sky.ratio_to_natural)} ×`, say.natural, "ratio"),
    row(say.illuminance, with_prefix(illuminance_lx, "lx"), "", "illuminance"),
    limit === null || limit === undefined ? row(say.faintest_stars, say.no_stars, say.behind_clouds, "naked_eye_limit") : row(say.faintest_stars, fixed(limit, 2), say.naked_eye, "naked_eye_limit"),
    row(say.sqm, magnitude(sky.sqm_total_brightness_mag_arcsec2 ?? null), "mag/arcsec²", "sqm"),
    row(say.brightest, with_prefix(sky.brightest_luminance_cd_m2, "cd/m²"), "", "brightest", brightest),
    row(say.observer, `${Math.round(answer.observer.altitude_m)}`, say.above_sea, "altitude"),
    row(say.coverage, fixed(100 * answer.coverage, answer.coverage > 0.995 ? 0 : 1), "%", "coverage"),
    row(say.air, fixed(answer.local_optical_depth[1] ?? NaN, 3), say.optical_depth, "optical_depth"),
    row(words().assumptions.scattering, scattering_title(answer.scattering), "", "scattering", ground),
    row(words().assumptions.clouds, clouds_title(answer.clouds === "none" ? null : Number(answer.clouds)), "", "clouds"),
    row(say.terrain_hides, terrain_title(answer), "", "terrain_occlusion"),
  );

  const notes = [say.lamps_assumed(lamp_title(lamp))];
  if (answer.calibration !== 1) notes.push(say.calibration(short_number(answer.calibration)));
  if (scene.illustrative) notes.push(words().scene.illustrative_note);
  const note = make("div", "notes", ...answer.warnings.map(warning), ...notes.map((text) => make("p", "", text)));
  container.replaceChildren(make("div", "headline-numbers", zenith, bortle), list, note);
}
