import assert from "node:assert/strict";
import { test } from "node:test";
import { type Light, LightFinder } from "./light-tip.ts";

/** A raster of 15 arc seconds whose pixel of row 0 and column 0 has its centre here. */
const [NORTH, WEST, STEP] = [46.3, 8.1, 15 / 3600];
const light = (row: number, column: number): Light => ({
  latitude_deg: NORTH - row * STEP,
  longitude_deg: WEST + column * STEP,
  row,
  column,
  share: 0.01,
  distance_m: 1e4,
});
const place = (row: number, column: number) => ({ latitude_deg: NORTH - row * STEP, longitude_deg: WEST + column * STEP });

/** A light is found anywhere in its pixel, and nowhere else. */
test("lights are found in their own pixels", () => {
  const lights = [light(0, 0), light(7, 31), light(120, 64), light(121, 64)];
  const finder = new LightFinder(lights);
  for (const wanted of lights)
    for (const [up, right] of [
      [0, 0],
      [0.45, -0.45],
      [-0.49, 0.3],
    ] as const)
      assert.equal(finder.at(place(wanted.row + up, wanted.column + right)), wanted);
  for (const [row, column] of [
    [0.6, 0],
    [7, 30.4],
    [119.4, 64],
    [60, 60],
  ] as const)
    assert.equal(finder.at(place(row, column)), null, `${row} ${column}`);
  assert.equal(new LightFinder([]).at(place(0, 0)), null);
  const alone = light(3, 3);
  assert.equal(new LightFinder([alone]).at(place(3.4, 2.6)), alone);
});
