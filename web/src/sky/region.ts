// A part of the sky inside a closed curve, as drawn by hand and as the API takes it.

import { direction_from_vector, vector_from_direction, type SkyDirection } from "./projection.ts";

/** Corners of a closed curve; its sides are great circles, the last corner is joined to the first. */
export type Region = readonly SkyDirection[];

const RADIANS = Math.PI / 180;
/** A drawn curve keeps no more corners than this, so that a link stays one. */
const MOST_CORNERS = 80;
const FINEST_STEP_DEG = 1;
/** Smaller than this is a click, not a curve. */
const LEAST_EXTENT_DEG = 2;

/** The angle between two directions, degrees. */
export function angle_deg(a: SkyDirection, b: SkyDirection): number {
  const [ax, ay, az] = vector_from_direction(a);
  const [bx, by, bz] = vector_from_direction(b);
  const cross = Math.hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
  return Math.atan2(cross, ax * bx + ay * by + az * bz) / RADIANS;
}

/** The corners of a curve that was drawn through these directions; null where it encloses nothing. */
export function region_from_trail(trail: Region): Region | null {
  const first = trail[0];
  if (first === undefined || !trail.some((direction) => angle_deg(first, direction) > LEAST_EXTENT_DEG)) return null;
  for (let step_deg = FINEST_STEP_DEG; ; step_deg *= 1.5) {
    const corners = thinned(trail, step_deg);
    if (corners.length > MOST_CORNERS) continue;
    return corners.length < 3 ? null : corners.map(rounded);
  }
}

/** Directions of the trail at least so far from the one before, and the last from the first. */
function thinned(trail: Region, step_deg: number): SkyDirection[] {
  const corners: SkyDirection[] = [];
  for (const direction of trail) {
    const before = corners.at(-1);
    if (before === undefined || angle_deg(before, direction) >= step_deg) corners.push(direction);
  }
  const [first] = corners;
  while (first !== undefined && corners.length > 3 && angle_deg(first, corners.at(-1) ?? first) < step_deg) corners.pop();
  return corners;
}

function rounded({ azimuth_deg, elevation_deg }: SkyDirection): SkyDirection {
  return { azimuth_deg: +(((azimuth_deg % 360) + 360) % 360).toFixed(1), elevation_deg: +Math.min(Math.max(elevation_deg, 0), 90).toFixed(1) };
}

/** As the API takes it: `azimuth,elevation;azimuth,elevation;…`. */
export function text_from_region(region: Region): string {
  return region.map(({ azimuth_deg, elevation_deg }) => `${azimuth_deg},${elevation_deg}`).join(";");
}

/** Reads what `text_from_region` writes; null where it is no region. */
export function region_from_text(text: string | null): Region | null {
  if (text === null || !/^(-?[0-9.]{1,8},[0-9.]{1,8})(;-?[0-9.]{1,8},[0-9.]{1,8}){2,999}$/.test(text)) return null;
  const corners = text.split(";").map((corner) => {
    const [azimuth_deg = NaN, elevation_deg = NaN] = corner.split(",").map(Number);
    return { azimuth_deg, elevation_deg };
  });
  const is_meant = ({ azimuth_deg, elevation_deg }: SkyDirection) => Math.abs(azimuth_deg) <= 360 && elevation_deg >= 0 && elevation_deg <= 90;
  return corners.every(is_meant) ? corners : null;
}

/** Directions along the curve, close enough together to be joined by straight lines; the first comes again at the end. */
export function outline(region: Region, step_deg = 2): SkyDirection[] {
  const points: SkyDirection[] = [];
  region.forEach((from, i) => {
    const to = region[(i + 1) % region.length] ?? from;
    const whole_deg = angle_deg(from, to);
    const steps = Math.max(Math.ceil(whole_deg / step_deg), 1);
    for (let step = 0; step < steps; step++) points.push(between(from, to, step / steps, whole_deg));
  });
  return points.length === 0 ? points : [...points, points[0] as SkyDirection];
}

/** A direction on the great circle from one to the other. */
function between(from: SkyDirection, to: SkyDirection, part: number, whole_deg: number): SkyDirection {
  const sine = Math.sin(whole_deg * RADIANS);
  if (part === 0 || sine < 1e-9) return from;
  const a = Math.sin((1 - part) * whole_deg * RADIANS) / sine;
  const b = Math.sin(part * whole_deg * RADIANS) / sine;
  const [ax, ay, az] = vector_from_direction(from);
  const [bx, by, bz] = vector_from_direction(to);
  return direction_from_vector([a * ax + b * bx, a * ay + b * by, a * az + b * bz]);
}
