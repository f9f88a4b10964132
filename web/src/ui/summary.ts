// One sentence first: what the sky is like, in plain words.

import type { NightSky, Shares, SkyAnswer } from "../api/types.ts";
import { placeWords, words } from "../language/words.ts";
import { eveningOf, eveningOfTonight } from "../night/time.ts";
import type { AppState } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { coverOf, coverTitle } from "./clouds.ts";
import { byId, make } from "./dom.ts";
import { whole } from "./format.ts";

/** With less of the surroundings known than this, a sky may be brighter than it is told. */
export const WELL_KNOWN = 0.9;
/** Artificial light at the zenith over the natural one: below it nobody sees a difference. */
const PRISTINE_RATIO = 0.01;
/** Weber's contrast of the Milky Way with the sky beside it: from each on it is told as the next. */
const MILKY_WAY_CONTRASTS = [0.05, 0.15, 0.4] as const;
/** The eye's limit overhead from which the Milky Way is told as the next, where no time says where it is. */
const MILKY_WAY_LIMITS_MAG = [5, 5.6, 6.2] as const;
/** The Sun's upper limb is at the horizon, by standard refraction. */
const SUN_SETS_DEG = -0.833;

/** Towns with less of the glow are not named in the sentence, and no more than these. */
const NAMED_SHARE = 0.05;
const MAX_NAMED = 2;

type Summarized = Pick<SkyAnswer, "sky" | "coverage" | "night_sky" | "cloud_cover">;

/** How many of ascending limits a value reaches. */
function reached(value: number, limits: readonly number[]): number {
  return limits.filter((limit) => value >= limit).length;
}

/** A number of stars as people say it: 3, 87, 640, 2 400. */
export function aboutStars(count: number): string {
  return whole(count < 100 ? count : Number(count.toPrecision(2)));
}

/** Whether the light of Sun or Moon at the zenith is more than that of lamps. */
export function dominantLight({ components }: NightSky, artificialCdM2: number): "sun" | "moon" | null {
  const at = (name: string) => components.find(({ component }) => component === name)?.zenith_luminance_cd_m2 ?? 0;
  const [sun, moon] = [at("sun"), at("moon")];
  if (Math.max(sun, moon) <= artificialCdM2) return null;
  // A trace of twilight is none.
  const rest = components.reduce((sum, { zenith_luminance_cd_m2 }) => sum + zenith_luminance_cd_m2, 0) - sun - moon;
  return Math.max(sun, moon) < rest ? null : sun > moon ? "sun" : "moon";
}

/** Whether the Sun is up. */
export function isByDay(night: NightSky | null | undefined): boolean {
  return night != null && night.sun.true_altitude_deg > SUN_SETS_DEG;
}

/** What the sky is like, without whose light it is. */
function quality({ sky, coverage, night_sky, cloud_cover }: Summarized): string {
  const say = placeWords().summary;
  const known = whole(Math.round(100 * coverage));
  const bortleClass = sky.bortle_class ?? null;
  if (bortleClass === null) return coverOf(cloud_cover) < 1 ? say.broken(coverTitle(100 * coverOf(cloud_cover))) : say.overcast;
  const light = night_sky == null ? null : dominantLight(night_sky, sky.zenith_luminance_cd_m2);
  if (night_sky != null && light === "sun") {
    const { true_altitude_deg: altitudeDeg } = night_sky.sun;
    return altitudeDeg > SUN_SETS_DEG ? say.daylight : say.twilight(whole(Math.round(-altitudeDeg)));
  }
  const isKnown = coverage >= WELL_KNOWN;
  if (night_sky != null && light === "moon") {
    const { illuminated_fraction, apparent_altitude_deg } = night_sky.moon;
    const moonlit = say.moonlit(whole(Math.round(100 * illuminated_fraction)), whole(Math.round(apparent_altitude_deg)));
    return isKnown ? moonlit : `${moonlit} ${say.knownOnly(known)}`;
  }
  const name = say.quality[bortleClass - 1] ?? "";
  if (!isKnown) return say.atLeast(name, known);
  return sky.ratio_to_natural < PRISTINE_RATIO ? say.pristine : say.known(name);
}

