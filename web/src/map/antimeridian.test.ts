import assert from "node:assert/strict";
import { test } from "node:test";
import { unwrappedLine, unwrappedRing } from "./antimeridian.ts";

/** A line over the antimeridian goes on past 180°, either way. */
test("lines go on past the antimeridian", () => {
  const east = [
    [178, -17],
    [-179, -16],
    [179, -18],
  ];
  assert.deepEqual(unwrappedLine(east), [
    [178, -17],
    [181, -16],
    [179, -18],
  ]);
  const west = [
    [-179, 66],
    [179, 67],
  ];
  assert.deepEqual(unwrappedLine(west), [
    [-179, 66],
    [-181, 67],
  ]);
});

/** A ring around a pole is closed by way of the pole; others stay as they are. */
test("a ring around the pole is closed there", () => {
  const around = [
    [-170, -75],
    [-60, -70],
    [60, -68],
    [170, -72],
    [-170, -75],
  ];
  assert.deepEqual(unwrappedRing(around).slice(4), [
    [190, -75],
    [190, -90],
    [-170, -90],
    [-170, -75],
  ]);
  const square = [
    [0, 0],
    [1, 0],
    [1, 1],
    [0, 0],
  ];
  assert.deepEqual(unwrappedRing(square), square);
});
