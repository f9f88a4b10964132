// Lines and fonts of what is drawn over the sky.

import type { Plot, Projection, SkyDirection } from "./projection.ts";

export function font(sizePx: number, weight = 500): string {
  return `${weight} ${sizePx}px system-ui, sans-serif`;
}

export function clip(context: CanvasRenderingContext2D, plot: Plot): void {
  context.beginPath();
  context.rect(plot.leftPx, plot.topPx, plot.widthPx, plot.heightPx);
  context.clip();
}

/** A line through directions, broken where it passes the end of a strip or goes behind the observer. */
export function trace(context: CanvasRenderingContext2D, projection: Projection, directions: readonly SkyDirection[]): void {
  context.beginPath();
  let beforeDeg: number | null = null;
  for (const direction of directions) {
    const { xPx, yPx } = projection.pointFromDirection(direction);
    const isAround =
      projection.name === "equirectangular" && beforeDeg !== null && Math.abs(direction.azimuthDeg - beforeDeg) > 180;
    if (beforeDeg === null || isAround) context.moveTo(xPx, yPx);
    else context.lineTo(xPx, yPx);
    beforeDeg = Number.isNaN(xPx) ? null : direction.azimuthDeg;
  }
  context.stroke();
}

/** Pixels from the left and from the top. */
type Point = readonly [number, number];

export function stroke(context: CanvasRenderingContext2D, [from, to]: readonly [Point, Point]): void {
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
}