function milkyWay({ sky, night_sky }: Summarized): string {
  const say = placeWords().summary;
  if (night_sky != null) {
    if (night_sky.milky_way == null) return "";
    return say.milkyWay[reached(night_sky.milky_way.contrast, MILKY_WAY_CONTRASTS)] ?? "";
  }
  return say.milkyWay[reached(sky.naked_eye_limit_mag ?? 0, MILKY_WAY_LIMITS_MAG)] ?? "";
}

/** The sentences, the first of which says most. */
export function summaryOf(answer: Summarized, isTonight = false): string[] {
  const { sky, night_sky } = answer;
  const say = placeWords().summary;
  const first = quality(answer);
  if (sky.bortle_class == null) return [first];
  if (isByDay(night_sky)) return [first];
  const tell = isTonight ? say.starsTonight : say.stars;
  const stars = night_sky == null ? "" : tell(aboutStars(night_sky.stars.visible), aboutStars(night_sky.stars.above_horizon));
  return [first, milkyWay(answer), stars].filter((sentence) => sentence !== "");
}

type Glow = Pick<Shares, "measure" | "places"> & { elsewhere: Pick<Shares["elsewhere"], "share"> };

/** Whose light it is overhead, in a sentence; empty where there is nothing to say. */
export function glowSentence({ sky, night_sky }: Summarized, { measure, places, elsewhere }: Glow): string {
  const say = placeWords().summary;
  const [first, ...others] = places;
  // Where Sun or Moon outshine the lamps, most of the glow is theirs.
  const isOfLamps = night_sky == null || dominantLight(night_sky, sky.zenith_luminance_cd_m2) === null;
  const isGround = measure === "horizontal";
  if ((measure !== "zenith" && !isGround) || !isOfLamps || sky.ratio_to_natural < PRISTINE_RATIO) return "";
  const percent = (share: number) => whole(Math.round(100 * share));
  const too = (towns: Shares["places"], count: number) =>
    towns
      .filter(({ share }, i) => share >= NAMED_SHARE && i < count)
      .map(({ share, name }) => say.glowToo(percent(share), name))
      .join("");
  const { share: far } = elsewhere;
  if (isGround)
    return first === undefined || first.share < NAMED_SHARE || far > first.share
      ? ""
      : say.glowOnGround(percent(first.share), first.name, too(others, MAX_NAMED - 1));
  // Lights that are no town's may be the most of all.
  if (far >= NAMED_SHARE && far > (first?.share ?? 0))
    return (far > 0.5 ? say.glowMostlyFar : say.glowFar)(percent(far), too(places, MAX_NAMED - 1));
  if (first === undefined) return "";
  if (first.share < NAMED_SHARE) return say.glowOfMany(whole(Math.ceil(100 * first.share)));
  return say.glow(percent(first.share), first.name, too(others, MAX_NAMED - 1));
}

/** Whether the time is one of the coming night, or of the one that goes on. */
function isTonight({ place, time }: Pick<AppState, "place" | "time">): boolean {
  if (place === null || time === null) return false;
  const { longitude_deg } = place;
  return eveningOf(Date.parse(time), longitude_deg) === eveningOfTonight(Date.now(), longitude_deg);
}

export function mountSummary(store: AppStore): void {
  const container = byId("summary", HTMLElement);
  const glow = make("span", "");
  store.watch(["answer", "site", "isBusy"], ({ answer, site, isBusy }) => {
    // It stays while the next one is on its way: what is read aloud is a sentence, not a gap.
    if (answer === null) {
      if (site === null) container.replaceChildren(...(isBusy ? [words().sky.waiting] : []));
      return;
    }
    const [first = "", ...others] = summaryOf(answer, isTonight(store.state));
    container.replaceChildren(make("strong", "", first), ...others.map((sentence) => ` ${sentence}`), glow);
  });
  // It comes later, and is then read aloud alone.
  store.watch(["shares", "answer"], ({ shares, answer }) => {
    const sentence = shares === null || answer === null ? "" : glowSentence(answer, shares);
    glow.textContent = sentence === "" ? "" : ` ${sentence}`;
  });
}
