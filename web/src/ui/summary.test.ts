import assert from "node:assert/strict";
import { test } from "node:test";
import type { NightSky, SkyAnswer } from "../api/types.ts";
import { loadWords } from "../language/words.ts";
import { aboutStars, glowSentence, summaryOf } from "./summary.ts";

await loadWords("place");

const SKY = { bortle_class: 5, ratio_to_natural: 2.4, zenith_luminance_cd_m2: 4e-4, naked_eye_limit_mag: 5.5 };

function answerOf(sky: Partial<SkyAnswer["sky"]>, coverage = 1, nightSky: object | null = null) {
  return { sky: { ...SKY, ...sky } as SkyAnswer["sky"], coverage, night_sky: nightSky as NightSky | null };
}

/** Components at the zenith, the Sun's and the Moon's altitude and the contrast of the Milky Way. */
function nightOf(components: Record<string, number>, sunDeg: number, moonDeg: number, contrast: number | null) {
  return {
    components: Object.entries(components).map(([component, zenithLuminanceCdM2]) => ({
      component,
      zenith_luminance_cd_m2: zenithLuminanceCdM2,
    })),
    sun: { true_altitude_deg: sunDeg },
    moon: { apparent_altitude_deg: moonDeg, illuminated_fraction: 0.87 },
    milky_way: contrast === null ? null : { contrast },
    stars: { visible: 873, above_horizon: 4517 },
  };
}

test("the first sentence says how dark the sky is", () => {
  assert.deepEqual(summaryOf(answerOf({})), ["Suburban sky.", "The Milky Way is faint."]);
  const dark = nightOf({ airglow: 1e-4 }, -40, -10, 0.2);
  assert.deepEqual(summaryOf(answerOf({}, 1, dark)), [
    "Suburban sky.",
    "The Milky Way is visible.",
    "You see about 870 of 4,500 stars.",
  ]);
  assert.equal(
    summaryOf(answerOf({ bortle_class: 1, ratio_to_natural: 0.004 }))[0],
    "Pristine sky: lamps add less than 1 % overhead.",
  );
  assert.deepEqual(summaryOf(answerOf({ bortle_class: null })), ["Overcast: no stars."]);
  const broken = { ...answerOf({ bortle_class: null }), cloud_cover: 0.45 };
  assert.deepEqual(summaryOf(broken), ["Clouds over 45 % of the sky, stars between them."]);
});

/** A sky of which much is unknown is never called dark without saying so. */
test("what is unknown is said in the sentence", () => {
  const [first] = summaryOf(answerOf({ bortle_class: 1, ratio_to_natural: 0.004 }, 0.27));
  assert.equal(first, "Very dark sky, or brighter: the lights of only 27 % of the surroundings are known.");
  const [moonlit = ""] = summaryOf(answerOf({}, 0.5, nightOf({ moon: 0.1 }, -40, 34, 0.01)));
  assert.match(moonlit, /Moon.*only 50 %/);
});

test("Sun and Moon come before lamps they outshine", () => {
  assert.equal(
    summaryOf(answerOf({}, 1, nightOf({ moon: 1e-3, airglow: 1e-4 }, -40, 34.2, null)))[0],
    "Moonlit sky: the Moon, 87 % lit and 34° up, outshines the lamps.",
  );
  assert.equal(summaryOf(answerOf({}, 1, nightOf({ sun: 0.1 }, -8, 34, 0)))[0], "Twilight: the Sun is 8° below the horizon.");
  assert.deepEqual(summaryOf(answerOf({}, 1, nightOf({ sun: 300 }, 20, 34, null))), ["Daylight."]);
  assert.equal(summaryOf(answerOf({}, 1, nightOf({ moon: 3e-4 }, -40, 34, null)))[0], "Suburban sky.");
  // The last of twilight over a dark place is night.
  assert.equal(
    summaryOf(answerOf({ zenith_luminance_cd_m2: 0 }, 1, nightOf({ sun: 1e-7, airglow: 1e-4 }, -18, 0, null)))[0],
    "Suburban sky.",
  );
});

test("stars are told in round numbers", () => {
  assert.deepEqual([0, 87, 636, 2449].map(aboutStars), ["0", "87", "640", "2,400"]);
});

/** Two towns are named at most, none where each has little, and none by day, in a pristine sky or for a marked part. */
test("the glow is told by its towns", () => {
  const of = (...shares: number[]) => ({
    measure: "zenith",
    elsewhere: { share: 0.04 },
    places: shares.map((share, i) => ({ share, name: ["Milano", "Como", "Lecco"][i] })) as never[],
  });
  assert.equal(glowSentence(answerOf({}), of(0.641, 0.118, 0.1)), "64\u00a0% of the glow comes from Milano, 12\u00a0% from Como.");
  assert.equal(glowSentence(answerOf({}), of(0.897, 0.04)), "90\u00a0% of the glow comes from Milano.");
  assert.equal(glowSentence(answerOf({}), of(0.032, 0.03)), "The glow comes from many towns, at most 4\u00a0% from each.");
  assert.equal(glowSentence(answerOf({}), { ...of(0.9), measure: "region" }), "");
  assert.equal(glowSentence(answerOf({ ratio_to_natural: 0.002 }), of(0.9)), "");
  assert.equal(glowSentence(answerOf({}, 1, nightOf({ sun: 1e3 }, 12, -10, null)), of(0.9)), "");
  assert.equal(glowSentence(answerOf({}), of()), "");
  // Flares and mines are no town.
  const far = (share: number, ...shares: number[]) => glowSentence(answerOf({}), { ...of(...shares), elsewhere: { share } });
  assert.match(far(0.991, 0.004), /^Most of the glow, 99\u00a0%, comes from lights far from any town \(.* fishing fleets\)\.$/);
  assert.match(far(0.7), /^Most of the glow, 70\u00a0%, /);
  assert.match(
    far(0.4, 0.3, 0.1),
    /^40\u00a0% of the glow comes from lights far from any town \(.* fleets\), 30\u00a0% from Milano\.$/,
  );
  assert.match(far(0.2, 0.03), /^20\u00a0% of the glow comes from lights far/);
  assert.equal(far(0.3, 0.6), "60\u00a0% of the glow comes from Milano.");
});
