// What is drawn over the sky: the terrain's horizon, towns, the curve of a region and the cross of the readout.

import type { SkyGrid } from "./grid.ts";
import { clip, type Drawing, font, type Line, type Name, type Point, pieces, stroke, trace } from "./lines.ts";
import type { Plot, Projection, SkyDirection } from "./projection.ts";
import { outline, type Region } from "./region.ts";
import type { TownOnHorizon } from "./towns.ts";

/** The terrain's skyline, where there is one. */
export function skyline(projection: Projection, grid: SkyGrid): Line[] {
  if (!grid.horizonDeg.some((elevationDeg) => elevationDeg > 0)) return [];
  // Once around: to the first column again, which lies at the strip's right edge or where the disc closes.
  const directions = Array.from({ length: grid.azimuthCount + 1 }, (_, column) => {
    const azimuthDeg = grid.azimuthFirstDeg + column * grid.azimuthStepDeg;
    return { azimuthDeg, elevationDeg: Math.max(grid.horizonAt(azimuthDeg), 0) };
  });
  return pieces(projection, directions).map((points) => ({ points, ink: [164, 156, 144, 1], widthPx: 1.2 }));
}

/** Names of the towns behind the glow, over the place on the horizon where it is; `fieldDeg` of the sky is the plot high. */
export function townsOver(
  projection: Projection,
  plot: Plot,
  fieldDeg: number,
  grid: SkyGrid,
  towns: readonly TownOnHorizon[],
): Drawing {
  const nameHeightDeg = projection.name === "fisheye" ? 9 : (17 / plot.heightPx) * fieldDeg;
  const rightPx = plot.leftPx + plot.widthPx;
  const lines: Line[] = [];
  const names: Name[] = [];
  for (const { name: text, azimuthDeg } of towns) {
    const horizonDeg = Math.max(grid.horizonAt(azimuthDeg), 0);
    const foot = projection.pointFromDirection({ azimuthDeg, elevationDeg: horizonDeg });
    const head = projection.pointFromDirection({ azimuthDeg, elevationDeg: horizonDeg + nameHeightDeg });
    const isInside = head.xPx > plot.leftPx && head.xPx < rightPx && head.yPx < plot.topPx + plot.heightPx;
    if (!isInside) continue;
    const half: Point = [foot.xPx + 0.45 * (head.xPx - foot.xPx), foot.yPx + 0.45 * (head.yPx - foot.yPx)];
    lines.push({ points: [[foot.xPx, foot.yPx], half], ink: [5, 8, 16, 0.85], widthPx: 1 });
    const within = [plot.leftPx + 3, rightPx - 3] as const;
    const look = { font: font(11, 550), ink: [255, 255, 255, 1], align: "center", baseline: "middle", hasEdge: true } as const;
    names.push({ text, at: [head.xPx, head.yPx], within, ...look });
  }
  return { lines, names, isClipped: false };
}

export type TownDirection = Pick<TownOnHorizon, "name" | "azimuthDeg">;

/** From where to where above the horizon the arrow to a town reaches: its name may stand below. */
const ARROW_FROM_DEG = 24;
const ARROW_TO_DEG = 10;
const ARROW_PX = 5;

/** An arrow down to a town behind the horizon, with its name. */
export function drawTown(
  context: CanvasRenderingContext2D,
  projection: Projection,
  plot: Plot,
  grid: SkyGrid,
  { name, azimuthDeg }: TownDirection,
): void {
  const horizonDeg = Math.max(grid.horizonAt(azimuthDeg), 0);
  const [from, to] = [ARROW_FROM_DEG, ARROW_TO_DEG].map((aboveDeg) =>
    projection.pointFromDirection({ azimuthDeg, elevationDeg: Math.min(horizonDeg + aboveDeg, 90) }),
  );
  if (from === undefined || to === undefined || Number.isNaN(from.xPx + to.xPx)) return;
  const length = Math.max(Math.hypot(to.xPx - from.xPx, to.yPx - from.yPx), 1);
  const [x, y] = [(to.xPx - from.xPx) / length, (to.yPx - from.yPx) / length];
  context.save();
  clip(context, plot);
  context.font = font(13, 650);
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  const halfPx = context.measureText(name).width / 2 + 3;
  const nameXPx = Math.min(Math.max(from.xPx - 12 * x, plot.leftPx + halfPx), plot.leftPx + plot.widthPx - halfPx);
  const nameYPx = Math.max(from.yPx - 12 * y, plot.topPx + 9);
  context.strokeStyle = "rgba(0, 0, 0, 0.85)";
  context.lineWidth = 4;
  context.strokeText(name, nameXPx, nameYPx);
  context.fillStyle = "#6ff0dc";
  context.fillText(name, nameXPx, nameYPx);
  for (const [colour, width] of [
    ["rgba(0, 0, 0, 0.75)", 5],
    ["#6ff0dc", 2],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    stroke(context, [
      [from.xPx, from.yPx],
      [to.xPx, to.yPx],
    ]);
    for (const side of [-1, 1])
      stroke(context, [
        [to.xPx - ARROW_PX * (x + side * y), to.yPx - ARROW_PX * (y - side * x)],
        [to.xPx, to.yPx],
      ]);
  }
  context.restore();
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
