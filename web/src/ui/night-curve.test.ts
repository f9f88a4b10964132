import assert from "node:assert/strict";
import { test } from "node:test";
import type { NightHour, NightHours } from "../api/types.ts";
import { loadWords } from "../language/words.ts";
import { bestOf, bestText, curveHeight, curvePoints } from "./night-curve.ts";

await loadWords("place");

const hour = (utc: string, mag: number | null) =>
  ({ time: `2026-08-12T${utc}:00Z`, zenith_total_brightness_mag_arcsec2: mag }) as NightHour;
const HOURS = [hour("18:00", 8), hour("19:00", 16), hour("20:00", 19), hour("21:00", 22), hour("22:00", null), hour("23:00", 12)];
const RANGE = { fromMs: Date.parse("2026-08-12T19:00Z"), untilMs: Date.parse("2026-08-12T22:00Z") };

/** Darker is higher, on one scale for all nights, and daylight lies at its foot. */
test("a darker zenith is higher in the curve", () => {
  assert.deepEqual([4, 16, 19, 22, 23].map(curveHeight), [0, 0, 0.5, 1, 1]);
});

/** The curve reaches past both ends of the night, and leaves out hours without a number. */
test("the curve reaches to both ends", () => {
  const rounded = curvePoints(HOURS, RANGE).map(([x, y]) => [Math.round(x), y]);
  assert.deepEqual(rounded, [
    [-33, 100],
    [0, 100],
    [33, 50],
    [67, 0],
    [133, 100],
  ]);
});

test("the best hour is told with its clock", () => {
  const hours = { best_hour: "2026-08-12T21:00:00Z", hours: HOURS } as NightHours;
  assert.deepEqual(bestOf(hours), { atMs: Date.parse("2026-08-12T21:00Z"), mag: 22 });
  assert.equal(
    bestText(hours, { offsetMinutes: 120, name: "UTC+2" }),
    "Best at 23:00: 22.0 mag/arcsec² overhead under a clear sky.",
  );
  assert.equal(bestText({ ...hours, best_hour: null }, { offsetMinutes: 0, name: "UTC" }), "");
});
