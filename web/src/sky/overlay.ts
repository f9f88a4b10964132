// Compass directions, elevation marks, the terrain horizon and the cross of the readout.

import type { SkyGrid } from "./grid.ts";
import { compass_name, type Plot, type Projection, type SkyDirection } from "./projection.ts";
import { outline, type Region } from "./region.ts";
import type { TownOnHorizon } from "./towns.ts";

/** Directions that are named along the horizon; the cardinal ones stand out. */
const NAMED_DEG = [0, 45, 90, 135, 180, 225, 270, 315] as const;
const ELEVATIONS_DEG = [0, 30, 60] as const;

const LINE = "rgba(226, 234, 255, 0.16)";
const TEXT = "#aab6d3";
const STRONG_TEXT = "#eaf0ff";

function font(size_px: number, weight = 500): string {
  return `${weight} ${size_px}px system-ui, sans-serif`;
}

/** Draws the lines and names that do not change with the pointer. */
export function draw_frame(context: CanvasRenderingContext2D, projection: Projection, plot: Plot): void {
  context.lineWidth = 1;
  context.strokeStyle = LINE;
  if (projection.name === "fisheye") draw_fisheye_frame(context, projection, plot);
  else if (projection.name === "perspective") draw_perspective_frame(context, projection, plot);
  else draw_strip_frame(context, projection, plot);
}

function draw_strip_frame(context: CanvasRenderingContext2D, projection: Projection, plot: Plot): void {
  const right_px = plot.left_px + plot.width_px;
  const bottom_px = plot.top_px + plot.height_px;
  context.textBaseline = "middle";
  context.textAlign = "right";
  context.font = font(11);
  context.fillStyle = TEXT;
  for (const elevation_deg of [...ELEVATIONS_DEG, 90]) {
    const { y_px } = projection.point_from_direction({ azimuth_deg: 0, elevation_deg });
    context.fillText(`${elevation_deg}°`, plot.left_px - 6, Math.min(Math.max(y_px, plot.top_px + 6), bottom_px - 5));
    if (elevation_deg === 0 || elevation_deg === 90) continue;
    stroke(context, [[plot.left_px, y_px], [right_px, y_px]]);
  }
  context.textBaseline = "top";
  for (const azimuth_deg of [...NAMED_DEG, 360]) {
    const { x_px } = projection.point_from_direction({ azimuth_deg, elevation_deg: 0 });
    const strong = azimuth_deg % 90 === 0;
    context.font = font(strong ? 13 : 11, strong ? 650 : 500);
    context.fillStyle = strong ? STRONG_TEXT : TEXT;
    context.textAlign = azimuth_deg === 0 ? "left" : azimuth_deg === 360 ? "right" : "center";
    context.fillText(compass_name(azimuth_deg), x_px, bottom_px + 7);
    if (azimuth_deg > 0 && azimuth_deg < 360) stroke(context, [[x_px, plot.top_px], [x_px, bottom_px + (strong ? 4 : 2)]]);
  }
}

function draw_fisheye_frame(context: CanvasRenderingContext2D, projection: Projection, plot: Plot): void {
  const radius_px = Math.min(plot.width_px, plot.height_px) / 2;
  const x0_px = plot.left_px + plot.width_px / 2;
  const y0_px = plot.top_px + plot.height_px / 2;
  for (const elevation_deg of ELEVATIONS_DEG) {
    context.beginPath();
    context.arc(x0_px, y0_px, radius_px * (1 - elevation_deg / 90), 0, 2 * Math.PI);
    context.stroke();
  }
  for (const azimuth_deg of [0, 45, 90, 135]) {
    const from = projection.point_from_direction({ azimuth_deg, elevation_deg: 0 });
    const to = projection.point_from_direction({ azimuth_deg: azimuth_deg + 180, elevation_deg: 0 });
    stroke(context, [[from.x_px, from.y_px], [to.x_px, to.y_px]]);
  }
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const azimuth_deg of NAMED_DEG) {
    const { x_px, y_px } = projection.point_from_direction({ azimuth_deg, elevation_deg: (-13 / radius_px) * 90 });
    const strong = azimuth_deg % 90 === 0;
    context.font = font(strong ? 13 : 11, strong ? 650 : 500);
    context.fillStyle = strong ? STRONG_TEXT : TEXT;
    context.fillText(compass_name(azimuth_deg), x_px, y_px);
  }
  context.font = font(10);
  context.textAlign = "left";
  context.fillStyle = "rgba(234, 240, 255, 0.75)";
  for (const elevation_deg of [30, 60]) {
    const { x_px, y_px } = projection.point_from_direction({ azimuth_deg: 180, elevation_deg });
    context.fillText(`${elevation_deg}°`, x_px + 4, y_px - 7);
  }
}

/** Degrees between the points of a line that is drawn as straight pieces. */
const LINE_STEP_DEG = 3;

function draw_perspective_frame(context: CanvasRenderingContext2D, projection: Projection, plot: Plot): void {
  context.save();
  clip(context, plot);
  const steps = (from_deg: number, to_deg: number) => Array.from({ length: (to_deg - from_deg) / LINE_STEP_DEG + 1 }, (_, i) => from_deg + i * LINE_STEP_DEG);
  for (const elevation_deg of ELEVATIONS_DEG) trace(context, projection, steps(0, 360).map((azimuth_deg) => ({ azimuth_deg, elevation_deg })));
  for (const azimuth_deg of NAMED_DEG) trace(context, projection, steps(0, 90).map((elevation_deg) => ({ azimuth_deg, elevation_deg })));
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const azimuth_deg of NAMED_DEG) {
    const { x_px, y_px } = projection.point_from_direction({ azimuth_deg, elevation_deg: 0 });
    const strong = azimuth_deg % 90 === 0;
    context.font = font(strong ? 14 : 12, strong ? 650 : 500);
    context.fillStyle = strong ? STRONG_TEXT : TEXT;
    context.fillText(compass_name(azimuth_deg), x_px, y_px + 6);
  }
  context.font = font(11);
  context.textAlign = "left";
  context.textBaseline = "bottom";
  context.fillStyle = "rgba(234, 240, 255, 0.75)";
  for (const elevation_deg of [30, 60]) {
    for (const azimuth_deg of [0, 90, 180, 270]) {
      const { x_px, y_px } = projection.point_from_direction({ azimuth_deg, elevation_deg });
      context.fillText(`${elevation_deg}°`, x_px + 4, y_px - 2);
    }
  }
  context.restore();
}

