// The line of a night: its twilights, its Moon and its dark part, and the time on it that the sky is shown at.

import { api } from "../api/client.ts";
import type { Night } from "../api/types.ts";
import { eveningOfState } from "../data/night-session.ts";
import { placeWords } from "../language/words.ts";
import {
  type Clock,
  clockAt,
  clockTime,
  darkestOf,
  darknessAt,
  darknessOf,
  eveningOfTonight,
  hoursText,
  MINUTE_MS,
  moonParts,
  type Part,
  rangeOf,
  shownHours,
  timeOf,
} from "../night/time.ts";
import { darkWeekend, middleOfDark, twoMonths } from "../night/weekend.ts";
import { type AppState, coordinatesOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, debounced, make } from "./dom.ts";
import { unbroken, whole } from "./format.ts";
import { bestOf, bestText, drawNightCurve } from "./night-curve.ts";

const DAY_MS = 24 * 60 * MINUTE_MS;
/** A slider at rest for this long changes the sky. */
const WAIT_MS = 60;
export class TimeLine {
  private readonly slider = byId("time", HTMLInputElement);
  private readonly date = byId("night-date", HTMLInputElement);
  private readonly told = byId("time-told", HTMLOutputElement);
  private readonly none = byId("time-none", HTMLButtonElement);

  constructor(private readonly store: AppStore) {
    const setSoon = debounced(WAIT_MS, (time: string) => store.set({ time }));
    this.slider.addEventListener("input", () => {
      const time = timeOf(Number(this.slider.value) * MINUTE_MS);
      this.showTime({ ...store.state, time });
      setSoon(time);
    });
    this.date.addEventListener("change", () => this.chooseDate(this.date.value));
    byId("time-now", HTMLButtonElement).addEventListener("click", () => store.set({ time: timeOf(Date.now()) }));
    byId("time-best", HTMLButtonElement).addEventListener("click", () => {
      const { night, nightHours } = store.state;
      const best = nightHours === null ? null : bestOf(nightHours);
      // Until the hours are there, and where none is dark, it goes by the Sun and the Moon.
      if (night !== null) store.set({ time: timeOf(best?.atMs ?? darkestOf(night)) });
    });
    byId("time-weekend", HTMLButtonElement).addEventListener("click", () => {
      this.goToDarkWeekend().catch((reason: unknown) => store.report(reason));
    });
    this.none.addEventListener("click", () => {
      setSoon.cancel();
      store.set({ time: null });
    });
    store.watch(["night"], ({ night, place }) => {
      byId("time-line", HTMLElement).hidden = night === null;
      if (night !== null && place !== null) this.showNight(night, place.longitude_deg);
    });
    store.watch(["nightHours", "night"], ({ nightHours, night, place }) => {
      const curve = byId("night-curve", HTMLElement);
      const told = byId("night-best", HTMLElement);
      told.textContent = "";
      if (night === null || place === null) return;
      const range = rangeOf(night);
      const hours = nightHours?.night.date === night.date ? nightHours : null;
      drawNightCurve(curve, hours, range);
      if (hours !== null) told.textContent = bestText(hours, clockAt(range.fromMs, place.longitude_deg));
    });
    store.watch(["time", "night"], (state) => this.showTime(state));
  }

  /** The same hour of another night; without a time its middle. */
  private chooseDate(date: string): void {
    const { place, time } = this.store.state;
    const before = eveningOfState(this.store.state);
    if (place === null || before === null || Number.isNaN(Date.parse(date))) return;
    const middleMs = Date.parse(date) + DAY_MS * (1 - place.longitude_deg / 360);
    const sameHourMs = time === null ? middleMs : Date.parse(time) + Date.parse(date) - Date.parse(before);
    this.store.set({ time: timeOf(sameHourMs) });
  }

  /** From tonight on, whatever night is shown. */
  private async goToDarkWeekend(): Promise<void> {
    const { place } = this.store.state;
    if (place === null) return;
    const { signal } = new AbortController();
    const today = eveningOfTonight(Date.now(), place.longitude_deg);
    const months = twoMonths(today).map((month) => api.nights(coordinatesOf(place), month, signal));
    const weekend = darkWeekend(
      (await Promise.all(months)).flatMap(({ nights }) => nights),
      today,
    );
    const atMs = weekend === null ? null : middleOfDark(weekend);
    if (this.store.state.place !== place) return;
    if (atMs === null) byId("night-best", HTMLElement).textContent = placeWords().time.noWeekend;
    else this.store.set({ time: timeOf(atMs) });
  }

