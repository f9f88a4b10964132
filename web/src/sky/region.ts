// A part of the sky inside a closed curve of great circles (spherical linear interpolation, Shoemake 1985).

import { directionFromVector, type SkyDirection, vectorFromDirection } from "./projection.ts";

/** Corners of a closed curve; its sides are great circles, the last corner is joined to the first. */
export type Region = readonly SkyDirection[];

const RADIANS = Math.PI / 180;
/** Corners of a drawn curve, so that links stay short. */
const MAX_CORNERS = 80;
const MIN_STEP_DEG = 1;
/** Smaller than this is a click, not a curve. */
const MIN_EXTENT_DEG = 2;

/** The angle between two directions, degrees. */
export function angleDeg(a: SkyDirection, b: SkyDirection): number {
  const [ax, ay, az] = vectorFromDirection(a);
  const [bx, by, bz] = vectorFromDirection(b);
  const cross = Math.hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
  return Math.atan2(cross, ax * bx + ay * by + az * bz) / RADIANS;
}

/** The corners of a curve that was drawn through these directions; null where it encloses nothing. */
export function regionFromTrail(trail: Region): Region | null {
  const first = trail[0];
  if (first === undefined || !trail.some((direction) => angleDeg(first, direction) > MIN_EXTENT_DEG)) return null;
  for (let stepDeg = MIN_STEP_DEG; ; stepDeg *= 1.5) {
    const corners = thinned(trail, stepDeg);
    if (corners.length > MAX_CORNERS) continue;
    return corners.length < 3 ? null : corners.map(rounded);
  }
}

/** The trail with at least that angle between neighbours, the last and the first included. */
function thinned(trail: Region, stepDeg: number): SkyDirection[] {
  const corners: SkyDirection[] = [];
  for (const direction of trail) {
    const before = corners.at(-1);
    if (before === undefined || angleDeg(before, direction) >= stepDeg) corners.push(direction);
  }
  const [first] = corners;
  while (first !== undefined && corners.length > 3 && angleDeg(first, corners.at(-1) ?? first) < stepDeg) corners.pop();
  return corners;
}

function rounded({ azimuthDeg, elevationDeg }: SkyDirection): SkyDirection {
  return {
    azimuthDeg: +(((azimuthDeg % 360) + 360) % 360).toFixed(1),
    elevationDeg: +Math.min(Math.max(elevationDeg, 0), 90).toFixed(1),
  };
}

/** As the API takes it: `azimuth,elevation;azimuth,elevation;…`. */
export function textFromRegion(region: Region): string {
  return region.map(({ azimuthDeg, elevationDeg }) => `${azimuthDeg},${elevationDeg}`).join(";");
}

/** Reads what `textFromRegion` writes; null where it is no region. */
export function regionFromText(text: string | null): Region | null {
  if (text === null || !/^(-?[0-9.]{1,8},[0-9.]{1,8})(;-?[0-9.]{1,8},[0-9.]{1,8}){2,999}$/.test(text)) return null;
  const corners = text.split(";").map((corner) => {
    const [azimuthDeg = NaN, elevationDeg = NaN] = corner.split(",").map(Number);
    return { azimuthDeg, elevationDeg };
  });
  const isMeant = ({ azimuthDeg, elevationDeg }: SkyDirection) =>
    Math.abs(azimuthDeg) <= 360 && elevationDeg >= 0 && elevationDeg <= 90;
  return corners.every(isMeant) ? corners : null;
}

/** Directions along the curve, close enough together to be joined by straight lines; the first comes again at the end. */
export function outline(region: Region, stepDeg = 2): SkyDirection[] {
  const points: SkyDirection[] = [];
  region.forEach((from, i) => {
    const to = region[(i + 1) % region.length] ?? from;
    const sideDeg = angleDeg(from, to);
    const steps = Math.max(Math.ceil(sideDeg / stepDeg), 1);
    for (let step = 0; step < steps; step++) points.push(between(from, to, step / steps, sideDeg));
  });
  return points.length === 0 ? points : [...points, points[0] as SkyDirection];
}

/** A direction on the great circle from one to the other. */
function between(from: SkyDirection, to: SkyDirection, part: number, sideDeg: number): SkyDirection {
  const sine = Math.sin(sideDeg * RADIANS);
  if (part === 0 || sine < 1e-9) return from;
  const a = Math.sin((1 - part) * sideDeg * RADIANS) / sine;
  const b = Math.sin(part * sideDeg * RADIANS) / sine;
  const [ax, ay, az] = vectorFromDirection(from);
  const [bx, by, bz] = vectorFromDirection(to);
  return directionFromVector([a * ax + b * bx, a * ay + b * by, a * az + b * bz]);
}
