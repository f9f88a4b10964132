// The sky on the GPU: WebGL2 paints a canvas of its own, which the picture takes its sky from.

import { isOfLight } from "./colour-maps.ts";
import type { Disc } from "./compact.ts";
import { halfPower } from "./eye.ts";
import { colourTexture, floatTexture, Program } from "./gl.ts";
import type { SkyGrid, SkyKind } from "./grid.ts";
import { type Gaze, type Plot, PROJECTIONS, type Projection, vectorFromDirection } from "./projection.ts";
import { referenceCdM2 } from "./realistic.ts";
import before from "./shaders/before.glsl?raw";
import discFragment from "./shaders/disc.frag?raw";
import discVertex from "./shaders/disc.vert?raw";
import groundFragment from "./shaders/ground.frag?raw";
import light from "./shaders/light.glsl?raw";
import pointFragment from "./shaders/point.frag?raw";
import pointVertex from "./shaders/point.vert?raw";
import skyFragment from "./shaders/sky.frag?raw";
import skyVertex from "./shaders/sky.vert?raw";
import view from "./shaders/view.glsl?raw";
import { type PictureLook, type Shading, shadingOf, tableOf, texelsOf } from "./shading.ts";

/** How directions become pixels. */
export interface SkyPlot {
  projection: Projection;
  gaze: Gaze;
  /** Of the canvas, CSS pixels. */
  plot: Plot;
  pixelsPerCssPx: number;
}

interface Mesh {
  array: WebGLVertexArrayObject;
  vertices: WebGLBuffer;
  indices: WebGLBuffer;
  count: number;
}

/** What is on the GPU of a grid in a look. */
interface Uploaded {
  look: string;
  shading: Shading;
  table: WebGLTexture | null;
  sky: Mesh;
  ground: Mesh;
  /** Stars, Moon and Sun with the light behind them and the ground before them. */
  before: { sky: WebGLTexture; horizon: WebGLTexture; points: { array: WebGLVertexArrayObject; vertices: WebGLBuffer } } | null;
}

interface Programs {
  sky: Program;
  ground: Program;
  point: Program;
  disc: Program;
}

/** In the order of the shaders. */
const FINISHES = ["table", "realistic", "eye"] as const;
const RADIANS = Math.PI / 180;
/** Numbers of a vertex of a mesh: azimuth, elevation, and three that are interpolated. */
const MESH_NUMBERS = 5;
const FLOAT_BYTES = 4;
/** How far the ground's edge is told above and below it: further than a pixel of any picture. */
const EDGE_DEG = 0.5;
export class GpuPainter {
  readonly canvas = document.createElement("canvas");
  private readonly gl: WebGL2RenderingContext | null;
  private programs: Programs | null = null;
  private readonly uploads = new Map<SkyGrid, Uploaded>();

  /** `changed` is called when the context was lost or is back: what is shown must be painted anew. */
  constructor(changed: () => void) {
    const { canvas } = this;
    this.gl = canvas.getContext("webgl2", { alpha: true, antialias: false, depth: false, premultipliedAlpha: true });
    const forget = (event: Event) => {
      event.preventDefault();
      this.programs = null;
      this.uploads.clear();
      changed();
    };
    canvas.addEventListener("webglcontextlost", forget);
    canvas.addEventListener("webglcontextrestored", changed);
  }

  /** Whether there is a GPU, or what stands for one. */
  get isReady(): boolean {
    return this.gl !== null && !this.gl.isContextLost();
  }

  /** Makes the canvas empty, and as large as the picture. */
  begin(width: number, height: number): void {
    const { canvas, gl } = this;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    gl?.disable(gl.SCISSOR_TEST);
    gl?.clear(gl.COLOR_BUFFER_BIT);
  }

