// How dark the zenith is over the hours of a night: a curve above the time line, darker higher, and the best hour.

import type { NightHour, NightHours } from "../api/types.ts";
import { placeWords } from "../language/words.ts";
import { type Clock, clockTime, type Part } from "../night/time.ts";
import { make } from "./dom.ts";
import { fixed } from "./format.ts";

/** The scale is the same for every place and night, mag/arcsec²: from a moonlit town to a pristine sky. */
const BRIGHTEST_MAG = 16;
const DARKEST_MAG = 22;
const TICKS_MAG = [18, 20, 22] as const;
const SVG = "http://www.w3.org/2000/svg";

/** Height of a brightness in the curve, 0 at its foot to 1. */
export function curveHeight(mag: number): number {
  return Math.min(Math.max((mag - BRIGHTEST_MAG) / (DARKEST_MAG - BRIGHTEST_MAG), 0), 1);
}

/** Points of the curve in percent from the left and from the top; hours outside the range lead to its ends. */
export function curvePoints(hours: readonly NightHour[], { fromMs, untilMs }: Part): [x: number, y: number][] {
  const points = hours.flatMap((hour): [number, number][] => {
    const mag = hour.zenith_total_brightness_mag_arcsec2;
    if (mag == null) return [];
    return [[(100 * (Date.parse(hour.time) - fromMs)) / (untilMs - fromMs), 100 * (1 - curveHeight(mag))]];
  });
  const before = points.filter(([x]) => x < 0).slice(-1);
  const after = points.filter(([x]) => x > 100).slice(0, 1);
  return [...before, ...points.filter(([x]) => x >= 0 && x <= 100), ...after];
}

function shape(name: string, attributes: Readonly<Record<string, string>>): SVGElement {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}

/** The hour that is best, where one is: when, and how dark. */
export function bestOf({ best_hour, hours }: NightHours): { atMs: number; mag: number } | null {
  const best = hours.find(({ time }) => time === best_hour);
  const mag = best?.zenith_total_brightness_mag_arcsec2;
  return best === undefined || mag == null ? null : { atMs: Date.parse(best.time), mag };
}

/** The best hour in words. */
export function bestText(hours: NightHours, clock: Clock): string {
  const best = bestOf(hours);
  return best === null ? "" : placeWords().time.bestTold(clockTime(best.atMs, clock), fixed(best.mag, 1));
}

/** Draws the curve; without hours its room stays empty. */
export function drawNightCurve(container: HTMLElement, hours: NightHours | null, range: Part): void {
  if (hours === null) {
    container.replaceChildren();
    return;
  }
  const points = curvePoints(hours.hours, range);
  const line = points.map((point) => point.map((value) => value.toFixed(2)).join(",")).join(" ");
  const [first, last] = [points[0], points.at(-1)];
  const svg = shape("svg", { viewBox: "0 0 100 100", preserveAspectRatio: "none" });
  for (const mag of TICKS_MAG) {
    const y = String(100 * (1 - curveHeight(mag)));
    svg.append(shape("line", { class: "curve-tick", x1: "0", x2: "100", y1: y, y2: y }));
  }
  if (first !== undefined && last !== undefined) {
    svg.append(shape("polygon", { class: "curve-area", points: `${first[0]},100 ${line} ${last[0]},100` }));
    svg.append(shape("polyline", { class: "curve-line", points: line }));
  }
  const place = (element: HTMLElement, left: number, top: number) => {
    element.style.left = `${left}%`;
    element.style.top = `${top}%`;
    return element;
  };
  const names = TICKS_MAG.map((mag) => place(make("span", "curve-mag", String(mag)), 0, 100 * (1 - curveHeight(mag))));
  const best = bestOf(hours);
  const x = best === null ? Number.NaN : (100 * (best.atMs - range.fromMs)) / (range.untilMs - range.fromMs);
  const mark = best !== null && x >= 0 && x <= 100 ? [place(make("i", "curve-best"), x, 100 * (1 - curveHeight(best.mag)))] : [];
  container.replaceChildren(svg, ...names, ...mark);
}
