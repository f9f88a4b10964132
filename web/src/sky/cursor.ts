// The readout's cross, moved by keyboard.

import type { SkyGrid } from "./grid.ts";
import type { SkyDirection } from "./projection.ts";

/** Samples that an arrow key moves with Shift. */
const LARGE_STEP = 8;
const MOVES: Readonly<Record<string, readonly [right: number, up: number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** The sample that a key moves to from the one nearest to a direction; null where the key moves nothing. */
export function movedCursor({ key, shiftKey }: KeyboardEvent, from: SkyDirection, grid: SkyGrid): SkyDirection | null {
  const move = MOVES[key];
  if (move === undefined) return null;
  const steps = shiftKey ? LARGE_STEP : 1;
  const nearest = grid.nearest(from.azimuthDeg, from.elevationDeg);
  const lastDeg = grid.elevationFirstDeg + (grid.elevationCount - 1) * grid.elevationStepDeg;
  const elevationDeg = nearest.elevationDeg + move[1] * steps * grid.elevationStepDeg;
  return {
    azimuthDeg: (nearest.azimuthDeg + move[0] * steps * grid.azimuthStepDeg + 360) % 360,
    elevationDeg: Math.min(Math.max(elevationDeg, grid.elevationFirstDeg), lastDeg),
  };
}
