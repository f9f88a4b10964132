// Where a direction of the sky lies on the picture, and back.

import { words } from "../language/words.ts";

export const PROJECTIONS = ["equirectangular", "fisheye", "perspective"] as const;
export type ProjectionName = (typeof PROJECTIONS)[number];

/** A rectangle of the canvas, CSS pixels. */
export interface Plot {
  leftPx: number;
  topPx: number;
  widthPx: number;
  heightPx: number;
}

export interface SkyDirection {
  azimuthDeg: number;
  elevationDeg: number;
}

/** Where one looks, and how much of the sky fits between the picture's lower and upper edge. */
export interface Gaze extends SkyDirection {
  fieldDeg: number;
}

const RADIANS = Math.PI / 180;

/** East, north, up. */
export type Vector = readonly [number, number, number];

export function vectorFromDirection({ azimuthDeg, elevationDeg }: SkyDirection): Vector {
  const [azimuth, elevation] = [azimuthDeg * RADIANS, elevationDeg * RADIANS];
  return [Math.cos(elevation) * Math.sin(azimuth), Math.cos(elevation) * Math.cos(azimuth), Math.sin(elevation)];
}

/** Of a vector of any length. */
export function directionFromVector([east, north, up]: Vector): SkyDirection {
  return {
    azimuthDeg: (Math.atan2(east, north) / RADIANS + 360) % 360,
    elevationDeg: Math.atan2(up, Math.hypot(east, north)) / RADIANS,
  };
}

export interface Projection {
  readonly name: ProjectionName;
  /** The direction at a point of the canvas, null outside the picture; below the horizon its elevation is negative. */
  directionFromPoint(xPx: number, yPx: number): SkyDirection | null;
  /** The point of a direction; of one behind the observer it is not a number, and no canvas draws there. */
  pointFromDirection(direction: SkyDirection): { xPx: number; yPx: number };
}

/** Azimuth to the right with north at the left edge, zenith at the top. */
export function equirectangular(plot: Plot): Projection {
  return {
    name: "equirectangular",
    directionFromPoint(xPx, yPx) {
      const across = (xPx - plot.leftPx) / plot.widthPx;
      const down = (yPx - plot.topPx) / plot.heightPx;
      if (across < 0 || across > 1 || down < 0 || down > 1) return null;
      return { azimuthDeg: (across * 360) % 360, elevationDeg: 90 * (1 - down) };
    },
    pointFromDirection({ azimuthDeg, elevationDeg }) {
      return {
        xPx: plot.leftPx + (azimuthDeg / 360) * plot.widthPx,
        yPx: plot.topPx + (1 - elevationDeg / 90) * plot.heightPx,
      };
    },
  };
}

/** Zenithal equidistant as on sky charts: zenith in the middle, north up, east LEFT (the sky seen from below). */
export function fisheye(plot: Plot): Projection {
  const radiusPx = Math.min(plot.widthPx, plot.heightPx) / 2;
  const x0Px = plot.leftPx + plot.widthPx / 2;
  const y0Px = plot.topPx + plot.heightPx / 2;
  return {
    name: "fisheye",
    directionFromPoint(xPx, yPx) {
      const eastPx = x0Px - xPx;
      const northPx = y0Px - yPx;
      const distancePx = Math.hypot(eastPx, northPx);
      if (distancePx > radiusPx) return null;
      const azimuthDeg = (Math.atan2(eastPx, northPx) * 180) / Math.PI;
      return { azimuthDeg: (azimuthDeg + 360) % 360, elevationDeg: 90 * (1 - distancePx / radiusPx) };
    },
    pointFromDirection({ azimuthDeg, elevationDeg }) {
      const distancePx = (1 - elevationDeg / 90) * radiusPx;
      const azimuthRad = (azimuthDeg * Math.PI) / 180;
      return { xPx: x0Px - distancePx * Math.sin(azimuthRad), yPx: y0Px - distancePx * Math.cos(azimuthRad) };
    },
  };
}

/** Directions nearer than this to the side lie outside every picture. */
const MIN_FORWARD = 0.05;

/** What one sees looking there: straight lines stay straight. */
export function perspective(plot: Plot, gaze: Gaze): Projection {
  const [azimuth, elevation] = [gaze.azimuthDeg * RADIANS, gaze.elevationDeg * RADIANS];
  const x0Px = plot.leftPx + plot.widthPx / 2;
  const y0Px = plot.topPx + plot.heightPx / 2;
  const focalPx = plot.heightPx / 2 / Math.tan((gaze.fieldDeg / 2) * RADIANS);
  const ahead = vectorFromDirection(gaze);
  const right = [Math.cos(azimuth), -Math.sin(azimuth), 0] as const;
  const above = [-Math.sin(elevation) * Math.sin(azimuth), -Math.sin(elevation) * Math.cos(azimuth), Math.cos(elevation)] as const;
  return {
    name: "perspective",
    directionFromPoint(xPx, yPx) {
      const across = xPx - x0Px;
      const up = y0Px - yPx;
      if (Math.abs(across) > plot.widthPx / 2 || Math.abs(up) > plot.heightPx / 2) return null;
      const east = focalPx * ahead[0] + across * right[0] + up * above[0];
      const north = focalPx * ahead[1] + across * right[1] + up * above[1];
      const height = focalPx * ahead[2] + up * above[2];
      return directionFromVector([east, north, height]);
    },
    pointFromDirection(direction) {
      const [east, north, height] = vectorFromDirection(direction);
      const forward = east * ahead[0] + north * ahead[1] + height * ahead[2];
      if (forward < MIN_FORWARD) return { xPx: NaN, yPx: NaN };
      return {
        xPx: x0Px + (focalPx * (east * right[0] + north * right[1])) / forward,
        yPx: y0Px - (focalPx * (east * above[0] + north * above[1] + height * above[2])) / forward,
      };
    },
  };
}

/** The nearest of sixteen compass directions. */
export function compassName(azimuthDeg: number): string {
  return words().compass[Math.round((((azimuthDeg % 360) + 360) % 360) / 22.5) % 16] ?? "";
}