  /** Paints the part of a sky that lies left of a column of the canvas. */
  paint(grid: SkyGrid, look: PictureLook, plot: SkyPlot, untilPx: number): void {
    const { gl } = this;
    if (gl === null) return;
    this.programs ??= {
      sky: new Program(gl, view + skyVertex, light + skyFragment),
      ground: new Program(gl, view + skyVertex, groundFragment),
      point: new Program(gl, view + pointVertex, view + before + light + pointFragment),
      disc: new Program(gl, discVertex, view + before + light + discFragment),
    };
    const uploaded = this.uploaded(gl, grid, look);
    const { leftPx, topPx, widthPx, heightPx } = plot.plot;
    const scale = plot.pixelsPerCssPx;
    const area = [leftPx, this.canvas.height / scale - topPx - heightPx, widthPx, heightPx].map((px) => Math.round(px * scale));
    const [left = 0, bottom = 0, width = 0, height = 0] = area;
    gl.enable(gl.SCISSOR_TEST);
    gl.viewport(left, bottom, width, height);
    gl.scissor(left, bottom, Math.max(Math.min(width, untilPx - left), 0), height);
    gl.disable(gl.BLEND);
    const use = (program: Program) => this.use(gl, program, look, plot, area);
    const sky = use(this.programs.sky);
    if (uploaded.table !== null) bind(gl, sky, "table", 0, uploaded.table);
    drawMesh(gl, uploaded.sky);
    // Ground lies before the sky, and its edge is smooth.
    gl.enable(gl.BLEND);
    gl.blendEquation(gl.FUNC_ADD);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const ground = use(this.programs.ground);
    const [red, green, blue] = uploaded.shading.groundRgb;
    gl.uniform3f(ground.place("ground"), red / 255, green / 255, blue / 255);
    drawMesh(gl, uploaded.ground);
    if (uploaded.before === null) return;
    // Light before the sky is never darker than the sky.
    gl.blendEquation(gl.MAX);
    const { points, sky: behind, horizon } = uploaded.before;
    const useBefore = (program: Program) => {
      bind(gl, use(program), "sky", 0, behind);
      bind(gl, program, "horizon", 1, horizon);
      return program;
    };
    useBefore(this.programs.point);
    gl.bindVertexArray(points.array);
    gl.drawArrays(gl.POINTS, 0, grid.points.length);
    gl.bindVertexArray(null);
    for (const disc of grid.discs) {
      const { xPx, yPx } = plot.projection.pointFromDirection({ azimuthDeg: disc.azimuth_deg, elevationDeg: disc.elevation_deg });
      if (Number.isNaN(xPx)) continue;
      const reachPx = discReachPx(disc, plot) * scale;
      const from = [xPx * scale - reachPx, this.canvas.height - yPx * scale - reachPx].map(Math.floor);
      const boxLeft = Math.max(from[0] ?? 0, left);
      const boxBottom = Math.max(from[1] ?? 0, bottom);
      const boxRight = Math.min((from[0] ?? 0) + 2 * reachPx, left + width, untilPx);
      const boxTop = Math.min((from[1] ?? 0) + 2 * reachPx, bottom + height);
      gl.scissor(boxLeft, boxBottom, Math.max(boxRight - boxLeft, 0), Math.max(boxTop - boxBottom, 0));
      paintDisc(gl, useBefore(this.programs.disc), disc);
    }
  }

  private use(
    gl: WebGL2RenderingContext,
    program: Program,
    { colours, exposureEv }: PictureLook,
    { projection, gaze }: SkyPlot,
    [left = 0, bottom = 0, width = 0, height = 0]: readonly number[],
  ): Program {
    gl.useProgram(program.program);
    gl.uniform1i(program.place("projection"), PROJECTIONS.indexOf(projection.name));
    gl.uniform2f(program.place("plot_px"), width, height);
    gl.uniform2f(program.place("origin_px"), left, bottom);
    gl.uniformMatrix3fv(program.place("camera"), false, cameraAxes(gaze));
    gl.uniform1f(program.place("focal_px"), height / 2 / Math.tan((gaze.fieldDeg / 2) * RADIANS));
    gl.uniform1i(program.place("finish"), isOfLight(colours) ? FINISHES.indexOf(colours) : FINISHES.indexOf("table"));
    gl.uniform1f(program.place("exposure"), colours === "eye" ? halfPower(exposureEv) : referenceCdM2(exposureEv));
    return program;
  }

  /** The textures of a grid in a look; of two grids at most. */
  private uploaded(gl: WebGL2RenderingContext, grid: SkyGrid, look: PictureLook): Uploaded {
    const name = JSON.stringify(look);
    const known = this.uploads.get(grid);
    if (known?.look === name) return known;
    if (known !== undefined) this.release(gl, grid, known);
    for (const [other, uploaded] of [...this.uploads].slice(0, -1)) this.release(gl, other, uploaded);
    const shading = shadingOf(grid, look);
    const hasBefore = isOfLight(look.colours) && look.sky === "total" && grid.points.length + grid.discs.length > 0;
    const made: Uploaded = {
      look: name,
      shading,
      table: isOfLight(look.colours) ? null : colourTexture(gl, tableOf(look.colours)),
      sky: mesh(gl, grid, skyRows(grid, shading)),
      ground: mesh(gl, grid, groundRows(grid)),
      before: hasBefore ? { ...lightTextures(gl, grid, look.sky), points: pointArray(gl, grid) } : null,
    };
    this.uploads.set(grid, made);
    return made;
  }

  private release(gl: WebGL2RenderingContext, grid: SkyGrid, { table, sky, ground, before }: Uploaded): void {
    for (const texture of [table, before?.sky, before?.horizon]) gl.deleteTexture(texture ?? null);
    for (const { array } of [sky, ground, ...(before === null ? [] : [before.points])]) gl.deleteVertexArray(array);
    for (const buffer of [sky.vertices, sky.indices, ground.vertices, ground.indices, before?.points.vertices])
      gl.deleteBuffer(buffer ?? null);
    this.uploads.delete(grid);
  }
}

function bind(gl: WebGL2RenderingContext, program: Program, name: string, unit: number, texture: WebGLTexture): void {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.uniform1i(program.place(name), unit);
}