  private showNight(night: Night, longitudeDeg: number): void {
    const range = rangeOf(night);
    const at = ({ fromMs, untilMs }: Part, className: string): HTMLElement => {
      const part = make("i", className);
      const [left, right] = [fromMs, untilMs].map((ms) => (ms - range.fromMs) / (range.untilMs - range.fromMs));
      part.style.left = `${100 * Math.max(left ?? 0, 0)}%`;
      part.style.right = `${100 * (1 - Math.min(right ?? 1, 1))}%`;
      return part;
    };
    byId("night-parts", HTMLElement).replaceChildren(
      ...darknessOf(night).map((part) => at(part, `night-${part.darkness}`)),
      ...moonParts(night)
        .filter(({ fromMs, untilMs }) => untilMs > range.fromMs && fromMs < range.untilMs)
        .map((part) => at(part, "night-moon")),
    );
    const clock = clockAt(range.fromMs, longitudeDeg);
    byId("night-hours", HTMLElement).replaceChildren(...hourMarks(range, clock));
    byId("night-told", HTMLElement).textContent = unbroken(nightText(night, clock));
    this.date.value = night.date;
    this.slider.min = String(Math.ceil(range.fromMs / MINUTE_MS));
    this.slider.max = String(Math.floor(range.untilMs / MINUTE_MS));
  }

  private showTime({ time, night, place }: Readonly<AppState>): void {
    this.none.setAttribute("aria-pressed", String(time === null));
    this.slider.classList.toggle("no-time", time === null);
    if (night === null || place === null) return;
    const atMs = time === null ? darkestOf(night) : Date.parse(time);
    if (document.activeElement !== this.slider || time === null) this.slider.value = String(Math.round(atMs / MINUTE_MS));
    const text = time === null ? placeWords().time.noneTold : timeText(night, atMs, clockAt(atMs, place.longitude_deg));
    this.told.value = text;
    this.slider.setAttribute("aria-valuetext", text);
  }
}

/** The time, the Sun and the Moon. */
function timeText(night: Night, atMs: number, clock: Clock): string {
  const say = placeWords().time;
  const isMoonUp = moonParts(night).some(({ fromMs, untilMs }) => atMs >= fromMs && atMs <= untilMs);
  const sky = [say.darkness[darknessAt(night, atMs)], ...(isMoonUp ? [say.moonUp] : [])].join(", ");
  return say.told(clockTime(atMs, clock), clock.name, sky);
}

/** When it is dark, and how the Moon is. */
export function nightText(night: Night, clock: Clock): string {
  const { dark_intervals, dark_hours, moon } = night;
  const range = rangeOf(night);
  const say = placeWords().time;
  const at = (utc: string) => clockTime(Date.parse(utc), clock);
  const parts = dark_intervals.map(({ from_utc, until_utc }) => `${at(from_utc)}–${at(until_utc)}`).join(", ");
  const dark = parts === "" ? say.neverDark : say.dark(hoursText(dark_hours), parts);
  // What the Moon does by day is no part of the night.
  const events = [
    ...moon.rises_utc.map((utc) => ({ utc, text: say.rises(at(utc)) })),
    ...moon.sets_utc.map((utc) => ({ utc, text: say.sets(at(utc)) })),
  ]
    .filter(({ utc }) => Date.parse(utc) >= range.fromMs && Date.parse(utc) <= range.untilMs)
    .sort((a, b) => Date.parse(a.utc) - Date.parse(b.utc))
    .map(({ text }) => text);
  const phase = say.moon(say.phases[moon.phase], whole(Math.round(100 * moon.illuminated_fraction)));
  return `${dark} ${[phase, ...events].join(", ")}.`;
}

/** Sunset, sunrise, and whole hours between them. */
function hourMarks({ fromMs, untilMs }: Part, clock: Clock): HTMLElement[] {
  const mark = (atMs: number, className = "") => {
    const element = make("span", className, clockTime(atMs, clock));
    element.style.left = `${(100 * (atMs - fromMs)) / (untilMs - fromMs)}%`;
    return element;
  };
  const hours = shownHours({ fromMs, untilMs }, clock).map((atMs) => mark(atMs));
  return [mark(fromMs, "first"), ...hours, mark(untilMs, "last")];
}
