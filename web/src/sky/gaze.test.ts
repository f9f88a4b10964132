import assert from "node:assert/strict";
import { test } from "node:test";
import { gazeOf, turnGaze, viewedPart, zoomGaze } from "./gaze.ts";

const GAZE = { azimuthDeg: 10, elevationDeg: 0, fieldDeg: 60 };

test("the sky follows the pointer that drags it", () => {
  assert.deepEqual(turnGaze(GAZE, 100, 50, 600), { azimuthDeg: 0, elevationDeg: 5, fieldDeg: 60 });
  assert.deepEqual(turnGaze(GAZE, 200, 5000, 600), { azimuthDeg: 350, elevationDeg: 90, fieldDeg: 60 });
  // Near the zenith azimuths are close together: four times as many degrees, never more.
  assert.equal(turnGaze({ ...GAZE, elevationDeg: 90 }, -100, 0, 600).azimuthDeg, 50);
});

test("zoom ends at both ends of the field", () => {
  assert.equal(zoomGaze(GAZE, 1.5).fieldDeg, 90);
  assert.equal(zoomGaze(GAZE, 9).fieldDeg, 110);
  assert.equal(zoomGaze(GAZE, 0.1).fieldDeg, 15);
});

test("the server is asked for the same view", () => {
  assert.deepEqual(viewedPart(GAZE, 1), { azimuth: 10, elevation: 0, fov: 60 });
  // tan 30° · √3 = 1: 45° to each side.
  assert.equal(viewedPart(GAZE, Math.sqrt(3)).fov, 90);
  assert.equal(viewedPart({ ...GAZE, fieldDeg: 110 }, 9).fov, 150);
  assert.deepEqual(gazeOf(null, null), { azimuthDeg: 180, elevationDeg: 17, fieldDeg: 55 });
});
