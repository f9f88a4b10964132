import assert from "node:assert/strict";
import { test } from "node:test";
import { brightnessMagArcsec2, luminanceFromBrightnessCdM2 } from "./photometry.ts";

test("magnitude 22 is 171 microcandela", () => {
  assert.ok(Math.abs(luminanceFromBrightnessCdM2(22) * 1e6 - 171.2) < 0.1);
});

/** Magnitude and luminance are each other's inverse, and darkness has no magnitude. */
test("magnitude and luminance are inverse", () => {
  const thereAndBack = brightnessMagArcsec2(luminanceFromBrightnessCdM2(19.3));
  assert.ok(thereAndBack !== null && Math.abs(thereAndBack - 19.3) < 1e-12);
  assert.equal(brightnessMagArcsec2(0), null);
});
