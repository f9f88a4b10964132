// A place is shown as of tonight until someone chooses a time, or none: stars and Milky Way are there, and the sentence counts them.

import type { Night } from "../api/types.ts";
import { darkestOf, darknessAt, eveningOfTonight, timeOf } from "../night/time.ts";
import type { AppStore } from "../state/app-store.ts";
import type { Place } from "../state/view-state.ts";
import { loadSetting, saveSetting } from "../ui/storage.ts";

/** Whether this browser wants no time. */
const KEY = "skyglow.time";
const NONE = "none";
const DAY_MS = 86_400_000;
/** A place as far from the last one, in longitude, has another night. */
const SAME_NIGHT_DEG = 20;

/** The middle of the coming night, or of the one that goes on, by the Sun. */
export function midnightOf({ longitude_deg }: Place, nowMs: number): string {
  return timeOf(Date.parse(eveningOfTonight(nowMs, longitude_deg)) + DAY_MS * (1 - longitude_deg / 360));
}

/** When a night is looked at whose middle may not be dark; null where it is light all through, and a dark sky says more. */
export function lookedAt(night: Pick<Night, "dark_intervals"> & Night, middle: string): string | null {
  const atMs = Date.parse(middle);
  const isDark = night.dark_intervals.some(
    ({ from_utc, until_utc }) => atMs >= Date.parse(from_utc) && atMs <= Date.parse(until_utc),
  );
  if (isDark) return middle;
  const darkestMs = darkestOf(night);
  return ["night", "astronomical"].includes(darknessAt(night, darkestMs)) ? timeOf(darkestMs) : null;
}

/** Sets the time of the first place, and of those after it, until someone else does. A link says its own time, or none. */
export function followTonight(store: AppStore, now: () => number = Date.now): void {
  let isFree = store.state.place === null && store.state.time === null && loadSetting(KEY) !== NONE;
  let own: { time: string; place: Place } | null = null;
  let timeBefore = store.state.time;
  const choose = (place: Place, time: string | null) => {
    own = time === null ? null : { time, place };
    timeBefore = time;
    store.set({ time });
  };
  store.watch(["place", "time"], ({ place, time }) => {
    // Back to the empty page is no choice.
    if (place === null) return;
    if (time !== timeBefore) {
      isFree = false;
      saveSetting(KEY, time === null ? NONE : "");
    }
    timeBefore = time;
    if (store.isLinked) isFree = false;
    if (!isFree) return;
    const isNear = own !== null && own.time === time && Math.abs(own.place.longitude_deg - place.longitude_deg) < SAME_NIGHT_DEG;
    if (!isNear) choose(place, midnightOf(place, now()));
  });
  store.watch(["night"], ({ night, place, time }) => {
    if (!isFree || night === null || place === null || own === null || own.time !== time) return;
    const better = lookedAt(night, own.time);
    if (better === time) return;
    if (better === null) isFree = false;
    choose(place, better);
  });
  // A server without tables of the natural sky knows no times.
  store.watch(["problem"], ({ problem, time }) => {
    const reason = problem?.reason;
    if (!isFree || own === null || own.time !== time || !isAboutTime(reason)) return;
    isFree = false;
    own = null;
    timeBefore = null;
    store.set({ time: null, problem: null });
  });
}

function isAboutTime(reason: unknown): boolean {
  const { problem } = (reason ?? {}) as { problem?: { errors?: { parameter: string }[] } };
  return problem?.errors?.some(({ parameter }) => parameter === "time") === true;
}
