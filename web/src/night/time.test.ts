import assert from "node:assert/strict";
import { test } from "node:test";
import type { Night } from "../api/types.ts";
import { loadWords } from "../language/words.ts";
import {
  clockAt,
  clockTime,
  darkestOf,
  darknessAt,
  darknessOf,
  eveningOf,
  eveningOfTonight,
  hoursText,
  moonParts,
  rangeOf,
  shownHours,
  timeOf,
} from "./time.ts";

await loadWords("place");

/** As the server tells the night of 12 August 2026 over Ticino, its Moon made up. */
const AUGUST: Night = {
  date: "2026-08-12",
  site: { latitude_deg: 46, longitude_deg: 8.5, altitude_m: 0 },
  from_utc: "2026-08-12T11:26:00Z",
  until_utc: "2026-08-13T11:26:00Z",
  sun: {
    set_utc: "2026-08-12T18:40:00Z",
    rise_utc: "2026-08-13T04:24:00Z",
    lowest_utc: "2026-08-12T23:31:00Z",
    lowest_altitude_deg: -29,
  },
  twilights: [
    { kind: "civil", evening_end_utc: "2026-08-12T19:12:00Z", morning_begin_utc: "2026-08-13T03:51:00Z" },
    { kind: "nautical", evening_end_utc: "2026-08-12T19:52:00Z", morning_begin_utc: "2026-08-13T03:11:00Z" },
    { kind: "astronomical", evening_end_utc: "2026-08-12T20:36:00Z", morning_begin_utc: "2026-08-13T02:27:00Z" },
  ],
  moon: {
    rises_utc: ["2026-08-13T01:00:00Z"],
    sets_utc: ["2026-08-12T17:00:00Z"],
    transits: [],
    illuminated_fraction: 0.03,
    is_waxing: false,
    magnitude_v: -5,
    phase: "waning_crescent",
    phase_angle_deg: 160,
  },
  astronomical_night: [{ from_utc: "2026-08-12T20:36:00Z", until_utc: "2026-08-13T02:27:00Z", hours: 5.85 }],
  dark_intervals: [{ from_utc: "2026-08-12T20:36:00Z", until_utc: "2026-08-13T01:00:00Z", hours: 4.4 }],
  dark_hours: 4.4,
};
const at = (utc: string) => Date.parse(utc);

/** A night goes from noon to noon of the Sun's own time there. */
test("a time belongs to the night of its evening", () => {
  assert.equal(eveningOf(at("2026-08-12T11:25:00Z"), 8.5), "2026-08-11");
  assert.equal(eveningOf(at("2026-08-12T11:27:00Z"), 8.5), "2026-08-12");
  assert.equal(eveningOf(at("2026-08-13T03:00:00Z"), 8.5), "2026-08-12");
  assert.equal(eveningOf(at("2026-08-13T03:00:00Z"), -150), "2026-08-12");
  assert.equal(eveningOf(at("2026-08-13T03:00:00Z"), 179), "2026-08-13");
  // In the morning the coming night is meant, after midnight the one that goes on.
  assert.equal(eveningOfTonight(at("2026-08-12T09:00:00Z"), 0), "2026-08-12");
  assert.equal(eveningOfTonight(at("2026-08-12T02:00:00Z"), 0), "2026-08-11");
});

test("the Sun's depth follows the twilights", () => {
  assert.deepEqual(
    ["18:30", "18:50", "19:30", "20:10", "23:00"].map((clock) => darknessAt(AUGUST, at(`2026-08-12T${clock}:00Z`))),
    ["day", "civil", "nautical", "astronomical", "night"],
  );
  const white: Night = {
    ...AUGUST,
    twilights: AUGUST.twilights.map((twilight) =>
      twilight.kind === "astronomical" ? { kind: "astronomical", sun_stays: "above" } : twilight,
    ),
  };
  assert.equal(darknessAt(white, at("2026-08-12T23:00:00Z")), "astronomical");
  const summer: Night = { ...AUGUST, sun: { ...AUGUST.sun, set_utc: null, rise_utc: null, stays: "above" } };
  assert.deepEqual(darknessOf(summer), [{ fromMs: at(AUGUST.from_utc), untilMs: at(AUGUST.until_utc), darkness: "day" }]);
});

test("the Moon is up from rise to set", () => {
  const [evening, morning] = moonParts(AUGUST);
  assert.deepEqual(evening, { fromMs: at(AUGUST.from_utc), untilMs: at("2026-08-12T17:00:00Z") });
  assert.deepEqual(morning, { fromMs: at("2026-08-13T01:00:00Z"), untilMs: at(AUGUST.until_utc) });
  assert.deepEqual(moonParts({ ...AUGUST, moon: { ...AUGUST.moon, stays: "below" } }), []);
});

test("the darkest time is amid the longest darkness", () => {
  assert.equal(timeOf(darkestOf(AUGUST)), "2026-08-12T22:48:00Z");
  assert.equal(darkestOf({ ...AUGUST, dark_intervals: [] }), at(AUGUST.sun.lowest_utc));
  assert.equal(rangeOf(AUGUST).fromMs, at("2026-08-12T18:40:00Z"));
});

/** Times are told by the browser's clock where it can be that of the place. */
test("clocks are those of the place", () => {
  const midnight = at("2026-08-12T22:00:00Z");
  assert.equal(clockTime(midnight, clockAt(midnight, 8.5, 120)), "00:00");
  assert.equal(clockAt(midnight, 8.5, 120).name, "UTC+2");
  assert.deepEqual(clockAt(midnight, -70.4, 120), { offsetMinutes: -300, name: "UTC−5" });
  assert.deepEqual(clockAt(midnight, 80, 345), { offsetMinutes: 345, name: "UTC+5:45" });
  assert.equal(clockAt(midnight, 1, 0).name, "UTC");
  assert.equal(hoursText(4.0999), "4 h 06 min");
});

/** The last hour of 06:00 before a sunrise at 07:45 would stand on it. */
test("hours stand clear of the ends of the line", () => {
  const at = (time: string) => Date.parse(`2026-11-29T${time}:00Z`);
  const night = { fromMs: at("15:40"), untilMs: at("15:40") + 16 * 3_600_000 + 300_000 };
  const clock = { offsetMinutes: 0, name: "UTC" };
  const hours = shownHours(night, clock).map((ms) => new Date(ms).getUTCHours());
  assert.deepEqual(hours, [20, 22, 0, 2, 4]);
  const short = { fromMs: at("20:10"), untilMs: at("20:10") + 6.5 * 3_600_000 };
  assert.deepEqual(
    shownHours(short, { ...clock, offsetMinutes: 60 }).map((ms) => new Date(ms).getUTCHours()),
    [22, 23, 0, 1],
  );
});
