import assert from "node:assert/strict";
import { test } from "node:test";
import type { FourValues } from "./compact.ts";
import { CONE_TABLE, coneTable, eyeBytes, halfPower, mesopic, seenByEye } from "./eye.ts";

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

/** Between the entries of the table that the shaders look up: luminance is right to a hundredth for the light of any lamp, and roughly
 * for that of low-pressure sodium alone, whose luminance nearly jumps where cones begin to see. */
test("the table of cones is fine enough", () => {
  const { width, height, fromLog10, toLog10, ratioLog2 } = CONE_TABLE;
  const table = coneTable();
  const entry = (x: number, y: number) => table[Math.min(y, height - 1) * width + Math.min(x, width - 1)] ?? NaN;
  for (let exponent = -6; exponent <= 3; exponent += 0.013) {
    for (const ratio of [0.23, 0.6, 1.3, 2.47, 4]) {
      const photopic = 10 ** exponent;
      const x = Math.min(Math.max((exponent - fromLog10) / (toLog10 - fromLog10), 0), 1) * (width - 1);
      const y = (Math.log2(ratio) / ratioLog2 + 1) * 0.5 * (height - 1);
      const [left, low] = [Math.floor(x), Math.floor(y)];
      const row = (at: number) => entry(left, at) + (x - left) * (entry(left + 1, at) - entry(left, at));
      const cones = row(low) + (y - low) * (row(low + 1) - row(low));
      const rods = (1 - cones) * (683 / 1699);
      const luminance = ((cones + rods * ratio) / (cones + rods)) * photopic;
      const exact = mesopic(photopic, ratio * photopic);
      assert.ok(Math.abs(cones - exact.coneShare) < 0.02, `${photopic} ${ratio}: ${cones} for ${exact.coneShare}`);
      assert.ok(Math.abs(luminance / exact.luminanceCdM2 - 1) < (ratio < 0.3 ? 0.3 : 0.01), `${photopic} ${ratio}: ${luminance}`);
    }
  }
});

const sodium = (luminance: number): FourValues => [1.15 * luminance, luminance, 0.15 * luminance, 0.65 * luminance];

/** A pristine sky is a near-black blue-grey whatever its light, a dome over a city has its lamps' colour, bright light is white. */
test("night looks like night", () => {
  const [red, green, blue] = eyeBytes(sodium(2e-4), 0, 2e-4);
  assert.ok(red < green && green < blue && blue > 5 && blue < 45, `${red} ${green} ${blue}`);
  const dome = eyeBytes(sodium(0.3), 0, 0.02);
  assert.ok(dome[0] > dome[2] + 40, `${dome}`);
  assert.ok(eyeBytes([2850, 3000, 3270, 7400], 0, 0.02).every((byte) => byte > 245));
  assert.deepEqual(eyeBytes([0, 0, 0, 0], 0, 2e-4), [0, 0, 0]);
  for (const channel of seenByEye([2, 0.1, 0, 0.01], halfPower(3, 1e-3))) assert.ok(channel >= 0 && channel <= 1);
});

/** Twice the light of a dark sky, as the Milky Way has, stands out; the same sky is darker to an eye that comes from a town. */
test("the Milky Way stands out", () => {
  const green = (luminance: number, adaptation: number) => eyeBytes(sodium(luminance), 0, adaptation)[1];
  assert.ok(green(4e-4, 2.5e-4) > 1.7 * green(2e-4, 2.5e-4), `${green(4e-4, 2.5e-4)} ${green(2e-4, 2.5e-4)}`);
  assert.ok(green(2e-4, 2e-2) < 8, `${green(2e-4, 2e-2)}`);
  assert.equal(halfPower(0, 0), halfPower(0, 1e-4));
});

/** The server's eye has the same values in a test of its own (`server/display/src/eye.rs`). */
test("the server has the same eye", () => {
  for (const [light, dazzled, adaptation, expected] of [
    [[2.1e-4, 2e-4, 1.9e-4, 4.6e-4], 1.05, 2.5e-4, [23, 26, 35]],
    [[4.2e-4, 4e-4, 3.9e-4, 9.4e-4], 1.05, 2.5e-4, [40, 45, 57]],
    [[0.034, 0.03, 0.006, 0.02], 1.1, 0.02, [109, 100, 109]],
    [[0.35, 0.3, 0.05, 0.2], 1.5, 0.02, [245, 183, 149]],
    [[1.9, 2, 2.2, 4.8], 1.5, 1, [156, 157, 158]],
    [[2400, 2500, 2700, 6000], 1000, 0.01, [255, 251, 251]],
  ] as const)
    assert.deepEqual(eyeBytes(light, 0, adaptation * dazzled), expected);
});
