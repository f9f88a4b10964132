import assert from "node:assert/strict";
import { test } from "node:test";
import type { CompactPanorama, Disc } from "./compact.ts";
import { glareOf, HALO_DEG, illuminanceOf, veilPerLx } from "./glare.ts";
import { SkyGrid } from "./grid.ts";

const [COLUMNS, ROWS] = [256, 64];
const MOON: Disc = {
  azimuth_deg: 90,
  elevation_deg: 30,
  radius_deg: 0.26,
  lit_cd_m2: [2500, 2500, 2500, 2500],
  dark_cd_m2: [0, 0, 0, 0],
  lit_share: 0.5,
  bright_limb_deg: 0,
};

/** An even sky of a time, with discs before it. */
function evenSky(luminance: number, discs: Disc[] = [], horizonDeg = 0): SkyGrid {
  const values = new Float32Array(COLUMNS * ROWS).fill(luminance);
  const planes = (["artificial", "total"] as const).flatMap((light) =>
    ["cie_x", "photopic", "cie_z", "scotopic"].map((response) => ({ response, unit: "cd m-2", light, natural: 0, values })),
  );
  const grid = {
    azimuth_count: COLUMNS,
    elevation_count: ROWS,
    azimuth_first_deg: 0,
    azimuth_step_deg: 360 / COLUMNS,
    elevation_first_deg: 45 / ROWS,
    elevation_step_deg: 90 / ROWS,
  };
  const horizon = new Array(COLUMNS).fill(horizonDeg);
  const response = { name: "photopic", unit: "cd m-2" };
  return new SkyGrid({
    grid,
    clouds: "none",
    response,
    horizon_deg: horizon,
    discs,
    planes,
    points: [],
  } as unknown as CompactPanorama);
}

/** CIE 146:2002 by hand for an eye of 30 years, and Stiles and Holladay's law at middle angles. */
test("the veil is that of the standard", () => {
  for (const [angleDeg, expected] of [
    [1, 10 + (5 + 0.05) * 1.0531 + 0.00125],
    [10, 0.01 + (0.05 + 0.005) * 1.0531 + 0.00125],
  ] as const)
    assert.ok(Math.abs(veilPerLx(angleDeg) / expected - 1) < 2e-3, `${angleDeg}: ${veilPerLx(angleDeg)} for ${expected}`);
  for (const angleDeg of [3, 5, 10, 20, 30]) {
    const ratio = veilPerLx(angleDeg) / (10 / angleDeg ** 2);
    assert.ok(ratio > 0.6 && ratio < 1.2, `${angleDeg}: ${ratio}`);
  }
});

test("an even sky has an even veil", () => {
  const { meanCdM2, veil } = glareOf(evenSky(2e-4), "total");
  assert.ok(Math.abs(meanCdM2 / 2e-4 - 1) < 1e-5, `${meanCdM2}`);
  assert.ok(
    veil.every((value) => value / 2e-4 > 0.01 && value / 2e-4 < 0.08),
    `${Math.min(...veil)} to ${Math.max(...veil)}`,
  );
});

/** Half a Moon's light is that of half its disc; its veil is thickest next to it, and there is none from behind a hill. */
test("the Moon veils the sky around it", () => {
  assert.ok(Math.abs(illuminanceOf(MOON)[1] / 0.0809 - 1) < 0.01, `${illuminanceOf(MOON)}`);
  const dark = evenSky(0, [MOON]);
  const { veil } = glareOf(dark, "total");
  const at = (azimuthDeg: number, elevationDeg: number) =>
    veil[4 * (Math.round((elevationDeg * ROWS) / 90 - 0.5) * COLUMNS + Math.round((azimuthDeg * COLUMNS) / 360)) + 1] ?? NaN;
  const nearest = illuminanceOf(MOON)[1] * veilPerLx(HALO_DEG) * Math.cos((HALO_DEG * Math.PI) / 180);
  assert.ok(Math.abs(at(90, 30) / nearest - 1) < 1e-3, `${at(90, 30)} for ${nearest}`);
  assert.ok(at(90, 30) > at(90, 45) && at(90, 45) > at(90, 80) && at(90, 80) > 0 && at(270, 10) === 0);
  assert.ok(glareOf(dark, "artificial").veil.every((value) => value === 0));
  assert.ok(glareOf(evenSky(0, [MOON], 40), "total").veil.every((value) => value === 0));
});