function clip(context: CanvasRenderingContext2D, plot: Plot): void {
  context.beginPath();
  context.rect(plot.left_px, plot.top_px, plot.width_px, plot.height_px);
  context.clip();
}

/** A line through directions, broken where it passes the end of a strip or goes behind the observer. */
function trace(context: CanvasRenderingContext2D, projection: Projection, directions: readonly SkyDirection[]): void {
  context.beginPath();
  let before_deg: number | null = null;
  for (const direction of directions) {
    const { x_px, y_px } = projection.point_from_direction(direction);
    const is_around = projection.name === "equirectangular" && before_deg !== null && Math.abs(direction.azimuth_deg - before_deg) > 180;
    if (before_deg === null || is_around) context.moveTo(x_px, y_px);
    else context.lineTo(x_px, y_px);
    before_deg = Number.isNaN(x_px) ? null : direction.azimuth_deg;
  }
  context.stroke();
}

/** The terrain's skyline, where the answer has one. */
export function draw_horizon(context: CanvasRenderingContext2D, projection: Projection, plot: Plot, grid: SkyGrid): void {
  if (!grid.horizon_deg.some((elevation_deg) => elevation_deg > 0)) return;
  // Once around: to the first column again, which lies at the strip's right edge or where the disc closes.
  const skyline = Array.from({ length: grid.azimuth_count + 1 }, (_, column) => {
    const azimuth_deg = grid.azimuth_first_deg + column * grid.azimuth_step_deg;
    return { azimuth_deg, elevation_deg: Math.max(grid.horizon_at(azimuth_deg), 0) };
  });
  context.save();
  if (projection.name === "perspective") clip(context, plot);
  context.lineWidth = 1.2;
  context.strokeStyle = "rgb(164, 156, 144)";
  trace(context, projection, skyline);
  context.restore();
}

/** Names of the towns behind the glow, over the place on the horizon where it is; `field_deg` of the sky is the plot high. */
export function draw_towns(context: CanvasRenderingContext2D, projection: Projection, plot: Plot, field_deg: number, grid: SkyGrid, towns: readonly TownOnHorizon[]): void {
  context.font = font(11, 550);
  context.textBaseline = "middle";
  context.lineJoin = "round";
  const name_height_deg = projection.name === "fisheye" ? 9 : (17 / plot.height_px) * field_deg;
  for (const { name, azimuth_deg } of towns) {
    const horizon_deg = Math.max(grid.horizon_at(azimuth_deg), 0);
    const foot = projection.point_from_direction({ azimuth_deg, elevation_deg: horizon_deg });
    const elevation_deg = horizon_deg + name_height_deg;
    const head = projection.point_from_direction({ azimuth_deg, elevation_deg });
    if (!(head.x_px > plot.left_px && head.x_px < plot.left_px + plot.width_px)) continue;
    const half_px = context.measureText(name).width / 2;
    const right_px = plot.left_px + plot.width_px;
    const x_px = Math.min(Math.max(head.x_px, plot.left_px + half_px + 3), right_px - half_px - 3);
    context.textAlign = "center";
    context.strokeStyle = "rgba(5, 8, 16, 0.85)";
    context.lineWidth = 1;
    stroke(context, [[foot.x_px, foot.y_px], [foot.x_px + 0.45 * (head.x_px - foot.x_px), foot.y_px + 0.45 * (head.y_px - foot.y_px)]]);
    context.lineWidth = 3.5;
    context.strokeText(name, x_px, head.y_px);
    context.fillStyle = "#ffffff";
    context.fillText(name, x_px, head.y_px);
  }
}

/** A curve on the sky, closed or still being drawn. Where the strip ends it goes on at the other side. */
export function draw_curve(context: CanvasRenderingContext2D, projection: Projection, plot: Plot, curve: Region, closed: boolean): void {
  const points = closed ? outline(curve) : curve;
  context.save();
  if (projection.name === "perspective") clip(context, plot);
  context.lineJoin = "round";
  for (const [colour, width] of [["rgba(0, 0, 0, 0.75)", 4.5], ["#6ff0dc", 2]] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    trace(context, projection, points);
  }
  context.restore();
}

/** The cross that shows which direction the readout speaks of. */
export function draw_cross(context: CanvasRenderingContext2D, projection: Projection, direction: SkyDirection): void {
  const { x_px, y_px } = projection.point_from_direction(direction);
  for (const [colour, width] of [["rgba(0, 0, 0, 0.7)", 4], ["#ffffff", 1.6]] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    context.arc(x_px, y_px, 6, 0, 2 * Math.PI);
    context.stroke();
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]] as const) {
      stroke(context, [[x_px + 6 * dx, y_px + 6 * dy], [x_px + 11 * dx, y_px + 11 * dy]]);
    }
  }
}

function stroke(context: CanvasRenderingContext2D, points: readonly (readonly [number, number])[]): void {
  context.beginPath();
  points.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  context.stroke();
}
