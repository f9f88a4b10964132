// Where a direction of the sky lies on the picture, and back.

import { words } from "../language/words.ts";

export const PROJECTIONS = ["equirectangular", "fisheye", "perspective"] as const;
export type ProjectionName = (typeof PROJECTIONS)[number];

/** A rectangle of the canvas, CSS pixels. */
export interface Plot {
  left_px: number;
  top_px: number;
  width_px: number;
  height_px: number;
}

export interface SkyDirection {
  azimuth_deg: number;
  elevation_deg: number;
}

/** Where one looks, and how much of the sky fits between the picture's lower and upper edge. */
export interface Gaze extends SkyDirection {
  field_deg: number;
}

const RADIANS = Math.PI / 180;

/** East, north, up. */
export type Vector = readonly [number, number, number];

export function vector_from_direction({ azimuth_deg, elevation_deg }: SkyDirection): Vector {
  const [azimuth, elevation] = [azimuth_deg * RADIANS, elevation_deg * RADIANS];
  return [Math.cos(elevation) * Math.sin(azimuth), Math.cos(elevation) * Math.cos(azimuth), Math.sin(elevation)];
}

/** Of a vector of any length. */
export function direction_from_vector([east, north, up]: Vector): SkyDirection {
  return { azimuth_deg: (Math.atan2(east, north) / RADIANS + 360) % 360, elevation_deg: Math.atan2(up, Math.hypot(east, north)) / RADIANS };
}

export interface Projection {
  readonly name: ProjectionName;
  /** The direction at a point of the canvas, null outside the picture; below the horizon its elevation is negative. */
  direction_from_point(x_px: number, y_px: number): SkyDirection | null;
  /** The point of a direction; of one behind the observer it is not a number, and no canvas draws there. */
  point_from_direction(direction: SkyDirection): { x_px: number; y_px: number };
}

/** Azimuth to the right with north at the left edge, zenith at the top. */
export function equirectangular(plot: Plot): Projection {
  return {
    name: "equirectangular",
    direction_from_point(x_px, y_px) {
      const across = (x_px - plot.left_px) / plot.width_px;
      const down = (y_px - plot.top_px) / plot.height_px;
      if (across < 0 || across > 1 || down < 0 || down > 1) return null;
      return { azimuth_deg: (across * 360) % 360, elevation_deg: 90 * (1 - down) };
    },
    point_from_direction({ azimuth_deg, elevation_deg }) {
      return {
        x_px: plot.left_px + (azimuth_deg / 360) * plot.width_px,
        y_px: plot.top_px + (1 - elevation_deg / 90) * plot.height_px,
      };
    },
  };
}

/** Zenithal equidistant as on sky charts: zenith in the middle, north up, east LEFT (the sky seen from below). */
export function fisheye(plot: Plot): Projection {
  const radius_px = Math.min(plot.width_px, plot.height_px) / 2;
  const x0_px = plot.left_px + plot.width_px / 2;
  const y0_px = plot.top_px + plot.height_px / 2;
  return {
    name: "fisheye",
    direction_from_point(x_px, y_px) {
      const east_px = x0_px - x_px;
      const north_px = y0_px - y_px;
      const distance_px = Math.hypot(east_px, north_px);
      if (distance_px > radius_px) return null;
      const azimuth_deg = (Math.atan2(east_px, north_px) * 180) / Math.PI;
      return { azimuth_deg: (azimuth_deg + 360) % 360, elevation_deg: 90 * (1 - distance_px / radius_px) };
    },
    point_from_direction({ azimuth_deg, elevation_deg }) {
      const distance_px = (1 - elevation_deg / 90) * radius_px;
      const azimuth_rad = (azimuth_deg * Math.PI) / 180;
      return { x_px: x0_px - distance_px * Math.sin(azimuth_rad), y_px: y0_px - distance_px * Math.cos(azimuth_rad) };
    },
  };
}

/** Directions nearer than this to the side lie outside every picture. */
const LEAST_FORWARD = 0.05;

/** What one sees looking there: straight lines stay straight. */
export function perspective(plot: Plot, gaze: Gaze): Projection {
  const [azimuth, elevation] = [gaze.azimuth_deg * RADIANS, gaze.elevation_deg * RADIANS];
  const x0_px = plot.left_px + plot.width_px / 2;
  const y0_px = plot.top_px + plot.height_px / 2;
  const focal_px = plot.height_px / 2 / Math.tan((gaze.field_deg / 2) * RADIANS);
  const ahead = vector_from_direction(gaze);
  const right = [Math.cos(azimuth), -Math.sin(azimuth), 0] as const;
  const above = [-Math.sin(elevation) * Math.sin(azimuth), -Math.sin(elevation) * Math.cos(azimuth), Math.cos(elevation)] as const;
  return {
    name: "perspective",
    direction_from_point(x_px, y_px) {
      const across = x_px - x0_px;
      const up = y0_px - y_px;
      if (Math.abs(across) > plot.width_px / 2 || Math.abs(up) > plot.height_px / 2) return null;
      const east = focal_px * ahead[0] + across * right[0] + up * above[0];
      const north = focal_px * ahead[1] + across * right[1] + up * above[1];
      const height = focal_px * ahead[2] + up * above[2];
      return direction_from_vector([east, north, height]);
    },
    point_from_direction(direction) {
      const [east, north, height] = vector_from_direction(direction);
      const forward = east * ahead[0] + north * ahead[1] + height * ahead[2];
      if (forward < LEAST_FORWARD) return { x_px: NaN, y_px: NaN };
      return {
        x_px: x0_px + (focal_px * (east * right[0] + north * right[1])) / forward,
        y_px: y0_px - (focal_px * (east * above[0] + north * above[1] + height * above[2])) / forward,
      };
    },
  };
}

/** The nearest of sixteen compass directions. */
export function compass_name(azimuth_deg: number): string {
  return words().compass[Math.round((((azimuth_deg % 360) + 360) % 360) / 22.5) % 16] ?? "";
}
