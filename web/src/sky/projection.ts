// Where a direction of the sky lies on the picture, and back.

export type ProjectionName = "equirectangular" | "fisheye";

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

export interface Projection {
  readonly name: ProjectionName;
  /** The direction at a point of the canvas, null outside the sky. */
  direction_from_point(x_px: number, y_px: number): SkyDirection | null;
  /** The point of a direction. */
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

const COMPASS = ["N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"];

/** The nearest of sixteen compass directions. */
export function compass_name(azimuth_deg: number): string {
  return COMPASS[Math.round((((azimuth_deg % 360) + 360) % 360) / 22.5) % 16] ?? "N";
}
