import assert from "node:assert/strict";
import { test } from "node:test";
import { angle_deg, outline, region_from_text, region_from_trail, text_from_region } from "./region.ts";

const at = (azimuth_deg: number, elevation_deg: number) => ({ azimuth_deg, elevation_deg });
/** A circle of that radius about a direction low in the sky, drawn in many small steps. */
const circle = (azimuth_deg: number, radius_deg: number, points: number) =>
  Array.from({ length: points }, (_, i) => {
    const turn = (2 * Math.PI * i) / points;
    return at((azimuth_deg + radius_deg * Math.cos(turn) + 360) % 360, 30 + radius_deg * Math.sin(turn));
  });

test("angles are those of great circles, at any size and across north", () => {
  assert.ok(Math.abs(angle_deg(at(0, 0), at(90, 0)) - 90) < 1e-9);
  assert.ok(Math.abs(angle_deg(at(359, 0), at(1, 0)) - 2) < 1e-9);
  assert.ok(Math.abs(angle_deg(at(10, 90), at(200, 89)) - 1) < 1e-9);
  assert.ok(Math.abs(angle_deg(at(10, 0), at(10 + 1e-6, 0)) - 1e-6) < 1e-12);
});

test("a drawn circle keeps its form with few corners, also across north", () => {
  const region = region_from_trail(circle(2, 12, 2000));
  assert.ok(region !== null && region.length >= 20 && region.length <= 80, `${region?.length}`);
  for (const corner of region) assert.ok(Math.abs(angle_deg(corner, at(2, 30)) - 12) < 2.5, JSON.stringify(corner));
  const last = region.at(-1) ?? at(0, 0);
  assert.ok(angle_deg(last, region[0] ?? last) > 0.5, "the last corner repeats the first");
});

test("a click, a line of two directions and nothing are no region", () => {
  assert.equal(region_from_trail([]), null);
  assert.equal(region_from_trail([at(10, 10), at(10.5, 10), at(10, 10.5)]), null);
  assert.equal(region_from_trail([at(10, 10), at(40, 10)]), null);
});

test("a region's text gives it back, and other texts give none", () => {
  const region = [at(350.5, 3), at(10, 3), at(0, 33.3)];
  assert.equal(text_from_region(region), "350.5,3;10,3;0,33.3");
  assert.deepEqual(region_from_text(text_from_region(region)), region);
  for (const text of [null, "", "1,2;3,4", "1,2;3,4;5", "1,2;3,4;5,91", "1,2;3,4;400,6", "1,2;3,4;a,b", "1,2;3,4;5,6;"]) assert.equal(region_from_text(text), null, String(text));
});

test("an outline follows great circles and closes", () => {
  const points = outline([at(0, 0), at(90, 0), at(0, 90)]);
  assert.deepEqual(points[0], points.at(-1));
  assert.ok(points.length > 90);
  for (const [i, point] of points.entries()) if (i > 0) assert.ok(angle_deg(points[i - 1] ?? point, point) < 2.1);
  // Between the horizon's east and the zenith it keeps to the east.
  assert.ok(points.some(({ azimuth_deg, elevation_deg }) => Math.abs(azimuth_deg - 90) < 1e-6 && Math.abs(elevation_deg - 44) < 3));
});
