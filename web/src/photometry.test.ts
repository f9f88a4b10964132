import assert from "node:assert/strict";
import { test } from "node:test";
import { brightness_mag_arcsec2, luminance_cd_m2, luminance_from_brightness_cd_m2, NATURAL_SKY_CD_M2 } from "./photometry.ts";

test("magnitude 22 is 171 microcandela", () => {
  assert.ok(Math.abs(NATURAL_SKY_CD_M2 * 1e6 - 171.2) < 0.1);
});

test("magnitude and luminance are each other's inverse, and darkness has no magnitude", () => {
  const there_and_back = brightness_mag_arcsec2(luminance_from_brightness_cd_m2(19.3));
  assert.ok(there_and_back !== null && Math.abs(there_and_back - 19.3) < 1e-12);
  assert.equal(brightness_mag_arcsec2(0), null);
});

test("the bands weigh 150, 567 and 45 lm/W", () => {
  assert.equal(luminance_cd_m2(1, 0, 0), 150);
  assert.equal(luminance_cd_m2(0, 1, 0), 567);
  assert.equal(luminance_cd_m2(0, 0, 1), 45);
});
