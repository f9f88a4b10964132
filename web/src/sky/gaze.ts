// Where the perspective looks, and how dragging and zooming change it.

import type { SkyGrid } from "./grid.ts";
import type { Gaze } from "./projection.ts";

const RADIANS = Math.PI / 180;
const FIELD_DEG = { initial: 55, min: 15, max: 110 };
/** How far the eye is raised from the brightest light, which is low. */
const INITIAL_ELEVATION_DEG = 17;
/** The server draws no wider perspective. */
const MAX_FOV_DEG = 150;
/** The field of view grows or shrinks by this at each step. */
export const ZOOM_STEP = 1.15;

/** What a perspective shows, as the API takes it: `fov` from the left to the right edge. */
export interface ViewedPart {
  azimuth: number;
  elevation: number;
  fov: number;
}

/** The gaze of the state; where there is none, towards the brightest light. */
export function gazeOf(gaze: Gaze | null, grid: SkyGrid | null): Gaze {
  if (gaze !== null) return gaze;
  return { azimuthDeg: grid?.brightest().azimuthDeg ?? 180, elevationDeg: INITIAL_ELEVATION_DEG, fieldDeg: FIELD_DEG.initial };
}

/** Never below the ground by much, nor beyond the zenith. */
export function clampGaze(gaze: Gaze): Gaze {
  return { ...gaze, elevationDeg: Math.min(Math.max(gaze.elevationDeg, -10), 90) };
}

/** The picture follows a pointer that moves by that much, CSS pixels, over a plot of that height. */
export function turnGaze(gaze: Gaze, rightPx: number, downPx: number, heightPx: number): Gaze {
  const degreesAPx = gaze.fieldDeg / heightPx;
  // Near the zenith a degree of azimuth is a short way.
  const around = degreesAPx / Math.max(Math.cos(gaze.elevationDeg * RADIANS), 0.25);
  return clampGaze({
    azimuthDeg: (gaze.azimuthDeg - rightPx * around + 720) % 360,
    elevationDeg: gaze.elevationDeg + downPx * degreesAPx,
    fieldDeg: gaze.fieldDeg,
  });
}

export function zoomGaze(gaze: Gaze, factor: number): Gaze {
  return clampGaze({ ...gaze, fieldDeg: Math.min(Math.max(gaze.fieldDeg * factor, FIELD_DEG.min), FIELD_DEG.max) });
}

/** What a perspective shows on a plot of that width by its height. */
export function viewedPart({ azimuthDeg, elevationDeg, fieldDeg }: Gaze, aspect: number): ViewedPart {
  const halfRad = Math.atan(Math.tan((fieldDeg / 2) * RADIANS) * aspect);
  return {
    azimuth: +azimuthDeg.toFixed(1),
    elevation: +elevationDeg.toFixed(1),
    fov: Math.min(+((2 * halfRad) / RADIANS).toFixed(1), MAX_FOV_DEG),
  };
}
