// Four pictures of the land that meet: perspectives a quarter turn wide towards north, east, south and west. The twin of
// `shaders/land.frag`.

import type { Gaze, Vector } from "./projection.ts";

export const FACE_DEG = 90;
/** Azimuths of their middles. */
const FACES_DEG = [0, 90, 180, 270] as const;
/** How many pixels a side has. */
const SIZES_PX = [1024, 1536] as const;
/** What an enlarged picture of the sky has of the window's shorter side. */
const SKY_OF_WINDOW = 0.75;
/** A side of a face by the height of a picture with a field of 70°, so that both are as fine in their middle. */
const SIDE_OF_HEIGHT = 1 / Math.tan((35 * Math.PI) / 180);
/** So much coarser looks the same. */
const COARSER = 0.9;

export interface FacePoint {
  face: number;
  /** From the left edge, 0 to 1. */
  across: number;
  /** From the upper edge; outside 0 to 1 above and below the picture. */
  down: number;
}

/** Where a direction of any length lies. */
export function facePoint([east, north, up]: Vector): FacePoint {
  const isAcross = Math.abs(east) > Math.abs(north);
  const ahead = Math.max(Math.abs(east), Math.abs(north));
  const right = isAcross ? -north * Math.sign(east) : east * Math.sign(north || 1);
  const face = isAcross ? (east > 0 ? 1 : 3) : north < 0 ? 2 : 0;
  return { face, across: 0.5 + (0.5 * right) / ahead, down: 0.5 - (0.5 * up) / ahead };
}

/** What the pictures look at. */
export function faceGazes(): Gaze[] {
  return FACES_DEG.map((azimuthDeg) => ({ azimuthDeg, elevationDeg: 0, fieldDeg: FACE_DEG }));
}

/** As fine as a window of this size shows them, in pixels of the device. */
export function faceSidePx(widthPx: number, heightPx: number): number {
  const wantedPx = COARSER * SIDE_OF_HEIGHT * SKY_OF_WINDOW * Math.min(widthPx, heightPx);
  return SIZES_PX.find((sidePx) => sidePx >= wantedPx) ?? SIZES_PX[SIZES_PX.length - 1] ?? 1024;
}
