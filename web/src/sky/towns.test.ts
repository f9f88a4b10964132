import assert from "node:assert/strict";
import { test } from "node:test";
import { townsOnHorizon } from "./towns.ts";

const town = (name: string, latitudeDeg: number, longitudeDeg: number, population: number | null) => ({
  name,
  latitude_deg: latitudeDeg,
  longitude_deg: longitudeDeg,
  population,
});
const HERE = { latitude_deg: 0, longitude_deg: 0 };

/** Towns are named by their glow: size against distance. */
test("towns are ranked by their glow", () => {
  const towns = townsOnHorizon(
    HERE,
    [town("far city", 2, 0, 1e6), town("near town", 0, 0.2, 1e5), town("hamlet", -0.5, 0, 50), town("unknown", 0.1, 0.1, null)],
    10,
  );
  assert.deepEqual(
    towns.map(({ name }) => name),
    ["near town", "far city"],
  );
  const [near, far] = towns;
  assert.ok(Math.abs((near?.azimuthDeg ?? 0) - 90) < 1e-6 && Math.abs((near?.distanceKm ?? 0) - 22.24) < 0.01);
  assert.ok(Math.abs(far?.azimuthDeg ?? 1) < 1e-6);
});

/** Of towns in the same direction the brightest is named, also across north. */
test("the brightest town of a direction is named", () => {
  const towns = townsOnHorizon(
    HERE,
    [town("left of north", 1, -0.05, 2e5), town("right of north", 1, 0.05, 1e5), town("south", -1, 0, 1e5)],
    10,
  );
  assert.deepEqual(
    towns.map(({ name }) => name),
    ["left of north", "south"],
  );
});

test("the town that one stands in has no direction", () => {
  assert.deepEqual(townsOnHorizon(HERE, [town("here", 0.01, 0, 1e6)], 10), []);
});
