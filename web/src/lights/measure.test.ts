import assert from "node:assert/strict";
import { test } from "node:test";
import { distanceAndBearing } from "../ui/nearby.ts";
import { circleAround, energyRatio, measureEdit, nightAfter } from "./measure.ts";

const TOWN = { latitude_deg: 46.2, longitude_deg: 9 };
const NOTHING = { lampFrom: null, lampTo: null, emission: null, lightLeft: 1, nightPart: 1 };

/** Every corner is as far from the town as the radius says, and the ring is closed. */
test("a circle is round on the ground", () => {
  const ring = circleAround(TOWN, 5000);
  assert.deepEqual(ring[0], ring.at(-1));
  for (const [longitudeDeg, latitudeDeg] of ring) {
    const { distanceKm } = distanceAndBearing(TOWN, { latitude_deg: latitudeDeg, longitude_deg: longitudeDeg });
    assert.ok(Math.abs(distanceKm - 5) < 0.02, `${distanceKm} km`);
  }
});

/** Towns and areas of all kinds are one edit, with all that changes. */
test("a measure is one edit", () => {
  const square = [
    [
      [8, 46],
      [8.1, 46],
      [8.1, 46.1],
      [8, 46],
    ],
  ];
  const features = [
    { type: "Feature", geometry: { type: "Polygon", coordinates: square } },
    { type: "Feature", geometry: { type: "MultiPolygon", coordinates: [square, square] } },
    { type: "Feature", geometry: null },
  ];
  const change = { lampFrom: "hps", lampTo: "pc_amber", emission: "full_cutoff", lightLeft: 0.7, nightPart: 1 };
  const edit = measureEdit({ towns: [TOWN], radiusM: 3000, features }, change);
  assert.deepEqual(
    { ...edit, polygon: null },
    { polygon: null, factor: 0.7, lamp: { from: "hps", to: "pc_amber" }, emission: "full_cutoff" },
  );
  const { type, coordinates } = (edit?.polygon ?? {}) as { type: string; coordinates: unknown[] };
  assert.deepEqual([type, coordinates.length], ["MultiPolygon", 4]);
});

/** What changes nothing, or nowhere, is none. */
test("a measure changes something somewhere", () => {
  const there = { towns: [TOWN], radiusM: 3000, features: [] };
  assert.equal(measureEdit(there, NOTHING), null);
  assert.equal(measureEdit({ ...there, towns: [] }, { ...NOTHING, lightLeft: 0.5 }), null);
  assert.deepEqual(Object.keys(measureEdit(there, { ...NOTHING, lightLeft: 0 }) ?? {}), ["polygon", "factor"]);
});

/** Dimming alone saves what it dims; of other lamps nobody knows without their lm/W. */
test("energy follows from light and lm/W", () => {
  assert.equal(energyRatio({ ...NOTHING, lightLeft: 0.7 }, { before: null, after: null }), 0.7);
  const replaced = { ...NOTHING, lampTo: "pc_amber", lightLeft: 0.5 };
  assert.equal(energyRatio(replaced, { before: 90, after: null }), null);
  assert.equal(energyRatio(replaced, { before: 90, after: 100 }), 0.45);
  // Dimmed for half of the night alone.
  assert.equal(energyRatio({ ...NOTHING, lightLeft: 0.5, nightPart: 0.5 }, { before: null, after: null }), 0.75);
  assert.equal(energyRatio({ ...replaced, nightPart: 0.5 }, { before: 100, after: 100 }), 0.75);
});

/** Of a night from 18 to 6 half lies after midnight; of one that begins later, all after 23 o'clock. */
test("a part of the night lies after an hour", () => {
  assert.equal(nightAfter(24, [18, 6]), 0.5);
  assert.equal(nightAfter(25, [18, 6]), 5 / 12);
  assert.equal(nightAfter(22, [23, 2]), 1);
  assert.equal(nightAfter(25, [20, 0.5]), 0);
});