/** Half a side of the square that a disc lies in, CSS pixels. */
function discReachPx({ radius_deg, elevation_deg }: Disc, { projection, gaze, plot: { widthPx, heightPx } }: SkyPlot): number {
  const degreesAPx = {
    equirectangular: 90 / heightPx,
    fisheye: 180 / Math.min(widthPx, heightPx),
    perspective: (2 * Math.tan((gaze.fieldDeg / 2) * RADIANS)) / heightPx / RADIANS,
  }[projection.name];
  // Pixels are stretched near the edge of a perspective and high up in a strip.
  return 4 + ((2 / Math.max(Math.cos(elevation_deg * RADIANS), 0.05)) * radius_deg) / degreesAPx;
}

function paintDisc(gl: WebGL2RenderingContext, program: Program, disc: Disc): void {
  gl.uniform2f(program.place("middle"), disc.azimuth_deg * RADIANS, disc.elevation_deg * RADIANS);
  gl.uniform1f(program.place("radius"), disc.radius_deg * RADIANS);
  gl.uniform4fv(program.place("lit"), disc.lit_cd_m2);
  gl.uniform4fv(program.place("dark"), disc.dark_cd_m2);
  gl.uniform1f(program.place("lit_share"), disc.lit_share);
  gl.uniform1f(program.place("bright_limb"), disc.bright_limb_deg * RADIANS);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

/** Columns right, above and ahead, in (east, north, up). */
function cameraAxes(gaze: Gaze): number[] {
  const azimuth = gaze.azimuthDeg * RADIANS;
  const above = vectorFromDirection({ azimuthDeg: gaze.azimuthDeg, elevationDeg: gaze.elevationDeg + 90 });
  return [Math.cos(azimuth), -Math.sin(azimuth), 0, ...above, ...vectorFromDirection(gaze)];
}

/** Vertices of a ring around the observer, from north to north. */
type Row = (column: number) => readonly [elevationDeg: number, ...shown: number[]];

/** Rows of the sky: from the horizon, where the lowest row's colours hold, to the zenith, where the highest row meets itself. */
function skyRows(grid: SkyGrid, { texels }: Shading): Row[] {
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
function groundRows(grid: SkyGrid): Row[] {
  const top = (column: number) => Math.max(grid.horizonDeg[column % grid.azimuthCount] ?? 0, 0);
  const edge = (above: number): Row => {
    return (column) => [top(column) + above, above, 0, 0];
  };
  return [(column) => [-90, -90 - top(column), 0, 0], edge(-EDGE_DEG), edge(EDGE_DEG)];
}

function mesh(gl: WebGL2RenderingContext, { azimuthCount, azimuthFirstDeg, azimuthStepDeg }: SkyGrid, rows: readonly Row[]): Mesh {
  const width = azimuthCount + 1;
  const numbers = new Float32Array(rows.length * width * MESH_NUMBERS);
  rows.forEach((row, at) => {
    for (let column = 0; column < width; column++) {
      const [elevationDeg, ...shown] = row(column);
      const azimuth = (azimuthFirstDeg + column * azimuthStepDeg) * RADIANS;
      numbers.set([azimuth, elevationDeg * RADIANS, ...shown], (at * width + column) * MESH_NUMBERS);
    }
  });
  const corners = new Uint16Array((rows.length - 1) * azimuthCount * 6);
  for (let at = 0; at < rows.length - 1; at++) {
    for (let column = 0; column < azimuthCount; column++) {
      const low = at * width + column;
      const high = low + width;
      corners.set([low, low + 1, high, high, low + 1, high + 1], 6 * (at * azimuthCount + column));
    }
  }
  const vertices = vertexArray(gl, numbers, [2, 3]);
  const indices = gl.createBuffer();
  gl.bindVertexArray(vertices.array);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  return { ...vertices, indices, count: corners.length };
}

function drawMesh(gl: WebGL2RenderingContext, { array, count }: Mesh): void {
  gl.bindVertexArray(array);
  gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_SHORT, 0);
  gl.bindVertexArray(null);
}

/** Light behind what stands before the sky, and the ground before it. */
function lightTextures(gl: WebGL2RenderingContext, grid: SkyGrid, sky: SkyKind) {
  const { azimuthCount, elevationCount } = grid;
  const horizonRad = Float32Array.from({ length: azimuthCount }, (_, i) => Math.max(grid.horizonDeg[i] ?? 0, 0) * RADIANS);
  const light = texelsOf(grid, (sample) => grid.eyeAt(sky, sample));
  return {
    sky: floatTexture(gl, "RGBA32F", [azimuthCount, elevationCount + 1], light),
    horizon: floatTexture(gl, "R16F", [azimuthCount, 1], horizonRad),
  };
}

/** Stars and planets as vertices. */
function pointArray(gl: WebGL2RenderingContext, { points }: SkyGrid) {
  const numbers = points.flatMap(({ azimuthDeg, elevationDeg, illuminanceLx }) => [
    azimuthDeg * RADIANS,
    elevationDeg * RADIANS,
    ...illuminanceLx,
  ]);
  return vertexArray(gl, new Float32Array(numbers), [2, 4]);
}

/** Vertices of several attributes, each of so many numbers. */
function vertexArray(gl: WebGL2RenderingContext, numbers: Float32Array, sizes: readonly number[]) {
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
