import assert from "node:assert/strict";
import { test } from "node:test";
import type { CalendarNight } from "../api/types.ts";
import { darkWeekend, middleOfDark, twoMonths } from "./weekend.ts";

const night = (date: string, darkHours: number) =>
  ({ date, dark_hours: darkHours, dark_intervals: [] }) as unknown as CalendarNight;

/** The first weekend with hours enough, of its nights the darker; else the darkest; never a night in the week or in the past. */
test("the next dark weekend is found", () => {
  // 2026-08-07 and 08 are a Friday and a Saturday.
  const nights = [night("2026-07-31", 9), night("2026-08-05", 9), night("2026-08-07", 1), night("2026-08-08", 0)];
  const later = [night("2026-08-14", 5), night("2026-08-15", 6), night("2026-08-21", 8)];
  assert.equal(darkWeekend([...nights, ...later], "2026-08-01")?.date, "2026-08-15");
  assert.equal(darkWeekend(nights, "2026-08-01")?.date, "2026-08-07");
  assert.equal(darkWeekend(nights, "2026-08-08"), null);
});

test("two months go over the year's end", () => {
  assert.deepEqual(twoMonths("2026-11-29"), ["2026-11", "2026-12"]);
  assert.deepEqual(twoMonths("2026-12-01"), ["2026-12", "2027-01"]);
});

test("the middle of the longest dark part", () => {
  const part = (fromUtc: string, untilUtc: string) => ({ from_utc: fromUtc, until_utc: untilUtc });
  const darkIntervals = [
    part("2026-08-12T20:00:00Z", "2026-08-12T21:00:00Z"),
    part("2026-08-12T23:00:00Z", "2026-08-13T03:00:00Z"),
  ] as CalendarNight["dark_intervals"];
  assert.equal(middleOfDark({ dark_intervals: darkIntervals }), Date.parse("2026-08-13T01:00:00Z"));
  assert.equal(middleOfDark({ dark_intervals: [] }), null);
});
