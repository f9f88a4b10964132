import assert from "node:assert/strict";
import { test } from "node:test";
import type { FourValues } from "./compact.ts";
import { eyeBytes, halfPower, mesopic, seenByEye } from "./eye.ts";

/** Values that the standard's formula gives (CIE 191:2010), from photopic luminance and the ratio of both. */
test("mesopic luminance is that of the standard", () => {
  for (const [photopic, ratio, expected] of [
    [0.1, 1.35, 0.1115],
    [0.1, 2.05, 0.1324],
    [1, 1.35, 1.0371],
    [0.01, 2.05, 0.0169],
  ] as const) {
    const { luminanceCdM2 } = mesopic(photopic, ratio * photopic);
    assert.ok(Math.abs(luminanceCdM2 / expected - 1) < 4e-3, `${photopic} ${ratio}: ${luminanceCdM2}`);
  }
  assert.deepEqual(mesopic(100, 250), { luminanceCdM2: 100, coneShare: 1 });
  assert.equal(mesopic(0, 0).luminanceCdM2, 0);
});

/** The shaders stop after sixteen steps: no more than a thousandth is then missing, for any light. */
test("sixteen steps of mesopic vision are enough", () => {
  for (let exponent = -6; exponent <= 3; exponent += 0.1) {
    for (const ratio of [0.3, 0.6, 1.3, 2.5, 4]) {
      const photopic = 10 ** exponent;
      let [cones, luminance] = [0.5, 0];
      for (let i = 0; i < 16; i++) {
        const rods = (1 - cones) * (683 / 1699);
        luminance = (cones * photopic + rods * ratio * photopic) / (cones + rods);
        cones = Math.min(Math.max(0.767 + 0.3334 * Math.log10(luminance), 0), 1);
      }
      const exact = mesopic(photopic, ratio * photopic);
      assert.ok(Math.abs(luminance / exact.luminanceCdM2 - 1) < 1e-3, `${photopic} ${ratio}: ${luminance}`);
    }
  }
});

const sodium = (luminance: number): FourValues => [1.15 * luminance, luminance, 0.15 * luminance, 0.65 * luminance];

/** A pristine sky is a near-black blue-grey whatever its light, a dome over a city has its lamps' colour, bright light is white. */
test("night looks like night", () => {
  const [red, green, blue] = eyeBytes(sodium(2e-4), 0);
  assert.ok(red < green && green < blue && blue > 10 && blue < 70, `${red} ${green} ${blue}`);
  const dome = eyeBytes(sodium(0.3), 0);
  assert.ok(dome[0] > dome[2] + 40, `${dome}`);
  assert.ok(eyeBytes([2850, 3000, 3270, 7400], 0).every((byte) => byte > 245));
  assert.deepEqual(eyeBytes([0, 0, 0, 0], 0), [0, 0, 0]);
  for (const channel of seenByEye([2, 0.1, 0, 0.01], halfPower(3))) assert.ok(channel >= 0 && channel <= 1);
});
