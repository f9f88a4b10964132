// The frame of the picture: compass directions and elevation marks of each projection.

import { type Drawing, font, type Ink, type Line, type Name, type Point, pieces } from "./lines.ts";
import { compassName, type Plot, type Projection, type SkyDirection } from "./projection.ts";

/** Directions that are named along the horizon; the cardinal ones stand out. */
const NAMED_DEG = [0, 45, 90, 135, 180, 225, 270, 315] as const;
const ELEVATIONS_DEG = [0, 30, 60] as const;

const LINE: Ink = [226, 234, 255, 0.16];
const TEXT: Ink = [170, 182, 211, 1];
const STRONG_TEXT: Ink = [234, 240, 255, 1];
const MARK: Ink = [234, 240, 255, 0.75];
/** Degrees between the points of a line that is drawn as straight pieces. */
const LINE_STEP_DEG = 3;

const thin = (points: readonly Point[]): Line => ({ points, ink: LINE, widthPx: 1 });

function compass(azimuthDeg: number, at: Point, [small, large]: Point, more: Pick<Name, "align" | "baseline" | "hasEdge">): Name {
  const strong = azimuthDeg % 90 === 0;
  return {
    text: compassName(azimuthDeg),
    at,
    font: font(strong ? large : small, strong ? 650 : 500),
    ink: strong ? STRONG_TEXT : TEXT,
    ...more,
  };
}

/** The lines and names that do not change with the pointer. */
export function frameOf(projection: Projection, plot: Plot): Drawing {
  const of = { fisheye: fisheyeFrame, perspective: perspectiveFrame, equirectangular: stripFrame }[projection.name];
  return { ...of(projection, plot), isClipped: projection.name === "perspective" };
}

type LinesAndNames = Omit<Drawing, "isClipped">;

function stripFrame(projection: Projection, plot: Plot): LinesAndNames {
  const rightPx = plot.leftPx + plot.widthPx;
  const bottomPx = plot.topPx + plot.heightPx;
  const lines: Line[] = [];
  const names: Name[] = [];
  for (const elevationDeg of [...ELEVATIONS_DEG, 90]) {
    const { yPx } = projection.pointFromDirection({ azimuthDeg: 0, elevationDeg });
    const at: Point = [plot.leftPx - 6, Math.min(Math.max(yPx, plot.topPx + 6), bottomPx - 5)];
    names.push({ text: `${elevationDeg}°`, at, font: font(11), ink: TEXT, align: "right", baseline: "middle" });
    if (elevationDeg === 0 || elevationDeg === 90) continue;
    lines.push(
      thin([
        [plot.leftPx, yPx],
        [rightPx, yPx],
      ]),
    );
  }
  for (const azimuthDeg of [...NAMED_DEG, 360]) {
    const { xPx } = projection.pointFromDirection({ azimuthDeg, elevationDeg: 0 });
    const align = azimuthDeg === 0 ? "left" : azimuthDeg === 360 ? "right" : "center";
    names.push(compass(azimuthDeg, [xPx, bottomPx + 7], [11, 13], { align, baseline: "top" }));
    if (azimuthDeg > 0 && azimuthDeg < 360)
      lines.push(
        thin([
          [xPx, plot.topPx],
          [xPx, bottomPx + (azimuthDeg % 90 === 0 ? 4 : 2)],
        ]),
      );
  }
  return { lines, names };
}

/** From one number to another, in steps. */
const steps = (from: number, to: number) =>
  Array.from({ length: (to - from) / LINE_STEP_DEG + 1 }, (_, i) => from + i * LINE_STEP_DEG);
const circle = (elevationDeg: number): SkyDirection[] => steps(0, 360).map((azimuthDeg) => ({ azimuthDeg, elevationDeg }));
const meridian = (azimuthDeg: number): SkyDirection[] => steps(0, 90).map((elevationDeg) => ({ azimuthDeg, elevationDeg }));

function fisheyeFrame(projection: Projection, plot: Plot): LinesAndNames {
  const radiusPx = Math.min(plot.widthPx, plot.heightPx) / 2;
  const across = [0, 45, 90, 135].map((azimuthDeg) =>
    [azimuthDeg, azimuthDeg + 180].map((end) => meridian(end)[0] as SkyDirection),
  );
  const lines = [...ELEVATIONS_DEG.map(circle), ...across].flatMap((line) => pieces(projection, line)).map(thin);
  const names = NAMED_DEG.map((azimuthDeg) => {
    const { xPx, yPx } = projection.pointFromDirection({ azimuthDeg, elevationDeg: (-13 / radiusPx) * 90 });
    return compass(azimuthDeg, [xPx, yPx], [11, 13], { align: "center", baseline: "middle" });
  });
  for (const elevationDeg of [30, 60]) {
    const { xPx, yPx } = projection.pointFromDirection({ azimuthDeg: 180, elevationDeg });
    const at: Point = [xPx + 4, yPx - 7];
    names.push({ text: `${elevationDeg}°`, at, font: font(10), ink: MARK, align: "left", baseline: "middle" });
  }
  return { lines, names };
}

function perspectiveFrame(projection: Projection): LinesAndNames {
  const lines = [...ELEVATIONS_DEG.map(circle), ...NAMED_DEG.map(meridian)].flatMap((line) => pieces(projection, line)).map(thin);
  const place = (direction: SkyDirection, right: number, down: number): Point[] => {
    const { xPx, yPx } = projection.pointFromDirection(direction);
    return Number.isNaN(xPx) ? [] : [[xPx + right, yPx + down]];
  };
  // They stand before the ground, which may be as bright as they are.
  const letters = NAMED_DEG.flatMap((azimuthDeg) =>
    place({ azimuthDeg, elevationDeg: 0 }, 0, 6).map((at) =>
      compass(azimuthDeg, at, [12, 14], { align: "center", baseline: "top", hasEdge: true }),
    ),
  );
  const marks = [30, 60].flatMap((elevationDeg) =>
    [0, 90, 180, 270].flatMap((azimuthDeg) =>
      place({ azimuthDeg, elevationDeg }, 4, -2).map(
        (at): Name => ({ text: `${elevationDeg}°`, at, font: font(11), ink: MARK, align: "left", baseline: "bottom" }),
      ),
    ),
  );
  return { lines, names: [...letters, ...marks] };
}
