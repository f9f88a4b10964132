// Sky and ground as meshes of triangles, whose corners are the samples of the grid.

import type { SkyGrid } from "./grid.ts";
import type { Gaze, Plot, Projection } from "./projection.ts";
import type { Shading } from "./shading.ts";

export interface Mesh {
  array: WebGLVertexArrayObject;
  vertices: WebGLBuffer;
  indices: WebGLBuffer;
  columnCount: number;
  /** Of all samples, and of fewer. */
  strips: readonly [fine: Strips, coarse: Strips];
}

/** Strips of triangles up the columns, so that only columns in view are drawn. */
interface Strips {
  /** Where they begin among the indices, and how many a strip has. */
  start: number;
  length: number;
  /** Columns of the grid that a strip is wide. */
  columns: number;
}

const RADIANS = Math.PI / 180;
/** Numbers of a vertex of a mesh: azimuth, elevation, and three that are interpolated. */
const MESH_NUMBERS = 5;
const FLOAT_BYTES = 4;
const INDEX_BYTES = 2;
/** What WebGL2 begins a new strip at. */
const NEXT_STRIP = 0xffff;
/** Points along each side of a plot by which it is found what it shows. */
const EDGE_POINTS = 16;
/** Below this row every sample is drawn; above it, where it shows less, every other one in a moving picture. */
const FIRST_COARSE_ROW = 10;
/** How far the ground's edge is told above and below it: further than a pixel of any picture. */
const EDGE_DEG = 0.5;

/** Vertices of a ring around the observer, from north to north. */
export type Row = (column: number) => readonly [elevationDeg: number, ...shown: number[]];

/** Rows of the sky: from the horizon, where the lowest row's colours hold, to the zenith, where the highest row meets itself. */
export function skyRows(grid: SkyGrid, { texels }: Shading): Row[] {
  const { azimuthCount, elevationCount } = grid;
  const colour = (row: number, column: number) => {
    const at = 4 * (row * azimuthCount + (column % azimuthCount));
    return [texels[at] ?? 0, texels[at + 1] ?? 0, texels[at + 2] ?? 0] as const;
  };
  const zenith: Row = (column) => {
    const across = colour(elevationCount, column);
    return [90, ...colour(elevationCount - 1, column).map((channel, i) => 0.5 * (channel + (across[i] ?? 0)))];
  };
  const row = (at: number): Row => {
    const elevationDeg = grid.elevationFirstDeg + at * grid.elevationStepDeg;
    return (column) => [elevationDeg, ...colour(at, column)];
  };
  const lowest: Row = (column) => [0, ...colour(0, column)];
  return [lowest, ...Array.from({ length: elevationCount }, (_, at) => row(at)), zenith];
}

/** Rows of the ground: some way above its edge and as far below, each with its height over the edge, and the lowest point. */
export function groundRows(grid: SkyGrid): Row[] {
  const top = (column: number) => Math.max(grid.horizonDeg[column % grid.azimuthCount] ?? 0, 0);
  const edge = (above: number): Row => {
    return (column) => [top(column) + above, above, 0, 0];
  };
  return [(column) => [-90, -90 - top(column), 0, 0], edge(-EDGE_DEG), edge(EDGE_DEG)];
}

export function mesh(
  gl: WebGL2RenderingContext,
  { azimuthCount, azimuthFirstDeg, azimuthStepDeg }: SkyGrid,
  rows: readonly Row[],
): Mesh {
  const width = azimuthCount + 1;
  const numbers = new Float32Array(rows.length * width * MESH_NUMBERS);
  rows.forEach((row, at) => {
    for (let column = 0; column < width; column++) {
      const [elevationDeg, ...shown] = row(column);
      const azimuth = (azimuthFirstDeg + column * azimuthStepDeg) * RADIANS;
      numbers.set([azimuth, elevationDeg * RADIANS, ...shown], (at * width + column) * MESH_NUMBERS);
    }
  });
  const { strips, corners } = stripsOf(azimuthCount, rows.length);
  const vertices = vertexArray(gl, numbers, [2, 3]);
  const indices = gl.createBuffer();
  gl.bindVertexArray(vertices.array);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  return { ...vertices, indices, columnCount: azimuthCount, strips };
}

