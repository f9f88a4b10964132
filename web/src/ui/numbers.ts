// The card of numbers for the picked place.

import type { Scene, Site, SkyAnswer } from "../api/types.ts";
import { asSentence, sentenceIn } from "../language/server-words.ts";
import { placeWords, serverWords, words } from "../language/words.ts";
import { compassName } from "../sky/projection.ts";
import { eyeBefore } from "../sky/seen.ts";
import type { BrightnessUnit } from "../sky/units.ts";
import { sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import type { ViewState } from "../state/view-state.ts";
import { assumedClouds, coverOf } from "./clouds.ts";
import { byId, make, told } from "./dom.ts";
import { decimal, fixed, inUnit, magnitude, ratio, shortNumber, withPrefix } from "./format.ts";
import { lampTitle } from "./lamps.ts";
import { nightFold } from "./night-fold.ts";
import { row } from "./row.ts";
import { scatteringTitle } from "./scattering.ts";
import { dominantLight, isByDay, WELL_KNOWN } from "./summary.ts";

/** Artificial light at the zenith over the natural one: with less, its own magnitude says nothing. */
const NO_ARTIFICIAL_RATIO = 0.001;

/** Follows what is known of the picked place. */
export function mountNumbers(store: AppStore): void {
  const site = byId("site", HTMLElement);
  const numbers = byId("numbers", HTMLElement);
  store.watch(["site"], (state) => {
    if (state.site === null) site.replaceChildren();
    else showSite(site, state.site);
  });
  store.watch(["answer", "unit", "lamp", sceneOf], (state) => {
    const scene = sceneOf(state);
    if (state.answer === null || scene === null) numbers.replaceChildren();
    else showNumbers(numbers, state.answer, state, scene);
  });
}

/** Optical depth near 550 nm, the middle between the nodes 590 and 510 nm in the logarithm. */
function depthNear550(atNodes: readonly number[]): number {
  const [, yellow = Number.NaN, green = Number.NaN] = atNodes;
  return Math.sqrt(yellow * green);
}

/** What is known right after a click, before the sky is computed. */
function showSite(container: HTMLElement, site: Site): void {
  const { terrain_altitude_m: terrainM, radiance_nw_cm2_sr: radiance } = site;
  const noNumber = (value: number | null | undefined): value is null | undefined => value === null || value === undefined;
  const { ground, unknown, aboveSea, upward, noData } = placeWords().numbers;
  const rows = [
    noNumber(terrainM) ? row(ground, unknown, "", "terrain") : row(ground, `${Math.round(terrainM)}`, aboveSea, "terrain"),
    noNumber(radiance) ? row(upward, noData, "", "radiance") : row(upward, shortNumber(radiance), "nW cm⁻² sr⁻¹", "radiance"),
  ];
  container.replaceChildren(...rows);
}

/** What terrain hides, in words. */
export function terrainTitle(answer: Pick<SkyAnswer, "terrain_occlusion" | "hidden_lights">): string {
  const { hidesNothing, hidesSky, hidesSkyAndLights } = placeWords().numbers;
  if (!answer.terrain_occlusion) return hidesNothing;
  return answer.hidden_lights ? hidesSkyAndLights : hidesSky;
}

/** What the server had to do without. */
export function warning(text: string, className = "warning"): HTMLElement {
  const shown = told("p", className, asSentence(sentenceIn(text, serverWords())));
  shown.dataset.value = "warning";
  return shown;
}

/** Artificial light at the zenith, beside all light. */
function artificialAlone({ sky, dark_reference: dark }: SkyAnswer, unit: BrightnessUnit): HTMLElement {
  const say = placeWords().numbers;
  if (sky.ratio_to_natural < NO_ARTIFICIAL_RATIO)
    return make("span", "zenith-luminance", say.artificialLess(decimal(100 * NO_ARTIFICIAL_RATIO)));
  // The server's own magnitude, wherever it stands.
  const mag = make("b", "", magnitude(sky.zenith_brightness_mag_arcsec2 ?? null));
  mag.dataset.value = "zenith_mag";
  const amount =
    unit === "magnitude"
      ? [mag, " mag/arcsec²"]
      : [inUnit(sky.zenith_luminance_cd_m2, unit, eyeBefore(dark)).join(" "), " (", mag, ")"];
  return make("span", "zenith-luminance", `${say.artificialAlone} `, ...amount);
}

/** What there is to say of stars under clouds. */
function starsBehind({ cloud_cover }: SkyAnswer): [string, string] {
  const say = placeWords().numbers;
  return coverOf(cloud_cover) < 1 ? ["–", say.betweenClouds] : [say.noStars, say.behindClouds];
}

/** What there is to say of a Bortle class. */
function bortleWords({ sky, coverage, night_sky, cloud_cover }: SkyAnswer): string {
  const say = placeWords().numbers;
  if (sky.bortle_class == null) return coverOf(cloud_cover) < 1 ? say.betweenClouds : say.overcast;
  const light = night_sky == null ? null : dominantLight(night_sky, sky.zenith_luminance_cd_m2);
  if (light === "sun") return isByDay(night_sky) ? say.byDay : say.inTwilight;
  if (light === "moon") return say.inMoonlight;
  const name = placeWords().bortle[sky.bortle_class - 1] ?? "";
  return coverage < WELL_KNOWN ? say.orBrighter(name) : name;
}

/** Illuminance under a clear sky by the full Moon high up, lx (Kyba et al. 2017). */
const FULL_MOON_LX = 0.25;

/** Light on the ground as a part of moonlight. */
function moonlight(illuminanceLx: number): string {
  return placeWords().numbers.moonlight(ratio(illuminanceLx / FULL_MOON_LX));
}

/** The wall that receives most of all light. */
function brightestWall({ surfaces }: SkyAnswer["sky"]): HTMLElement[] {
  const say = placeWords().numbers;
  const light = surfaces.by_response[0];
  if (light === undefined) return [];
  const { total, artificial } = light;
  const facing = say.facing(compassName(total.vertical_largest_azimuth_deg));
  const alone = `${say.artificialAlone} ${withPrefix(artificial.vertical_largest, "lx")}`;
  return [row(say.wall, withPrefix(total.vertical_largest, "lx"), "", "wall", `${facing}; ${alone}`)];
}

/** The numbers of a sky: all light first, which a meter sees, beside it artificial light alone. */
function showNumbers(container: HTMLElement, answer: SkyAnswer, { unit, lamp }: ViewState, scene: Scene): void {
  const { sky } = answer;
  const say = placeWords().numbers;
  const totalMag = make("b", "", magnitude(sky.zenith_total_brightness_mag_arcsec2 ?? null));
  totalMag.dataset.value = "zenith_total_mag";
  const byUnit = unit === "magnitude";
  const [value, name] = inUnit(sky.zenith_total_luminance_cd_m2, unit, eyeBefore(answer.dark_reference));
  const zenith = make(
    "div",
    "zenith",
    make("span", "zenith-name", say.zenithTotal),
    make("div", "zenith-value", byUnit ? totalMag : make("b", "", value), make("small", "", byUnit ? "mag/arcsec²" : name)),
    byUnit
      ? make("span", "zenith-luminance", withPrefix(sky.zenith_total_luminance_cd_m2, "cd/m²"))
      : make("span", "zenith-luminance", totalMag, " mag/arcsec²"),
    artificialAlone(answer, unit),
  );

  // The Sun's light is no matter of lamps.
  const isSunlit = answer.night_sky != null && dominantLight(answer.night_sky, sky.zenith_luminance_cd_m2) === "sun";
  const bortleClass = isSunlit ? null : (sky.bortle_class ?? null);
  const bortleNumber = make("b", "", bortleClass === null ? "–" : String(bortleClass));
  bortleNumber.dataset.value = "bortle_class";
  const steps = make("div", "bortle-steps");
  for (let step = 1; step <= 9; step++) {
    const mark = make("i", step === bortleClass ? "here" : "");
    mark.dataset.step = String(step);
    steps.append(mark);
  }
  steps.setAttribute("aria-hidden", "true");
  const bortle = make(
    "div",
    "bortle",
    make("span", "zenith-name", say.bortleClass),
    make("div", "zenith-value", bortleNumber, make("small", "", say.bortleOf)),
    steps,
    make("span", "bortle-name", bortleWords(answer)),
  );

  const brightest = say.brightestAt(compassName(sky.brightest_azimuth_deg), sky.brightest_elevation_deg.toFixed(0));
  const { ground_albedo } = answer;
  const ground = ground_albedo === null || ground_albedo === undefined ? "" : say.albedo(shortNumber(ground_albedo));
  const isDay = isByDay(answer.night_sky);
  const limit = isDay ? null : sky.naked_eye_limit_mag;
  const list = make(
    "dl",
    "number-list",
    row(say.ratio, `${ratio(sky.ratio_to_natural)} ×`, say.natural, "ratio"),
    row(
      say.illuminance,
      withPrefix(sky.horizontal_total_illuminance_lx, "lx"),
      "",
      "illuminance",
      `${say.artificialAlone} ${withPrefix(sky.horizontal_illuminance_lx, "lx")}, ${moonlight(sky.horizontal_illuminance_lx)}`,
    ),
    ...brightestWall(sky),
    limit === null || limit === undefined
      ? row(say.faintestStars, ...(isDay ? ([say.noStars, say.byDay] as const) : starsBehind(answer)), "naked_eye_limit")
      : row(say.faintestStars, fixed(limit, 2), say.nakedEye, "naked_eye_limit"),
    row(say.sqm, magnitude(sky.sqm_total_brightness_mag_arcsec2 ?? null), "mag/arcsec²", "sqm"),
    row(say.brightest, withPrefix(sky.brightest_luminance_cd_m2, "cd/m²"), "", "brightest", brightest),
    row(say.observer, `${Math.round(answer.observer.altitude_m)}`, say.aboveSea, "altitude"),
    row(say.coverage, fixed(100 * answer.coverage, answer.coverage > 0.995 ? 0 : 1), "%", "coverage"),
    row(say.air, fixed(depthNear550(answer.local_optical_depth), 3), say.opticalDepth, "optical_depth"),
    row(words().assumptions.scattering, scatteringTitle(answer.scattering), "", "scattering", ground),
    row(words().assumptions.clouds, assumedClouds(answer), "", "clouds"),
    row(say.terrainHides, terrainTitle(answer), "", "terrain_occlusion"),
  );

  const notes = [say.lampsAssumed(lampTitle(lamp))];
  if (answer.calibration !== 1) notes.push(say.calibration(shortNumber(answer.calibration)));
  if (scene.illustrative) notes.push(words().scene.illustrativeNote);
  const note = make("div", "notes", ...answer.warnings.map((text) => warning(text)), ...notes.map((text) => make("p", "", text)));
  const night = answer.night_sky == null ? [] : [nightFold(answer.night_sky)];
  container.replaceChildren(make("div", "headline-numbers", zenith, bortle), list, ...night, note);
}
