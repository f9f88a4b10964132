// How large pictures are that are saved: the shape of what the page shows, and no more pixels than the server draws.

import type { ProjectionName } from "../sky/projection.ts";
import type { PictureMore } from "./picture-url.ts";

/** What a picture is saved for: to look at, for a large screen or print, or to move. */
export const SIZES = ["screen", "4k", "moving"] as const;
export type SavedSize = (typeof SIZES)[number];

/** The longest side, and the most pixels in all. The server takes eight million. */
const MOST: Readonly<Record<SavedSize, readonly [sidePx: number, pixels: number]>> = {
  screen: [2048, 2048 * 1152],
  "4k": [3840, 3840 * 2160],
  moving: [1280, 1280 * 720],
};

/** @param skyAspect width of the page's picture by its height, which a perspective has anew */
export function savedSizePx(
  projection: ProjectionName,
  skyAspect: number,
  size: SavedSize,
): Required<Pick<PictureMore, "width" | "height_px">> {
  const aspect = { equirectangular: 4, fisheye: 1, perspective: skyAspect }[projection];
  const [sidePx, pixels] = MOST[size];
  const width = Math.floor(Math.min(sidePx, sidePx * aspect, Math.sqrt(pixels * aspect)));
  return { width, height_px: Math.floor(width / aspect) };
}
