import assert from "node:assert/strict";
import { test } from "node:test";
import { angleDeg, outline, regionFromText, regionFromTrail, textFromRegion } from "./region.ts";

const at = (azimuthDeg: number, elevationDeg: number) => ({ azimuthDeg, elevationDeg });
/** A circle of that radius about a direction low in the sky, drawn in many small steps. */
const circle = (azimuthDeg: number, radiusDeg: number, points: number) =>
  Array.from({ length: points }, (_, i) => {
    const turn = (2 * Math.PI * i) / points;
    return at((azimuthDeg + radiusDeg * Math.cos(turn) + 360) % 360, 30 + radiusDeg * Math.sin(turn));
  });

/** Angles are those of great circles, at any size and across north. */
test("angles are those of great circles", () => {
  assert.ok(Math.abs(angleDeg(at(0, 0), at(90, 0)) - 90) < 1e-9);
  assert.ok(Math.abs(angleDeg(at(359, 0), at(1, 0)) - 2) < 1e-9);
  assert.ok(Math.abs(angleDeg(at(10, 90), at(200, 89)) - 1) < 1e-9);
  assert.ok(Math.abs(angleDeg(at(10, 0), at(10 + 1e-6, 0)) - 1e-6) < 1e-12);
});

/** A drawn circle keeps its form with few corners, also across north. */
test("a drawn circle keeps its form", () => {
  const region = regionFromTrail(circle(2, 12, 2000));
  assert.ok(region !== null && region.length >= 20 && region.length <= 80, `${region?.length}`);
  for (const corner of region) assert.ok(Math.abs(angleDeg(corner, at(2, 30)) - 12) < 2.5, JSON.stringify(corner));
  const last = region.at(-1) ?? at(0, 0);
  assert.ok(angleDeg(last, region[0] ?? last) > 0.5, "the last corner repeats the first");
});

/** A click, a line of two directions and nothing are no region. */
test("a click or a line is no region", () => {
  assert.equal(regionFromTrail([]), null);
  assert.equal(regionFromTrail([at(10, 10), at(10.5, 10), at(10, 10.5)]), null);
  assert.equal(regionFromTrail([at(10, 10), at(40, 10)]), null);
});

/** A region's text gives it back, and other texts give none. */
test("a region's text gives it back", () => {
  const region = [at(350.5, 3), at(10, 3), at(0, 33.3)];
  assert.equal(textFromRegion(region), "350.5,3;10,3;0,33.3");
  assert.deepEqual(regionFromText(textFromRegion(region)), region);
  for (const text of [null, "", "1,2;3,4", "1,2;3,4;5", "1,2;3,4;5,91", "1,2;3,4;400,6", "1,2;3,4;a,b", "1,2;3,4;5,6;"])
    assert.equal(regionFromText(text), null, String(text));
});

test("an outline follows great circles and closes", () => {
  const points = outline([at(0, 0), at(90, 0), at(0, 90)]);
  assert.deepEqual(points[0], points.at(-1));
  assert.ok(points.length > 90);
  for (const [i, point] of points.entries()) if (i > 0) assert.ok(angleDeg(points[i - 1] ?? point, point) < 2.1);
  // Between the horizon's east and the zenith it keeps to the east.
  assert.ok(points.some(({ azimuthDeg, elevationDeg }) => Math.abs(azimuthDeg - 90) < 1e-6 && Math.abs(elevationDeg - 44) < 3));
});
