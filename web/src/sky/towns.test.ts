import assert from "node:assert/strict";
import { test } from "node:test";
import { towns_on_horizon } from "./towns.ts";

const town = (name: string, latitude_deg: number, longitude_deg: number, population: number | null) => ({ name, latitude_deg, longitude_deg, population });
const HERE = { latitude_deg: 0, longitude_deg: 0 };

test("towns are named by their glow: size against distance", () => {
  const towns = towns_on_horizon(HERE, [town("far city", 2, 0, 1e6), town("near town", 0, 0.2, 1e5), town("hamlet", -0.5, 0, 50), town("unknown", 0.1, 0.1, null)], 10);
  assert.deepEqual(towns.map(({ name }) => name), ["near town", "far city"]);
  const [near, far] = towns;
  assert.ok(Math.abs((near?.azimuth_deg ?? 0) - 90) < 1e-6 && Math.abs((near?.distance_km ?? 0) - 22.24) < 0.01);
  assert.ok(Math.abs(far?.azimuth_deg ?? 1) < 1e-6);
});

test("of towns in the same direction the brightest is named, also across north", () => {
  const towns = towns_on_horizon(HERE, [town("left of north", 1, -0.05, 2e5), town("right of north", 1, 0.05, 1e5), town("south", -1, 0, 1e5)], 10);
  assert.deepEqual(towns.map(({ name }) => name), ["left of north", "south"]);
});

test("the town that one stands in has no direction", () => {
  assert.deepEqual(towns_on_horizon(HERE, [town("here", 0.01, 0, 1e6)], 10), []);
});
