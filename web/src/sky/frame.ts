// The frame of the picture: compass directions and elevation marks of each projection.

import { clip, font, stroke, trace } from "./lines.ts";
import { compassName, type Plot, type Projection } from "./projection.ts";

/** Directions that are named along the horizon; the cardinal ones stand out. */
const NAMED_DEG = [0, 45, 90, 135, 180, 225, 270, 315] as const;
const ELEVATIONS_DEG = [0, 30, 60] as const;

const LINE = "rgba(226, 234, 255, 0.16)";
const TEXT = "#aab6d3";
const STRONG_TEXT = "#eaf0ff";

/** Draws the lines and names that do not change with the pointer. */
export function drawFrame(context: CanvasRenderingContext2D, projection: Projection, plot: Plot): void {
  context.lineWidth = 1;
  context.strokeStyle = LINE;
  if (projection.name === "fisheye") drawFisheyeFrame(context, projection, plot);
  else if (projection.name === "perspective") drawPerspectiveFrame(context, projection, plot);
  else drawStripFrame(context, projection, plot);
}

function drawStripFrame(context: CanvasRenderingContext2D, projection: Projection, plot: Plot): void {
  const rightPx = plot.leftPx + plot.widthPx;
  const bottomPx = plot.topPx + plot.heightPx;
  context.textBaseline = "middle";
  context.textAlign = "right";
  context.font = font(11);
  context.fillStyle = TEXT;
  for (const elevationDeg of [...ELEVATIONS_DEG, 90]) {
    const { yPx } = projection.pointFromDirection({ azimuthDeg: 0, elevationDeg });
    context.fillText(`${elevationDeg}°`, plot.leftPx - 6, Math.min(Math.max(yPx, plot.topPx + 6), bottomPx - 5));
    if (elevationDeg === 0 || elevationDeg === 90) continue;
    stroke(context, [
      [plot.leftPx, yPx],
      [rightPx, yPx],
    ]);
  }
  context.textBaseline = "top";
  for (const azimuthDeg of [...NAMED_DEG, 360]) {
    const { xPx } = projection.pointFromDirection({ azimuthDeg, elevationDeg: 0 });
    const strong = azimuthDeg % 90 === 0;
    context.font = font(strong ? 13 : 11, strong ? 650 : 500);
    context.fillStyle = strong ? STRONG_TEXT : TEXT;
    context.textAlign = azimuthDeg === 0 ? "left" : azimuthDeg === 360 ? "right" : "center";
    context.fillText(compassName(azimuthDeg), xPx, bottomPx + 7);
    if (azimuthDeg > 0 && azimuthDeg < 360)
      stroke(context, [
        [xPx, plot.topPx],
        [xPx, bottomPx + (strong ? 4 : 2)],
      ]);
  }
}

function drawFisheyeFrame(context: CanvasRenderingContext2D, projection: Projection, plot: Plot): void {
  const radiusPx = Math.min(plot.widthPx, plot.heightPx) / 2;
  const x0Px = plot.leftPx + plot.widthPx / 2;
  const y0Px = plot.topPx + plot.heightPx / 2;
  for (const elevationDeg of ELEVATIONS_DEG) {
    context.beginPath();
    context.arc(x0Px, y0Px, radiusPx * (1 - elevationDeg / 90), 0, 2 * Math.PI);
    context.stroke();
  }
  for (const azimuthDeg of [0, 45, 90, 135]) {
    const from = projection.pointFromDirection({ azimuthDeg, elevationDeg: 0 });
    const to = projection.pointFromDirection({ azimuthDeg: azimuthDeg + 180, elevationDeg: 0 });
    stroke(context, [
      [from.xPx, from.yPx],
      [to.xPx, to.yPx],
    ]);
  }
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const azimuthDeg of NAMED_DEG) {
    const { xPx, yPx } = projection.pointFromDirection({ azimuthDeg, elevationDeg: (-13 / radiusPx) * 90 });
    const strong = azimuthDeg % 90 === 0;
    context.font = font(strong ? 13 : 11, strong ? 650 : 500);
    context.fillStyle = strong ? STRONG_TEXT : TEXT;
    context.fillText(compassName(azimuthDeg), xPx, yPx);
  }
  context.font = font(10);
  context.textAlign = "left";
  context.fillStyle = "rgba(234, 240, 255, 0.75)";
  for (const elevationDeg of [30, 60]) {
    const { xPx, yPx } = projection.pointFromDirection({ azimuthDeg: 180, elevationDeg });
    context.fillText(`${elevationDeg}°`, xPx + 4, yPx - 7);
  }
}

/** Degrees between the points of a line that is drawn as straight pieces. */
const LINE_STEP_DEG = 3;

function drawPerspectiveFrame(context: CanvasRenderingContext2D, projection: Projection, plot: Plot): void {
  context.save();
  clip(context, plot);
  const steps = (fromDeg: number, toDeg: number) =>
    Array.from({ length: (toDeg - fromDeg) / LINE_STEP_DEG + 1 }, (_, i) => fromDeg + i * LINE_STEP_DEG);
  for (const elevationDeg of ELEVATIONS_DEG)
    trace(
      context,
      projection,
      steps(0, 360).map((azimuthDeg) => ({ azimuthDeg, elevationDeg })),
    );
  for (const azimuthDeg of NAMED_DEG)
    trace(
      context,
      projection,
      steps(0, 90).map((elevationDeg) => ({ azimuthDeg, elevationDeg })),
    );
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const azimuthDeg of NAMED_DEG) {
    const { xPx, yPx } = projection.pointFromDirection({ azimuthDeg, elevationDeg: 0 });
    const strong = azimuthDeg % 90 === 0;
    context.font = font(strong ? 14 : 12, strong ? 650 : 500);
    context.fillStyle = strong ? STRONG_TEXT : TEXT;
    context.fillText(compassName(azimuthDeg), xPx, yPx + 6);
  }
  context.font = font(11);
  context.textAlign = "left";
  context.textBaseline = "bottom";
  context.fillStyle = "rgba(234, 240, 255, 0.75)";
  for (const elevationDeg of [30, 60]) {
    for (const azimuthDeg of [0, 90, 180, 270]) {
      const { xPx, yPx } = projection.pointFromDirection({ azimuthDeg, elevationDeg });
      context.fillText(`${elevationDeg}°`, xPx + 4, yPx - 2);
    }
  }
  context.restore();
}
