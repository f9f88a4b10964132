// The next nights of a weekend that are dark for long.

import type { CalendarNight } from "../api/types.ts";

/** Long enough to go out for, hours. */
const ENOUGH_HOURS = 3;
const [FRIDAY, SATURDAY] = [5, 6];

function isOfWeekend({ date }: CalendarNight): boolean {
  const day = new Date(`${date}T12:00:00Z`).getUTCDay();
  return day === FRIDAY || day === SATURDAY;
}

/** The first Friday's or Saturday's night from a date on that is dark for long, of the two the darker; where none is, the darkest. */
export function darkWeekend(nights: readonly CalendarNight[], from: string): CalendarNight | null {
  const coming = nights.filter((night) => night.date >= from && night.dark_hours > 0 && isOfWeekend(night));
  const first = coming.find(({ dark_hours }) => dark_hours >= ENOUGH_HOURS);
  const darker = (a: CalendarNight, b: CalendarNight) => (b.dark_hours > a.dark_hours ? b : a);
  if (first === undefined) return coming.length === 0 ? null : coming.reduce(darker);
  const next = coming[coming.indexOf(first) + 1];
  const isSame = next !== undefined && Date.parse(next.date) - Date.parse(first.date) === 86_400_000;
  return isSame ? darker(first, next) : first;
}

/** The month of a date and the one after it, as `2026-08`. */
export function twoMonths(date: string): [string, string] {
  const [year = 0, month = 1] = date.split("-").map(Number);
  const after = new Date(Date.UTC(year, month, 1));
  return [date.slice(0, 7), after.toISOString().slice(0, 7)];
}

/** The middle of the longest dark part of a night, ms. */
export function middleOfDark({ dark_intervals }: Pick<CalendarNight, "dark_intervals">): number | null {
  const parts = dark_intervals.map(({ from_utc, until_utc }) => [Date.parse(from_utc), Date.parse(until_utc)] as const);
  const [longest] = parts.toSorted(([a, b], [c, d]) => d - c - (b - a));
  return longest === undefined ? null : (longest[0] + longest[1]) / 2;
}
