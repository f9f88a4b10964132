import assert from "node:assert/strict";
import { test } from "node:test";
import type { SkyAnswer } from "../api/types.ts";
import { loadWords } from "../language/words.ts";
import { besideSentence, yearOf } from "./beside.ts";

await loadWords("place");

/** Scenes are told apart by their dates, or by their titles. */
test("a scene is told by its year", () => {
  const scene = (title: string, date: string | null) => ({ title, date });
  assert.equal(yearOf(scene("Alps", "2012"), scene("Alps", "2023")), "2012");
  assert.equal(yearOf(scene("Alps, VIIRS", "2023"), scene("Alps", "2023")), "Alps, VIIRS");
  assert.equal(yearOf(scene("Alps", null), scene("Old Alps", "2012")), "Alps");
});

/** How much brighter or fainter the light is, by the scene that it is compared with. */
test("years are compared in a sentence", () => {
  const sky = (luminance: number, mag: number) =>
    ({ sky: { zenith_luminance_cd_m2: luminance, zenith_total_brightness_mag_arcsec2: mag } }) as SkyAnswer;
  const now = sky(3e-4, 20.78);
  const said = (before: SkyAnswer) => besideSentence(now, before, "2012");
  const all = "All light: 20.95 → 20.78 mag/arcsec².";
  assert.equal(said(sky(2.5e-4, 20.95)), `The artificial light overhead is brighter by 20 % than in “2012”. ${all}`);
  assert.equal(said(sky(4e-4, 20.95)), `The artificial light overhead is fainter by 25 % than in “2012”. ${all}`);
  assert.equal(said(sky(3.0001e-4, 20.95)), `The artificial light overhead is as bright as in “2012”. ${all}`);
  assert.equal(said(sky(0, 21.8)), "");
});
