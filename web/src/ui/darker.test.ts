import assert from "node:assert/strict";
import { test } from "node:test";
import type { DarkerPlace } from "../api/types.ts";
import { isSamePlace } from "../data/darker-session.ts";
import { loadWords } from "../language/words.ts";
import { darkerName, directionWords } from "./darker.ts";

await loadWords("place");

/** Ranges are told by the names of their ends, across north too, and a whole circle as such. */
test("clean directions are told in words", () => {
  assert.equal(
    directionWords([
      [351.6, 88.6],
      [200, 222],
    ]),
    "N to E, SSW to SW",
  );
  assert.equal(directionWords([[300, 20]]), "WNW to NNE");
  assert.equal(directionWords([[40, 50]]), "NE");
  assert.equal(directionWords([[0, 360]]), "all around");
  assert.equal(directionWords([[10, 8.6]]), "all around");
});

/** A darker place is told by its nearest town, or by coordinates where none is near. */
test("a darker place is told by a town", () => {
  const place = { latitude_deg: 46.28, longitude_deg: 9.46, nearest_place: null } as DarkerPlace;
  assert.equal(darkerName(place), "46.2800° N, 9.4600° E");
  const near = (distanceM: number) => ({
    ...place,
    nearest_place: { name: "Sondrio", distance_m: distanceM, azimuth_deg: 291 },
  });
  assert.equal(darkerName(near(33_760)), "34 km WNW of Sondrio");
  assert.equal(darkerName(near(900)), "Sondrio");
});

/** A place stays the same through the five decimals of a link. */
test("a place of a link is the same place", () => {
  const place = { latitude_deg: 46.279166667, longitude_deg: 9.4625 };
  assert.ok(isSamePlace(place, { latitude_deg: 46.27917, longitude_deg: 9.4625 }));
  assert.ok(!isSamePlace(place, { latitude_deg: 46.2793, longitude_deg: 9.4625 }));
});
