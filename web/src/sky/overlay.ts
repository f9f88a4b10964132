// Compass directions, elevation marks, the terrain horizon and the cross of the readout.

import type { SkyGrid } from "./grid.ts";
import { compassName, type Plot, type Projection, type SkyDirection } from "./projection.ts";
import { outline, type Region } from "./region.ts";
import type { TownOnHorizon } from "./towns.ts";

/** Directions that are named along the horizon; the cardinal ones stand out. */
const NAMED_DEG = [0, 45, 90, 135, 180, 225, 270, 315] as const;
const ELEVATIONS_DEG = [0, 30, 60] as const;

const LINE = "rgba(226, 234, 255, 0.16)";
const TEXT = "#aab6d3";
const STRONG_TEXT = "#eaf0ff";

function font(sizePx: number, weight = 500): string {
  return `${weight} ${sizePx}px system-ui, sans-serif`;
}

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

function clip(context: CanvasRenderingContext2D, plot: Plot): void {
  context.beginPath();
  context.rect(plot.leftPx, plot.topPx, plot.widthPx, plot.heightPx);
  context.clip();
}

/** A line through directions, broken where it passes the end of a strip or goes behind the observer. */
function trace(context: CanvasRenderingContext2D, projection: Projection, directions: readonly SkyDirection[]): void {
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

/** The terrain's skyline, where the answer has one. */
export function drawHorizon(context: CanvasRenderingContext2D, projection: Projection, plot: Plot, grid: SkyGrid): void {
  if (!grid.horizonDeg.some((elevationDeg) => elevationDeg > 0)) return;
  // Once around: to the first column again, which lies at the strip's right edge or where the disc closes.
  const skyline = Array.from({ length: grid.azimuthCount + 1 }, (_, column) => {
    const azimuthDeg = grid.azimuthFirstDeg + column * grid.azimuthStepDeg;
    return { azimuthDeg, elevationDeg: Math.max(grid.horizonAt(azimuthDeg), 0) };
  });
  context.save();
  if (projection.name === "perspective") clip(context, plot);
  context.lineWidth = 1.2;
  context.strokeStyle = "rgb(164, 156, 144)";
  trace(context, projection, skyline);
  context.restore();
}

/** Names of the towns behind the glow, over the place on the horizon where it is; `fieldDeg` of the sky is the plot high. */
export function drawTowns(
  context: CanvasRenderingContext2D,
  projection: Projection,
  plot: Plot,
  fieldDeg: number,
  grid: SkyGrid,
  towns: readonly TownOnHorizon[],
): void {
  context.font = font(11, 550);
  context.textBaseline = "middle";
  context.lineJoin = "round";
  const nameHeightDeg = projection.name === "fisheye" ? 9 : (17 / plot.heightPx) * fieldDeg;
  for (const { name, azimuthDeg } of towns) {
    const horizonDeg = Math.max(grid.horizonAt(azimuthDeg), 0);
    const foot = projection.pointFromDirection({ azimuthDeg, elevationDeg: horizonDeg });
    const elevationDeg = horizonDeg + nameHeightDeg;
    const head = projection.pointFromDirection({ azimuthDeg, elevationDeg });
    if (!(head.xPx > plot.leftPx && head.xPx < plot.leftPx + plot.widthPx)) continue;
    const halfPx = context.measureText(name).width / 2;
    const rightPx = plot.leftPx + plot.widthPx;
    const xPx = Math.min(Math.max(head.xPx, plot.leftPx + halfPx + 3), rightPx - halfPx - 3);
    context.textAlign = "center";
    context.strokeStyle = "rgba(5, 8, 16, 0.85)";
    context.lineWidth = 1;
    stroke(context, [
      [foot.xPx, foot.yPx],
      [foot.xPx + 0.45 * (head.xPx - foot.xPx), foot.yPx + 0.45 * (head.yPx - foot.yPx)],
    ]);
    context.lineWidth = 3.5;
    context.strokeText(name, xPx, head.yPx);
    context.fillStyle = "#ffffff";
    context.fillText(name, xPx, head.yPx);
  }
}

/** A curve on the sky, closed or still being drawn. Where the strip ends it goes on at the other side. */
export function drawCurve(
  context: CanvasRenderingContext2D,
  projection: Projection,
  plot: Plot,
  curve: Region,
  closed: boolean,
): void {
  const points = closed ? outline(curve) : curve;
  context.save();
  if (projection.name === "perspective") clip(context, plot);
  context.lineJoin = "round";
  for (const [colour, width] of [
    ["rgba(0, 0, 0, 0.75)", 4.5],
    ["#6ff0dc", 2],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    trace(context, projection, points);
  }
  context.restore();
}

/** The cross that shows which direction the readout speaks of. */
export function drawCross(context: CanvasRenderingContext2D, projection: Projection, direction: SkyDirection): void {
  const { xPx, yPx } = projection.pointFromDirection(direction);
  for (const [colour, width] of [
    ["rgba(0, 0, 0, 0.7)", 4],
    ["#ffffff", 1.6],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    context.arc(xPx, yPx, 6, 0, 2 * Math.PI);
    context.stroke();
    for (const [dx, dy] of [
      [1, 0],
      [-1, 0],
      [0, 1],
      [0, -1],
    ] as const) {
      stroke(context, [
        [xPx + 6 * dx, yPx + 6 * dy],
        [xPx + 11 * dx, yPx + 11 * dy],
      ]);
    }
  }
}

/** Pixels from the left and from the top. */
type Point = readonly [number, number];

function stroke(context: CanvasRenderingContext2D, [from, to]: readonly [Point, Point]): void {
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
}
