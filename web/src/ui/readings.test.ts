import assert from "node:assert/strict";
import { test } from "node:test";
import { csvOf, excess, type Reading, readingFrom, readingsFrom, withReading } from "./readings.ts";

const reading: Reading = {
  latitude_deg: 46.17,
  longitude_deg: 8.79,
  readAt: "2026-08-12T22:31:00Z",
  time: null,
  readMag: 20.3,
  modelMag: 20.55,
  scene: "demo",
  turbidity: 2.5,
};

/** Readings are numbers that a meter shows, however they are typed. */
test("readings are what meters show", () => {
  assert.deepEqual(["20.31", " 20,31 ", "", "3", "bright", "25"].map(readingFrom), [20.31, 20.31, null, null, null, null]);
  const { brighterMag, times } = excess(20.3, 20.55);
  assert.ok(Math.abs(brighterMag - 0.25) < 1e-9 && Math.abs(times - 1.2589) < 1e-3);
});

/** What is kept comes back, nonsense does not, and the oldest go. */
test("readings are kept and become a table", () => {
  assert.deepEqual(readingsFrom(JSON.stringify([reading, { readMag: "x" }, null])), [reading]);
  assert.deepEqual([readingsFrom(null), readingsFrom("{"), readingsFrom("{}")], [[], [], []]);
  const many = Array.from({ length: 510 }).reduce<Reading[]>((all) => withReading(all, reading), []);
  assert.equal(many.length, 500);
  const [head, row] = csvOf([reading]).split("\n");
  assert.equal(head?.split(",").length, row?.split(",").length);
  assert.match(row ?? "", /^2026-08-12T22:31:00Z,46.17,8.79,20.30,20.55,,demo,2.5$/);
});