/** Columns from one on, round the horizon. */
export interface Columns {
  first: number;
  count: number;
}

export function drawMesh(gl: WebGL2RenderingContext, mesh: Mesh, { first, count }: Columns, isMoving: boolean): void {
  const { start, length, columns } = mesh.strips[isMoving ? 1 : 0];
  const all = mesh.columnCount / columns;
  const wanted = Math.min(Math.ceil(count / columns) + 1, all);
  const from = Math.floor((((first % mesh.columnCount) + mesh.columnCount) % mesh.columnCount) / columns);
  gl.bindVertexArray(mesh.array);
  for (const [strip, strips] of [
    [from, Math.min(wanted, all - from)],
    [0, wanted - (all - from)],
  ] as const)
    if (strips > 0) gl.drawElements(gl.TRIANGLE_STRIP, strips * length, gl.UNSIGNED_SHORT, INDEX_BYTES * (start + strip * length));
  gl.bindVertexArray(null);
}

function stripsOf(columnCount: number, rowCount: number): { strips: Mesh["strips"]; corners: Uint16Array } {
  const rows = Array.from({ length: rowCount }, (_, at) => at);
  const few = rows.filter((at) => at <= FIRST_COARSE_ROW || at === rowCount - 1 || at % 2 === 0);
  const corners: number[] = [];
  const strip = (kept: readonly number[], columns: number): Strips => {
    const start = corners.length;
    for (let column = 0; column < columnCount; column += columns) {
      for (const at of kept) {
        const low = at * (columnCount + 1) + column;
        corners.push(low, low + columns);
      }
      corners.push(NEXT_STRIP);
    }
    return { start, length: 2 * kept.length + 1, columns };
  };
  const strips = [strip(rows, 1), strip(few, columnCount % 2 === 0 ? 2 : 1)] as const;
  return { strips, corners: Uint16Array.from(corners) };
}

/** The columns of which something may lie on the plot. */
export function columnsInView({ azimuthCount, azimuthStepDeg }: SkyGrid, projection: Projection, gaze: Gaze, plot: Plot): Columns {
  const all = { first: 0, count: azimuthCount };
  if (projection.name !== "perspective") return all;
  const { leftPx, topPx, widthPx, heightPx } = plot;
  const isInside = ({ xPx, yPx }: { xPx: number; yPx: number }) =>
    xPx >= leftPx && xPx <= leftPx + widthPx && yPx >= topPx && yPx <= topPx + heightPx;
  if ([90, -90].some((elevationDeg) => isInside(projection.pointFromDirection({ azimuthDeg: 0, elevationDeg })))) return all;
  // Without zenith and nadir the azimuths furthest to either side lie on the edge.
  let [least, most] = [0, 0];
  for (let i = 0; i <= EDGE_POINTS; i++) {
    const part = i / EDGE_POINTS;
    for (const [x, y] of [
      [part, 0],
      [part, 1],
      [0, part],
      [1, part],
    ] as const) {
      const direction = projection.directionFromPoint(leftPx + x * widthPx, topPx + y * heightPx);
      if (direction === null) continue;
      const away = ((direction.azimuthDeg - gaze.azimuthDeg + 540) % 360) - 180;
      [least, most] = [Math.min(least, away), Math.max(most, away)];
    }
  }
  const first = Math.floor((gaze.azimuthDeg + least) / azimuthStepDeg) - 1;
  return { first, count: Math.min(Math.ceil((gaze.azimuthDeg + most) / azimuthStepDeg) + 1 - first, azimuthCount) };
}

/** Vertices of several attributes, each of so many numbers. */
export function vertexArray(gl: WebGL2RenderingContext, numbers: Float32Array, sizes: readonly number[]) {
  const array = gl.createVertexArray();
  const vertices = gl.createBuffer();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, vertices);
  gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
  const stride = FLOAT_BYTES * sizes.reduce((sum, size) => sum + size, 0);
  let at = 0;
  sizes.forEach((size, place) => {
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, gl.FLOAT, false, stride, at);
    at += FLOAT_BYTES * size;
  });
  gl.bindVertexArray(null);
  return { array, vertices };
}
