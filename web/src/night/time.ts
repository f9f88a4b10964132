// The instants of a night: which night a time belongs to, the Sun and the Moon over it, and clocks there.

import type { Night } from "../api/types.ts";
import { placeWords } from "../language/words.ts";

export const MINUTE_MS = 60_000;
const HOUR_MS = 60 * MINUTE_MS;
const DAY_MS = 24 * HOUR_MS;
/** A browser's clock further from the Sun's than this is that of another part of the world. */
const MAX_CLOCK_DIFFERENCE_H = 2.6;

/** An instant in whole minutes, as the state has it. */
export function timeOf(instantMs: number): string {
  return new Date(Math.round(instantMs / MINUTE_MS) * MINUTE_MS).toISOString().replace(".000", "");
}

/** Date of the evening of the night, from noon to noon in local mean solar time, that an instant lies in. */
export function eveningOf(instantMs: number, longitudeDeg: number): string {
  return new Date(instantMs + (longitudeDeg / 360 - 0.5) * DAY_MS).toISOString().slice(0, 10);
}

/** Date of the evening of the coming night; after midnight, of the one that goes on. */
export function eveningOfTonight(nowMs: number, longitudeDeg: number): string {
  return eveningOf(nowMs + 6 * HOUR_MS, longitudeDeg);
}

/** What the sky is like from one instant to another, by how deep the Sun is. */
export type Darkness = "day" | "civil" | "nautical" | "astronomical" | "night";

export interface Part {
  fromMs: number;
  untilMs: number;
}

const instantMs = (utc: string): number => Date.parse(utc);

/** The part of a night that is worth looking at: from sunset to sunrise, and where the Sun does not set all of it. */
export function rangeOf({ sun, from_utc, until_utc }: Night): Part {
  return { fromMs: instantMs(sun.set_utc ?? from_utc), untilMs: instantMs(sun.rise_utc ?? until_utc) };
}

/** The Sun below each limit, the outer part first; where it stays above one, there is none. */
export function darknessOf(night: Night): (Part & { darkness: Darkness })[] {
  const range = rangeOf(night);
  const parts: (Part & { darkness: Darkness })[] = [];
  if (night.sun.stays === "above") return [{ ...range, darkness: "day" }];
  parts.push({ ...range, darkness: "civil" });
  const inner = { civil: "nautical", nautical: "astronomical", astronomical: "night" } as const;
  for (const { kind, evening_end_utc, morning_begin_utc, sun_stays } of night.twilights) {
    if (sun_stays === "above") break;
    const fromMs = evening_end_utc == null ? range.fromMs : instantMs(evening_end_utc);
    const untilMs = morning_begin_utc == null ? range.untilMs : instantMs(morning_begin_utc);
    parts.push({ fromMs, untilMs, darkness: inner[kind] });
  }
  return parts;
}

/** When the Moon is above the horizon. */
export function moonParts({ moon, from_utc, until_utc }: Night): Part[] {
  const [fromMs, untilMs] = [instantMs(from_utc), instantMs(until_utc)];
  if (moon.stays != null) return moon.stays === "above" ? [{ fromMs, untilMs }] : [];
  const rises = moon.rises_utc.map(instantMs);
  const sets = moon.sets_utc.map(instantMs);
  const [firstSet = Number.POSITIVE_INFINITY] = sets;
  const begins = firstSet < (rises[0] ?? Number.POSITIVE_INFINITY) ? [fromMs, ...rises] : rises;
  return begins.map((beginMs) => ({ fromMs: beginMs, untilMs: sets.find((setMs) => setMs > beginMs) ?? untilMs }));
}

/** How deep the Sun is at an instant. */
export function darknessAt(night: Night, atMs: number): Darkness {
  const inside = darknessOf(night).filter(({ fromMs, untilMs }) => atMs >= fromMs && atMs <= untilMs);
  return inside.at(-1)?.darkness ?? "day";
}

/** The middle of the longest dark part; without one, when the Sun is lowest. */
export function darkestOf({ dark_intervals, sun }: Night): number {
  const longest = [...dark_intervals].sort((a, b) => b.hours - a.hours)[0];
  return longest === undefined ? instantMs(sun.lowest_utc) : (instantMs(longest.from_utc) + instantMs(longest.until_utc)) / 2;
}

/** A clock for a place: the browser's own where it can be that of the place, else whole hours from UTC. */
export interface Clock {
  /** In minutes, east of Greenwich positive. */
  offsetMinutes: number;
  name: string;
}

export function clockAt(atMs: number, longitudeDeg: number, browserOffsetMinutes = -new Date(atMs).getTimezoneOffset()): Clock {
  const solarHours = longitudeDeg / 15;
  const isNear = Math.abs(browserOffsetMinutes / 60 - solarHours) <= MAX_CLOCK_DIFFERENCE_H;
  const offsetMinutes = isNear ? browserOffsetMinutes : 60 * Math.round(solarHours);
  if (offsetMinutes === 0) return { offsetMinutes, name: "UTC" };
  const [hours, minutes] = [Math.floor(Math.abs(offsetMinutes) / 60), Math.abs(offsetMinutes) % 60];
  const part = minutes === 0 ? "" : `:${String(minutes).padStart(2, "0")}`;
  return { offsetMinutes, name: `UTC${offsetMinutes < 0 ? "−" : "+"}${hours}${part}` };
}

/** `23:05` */
export function clockTime(atMs: number, { offsetMinutes }: Clock): string {
  return new Date(atMs + offsetMinutes * MINUTE_MS).toISOString().slice(11, 16);
}

/** Hours and minutes, as `4 h 05`. */
export function hoursText(hours: number): string {
  const minutes = Math.round(hours * 60);
  return placeWords().time.hours(String(Math.floor(minutes / 60)), String(minutes % 60).padStart(2, "0"));
}

/** Hours that are written below a line are at least this part of its length apart: so wide is a time on a phone. */
const MIN_HOUR_STEP = 0.11;
/** The first and the last time stand inside the line's ends, and reach farther in. */
const MIN_END_STEP = 0.165;

/** Whole hours that are written below the line of a night, clear of the times at its ends. */
export function shownHours({ fromMs, untilMs }: Part, { offsetMinutes }: Clock): number[] {
  const lengthMs = untilMs - fromMs;
  const step = [1, 2, 3, 4, 6].find((hours) => (hours * HOUR_MS) / lengthMs >= MIN_HOUR_STEP) ?? 12;
  const offsetMs = offsetMinutes * MINUTE_MS;
  const first = Math.ceil((fromMs + offsetMs) / (step * HOUR_MS)) * step * HOUR_MS - offsetMs;
  const hours: number[] = [];
  for (let ms = first; ms < untilMs; ms += step * HOUR_MS)
    if (Math.min(ms - fromMs, untilMs - ms) / lengthMs >= MIN_END_STEP) hours.push(ms);
  return hours;
}
