import assert from "node:assert/strict";
import { test } from "node:test";
import type { Night } from "../api/types.ts";
import { lookedAt, midnightOf } from "./tonight.ts";

const NAIROBI = { latitude_deg: -1.28, longitude_deg: 36.82 };

/** A night with these dark hours, the Sun lowest at its middle. */
function night(dark: readonly (readonly [string, string])[], isDeep = true): Night {
  const at = (hour: string) => `2026-11-${hour}:00Z`;
  return {
    dark_intervals: dark.map(([from, until]) => ({ from_utc: at(from), until_utc: at(until), hours: 1 })),
    from_utc: at("29T09:33"),
    until_utc: at("30T09:33"),
    sun: { set_utc: at("29T15:26"), rise_utc: at("30T03:15"), lowest_utc: at("29T21:20") },
    twilights: (["civil", "nautical", "astronomical"] as const).map((kind, i) => ({
      kind,
      evening_end_utc: at(`29T1${6 + i}:00`),
      morning_begin_utc: at(`30T0${2 - i}:00`),
      sun_stays: isDeep ? null : "above",
    })),
  } as unknown as Night;
}

test("tonight's middle goes by the Sun", () => {
  const middle = "2026-11-29T21:33:00Z";
  assert.equal(midnightOf(NAIROBI, Date.parse("2026-11-29T12:00:00Z")), middle);
  // After midnight it is still this night.
  assert.equal(midnightOf(NAIROBI, Date.parse("2026-11-30T01:00:00Z")), middle);
  assert.equal(midnightOf({ ...NAIROBI, longitude_deg: -120 }, Date.parse("2026-11-29T20:00:00Z")), "2026-11-30T08:00:00Z");
});

/** Where the Moon is up at the middle, the dark part is looked at; where nothing is dark, the night; where it is light, none. */
test("a night is looked at where it is dark", () => {
  const middle = "2026-11-29T21:33:00Z";
  assert.equal(lookedAt(night([["29T18:00", "29T23:00"]]), middle), middle);
  assert.equal(lookedAt(night([["29T17:00", "29T19:00"]]), middle), "2026-11-29T18:00:00Z");
  assert.equal(lookedAt(night([]), middle), "2026-11-29T21:20:00Z");
  assert.equal(lookedAt(night([], false), middle), null);
});
