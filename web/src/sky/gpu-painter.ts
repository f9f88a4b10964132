// The sky on the GPU: WebGL2 paints a canvas of its own, which the picture takes its sky from.

import { isOfLight } from "./colour-maps.ts";
import type { Disc } from "./compact.ts";
import { CONE_TABLE, coneTable, dazzle, exposedScale } from "./eye.ts";
import { colourTexture, floatTexture, landTexture, Program } from "./gl.ts";
import { HALO_DEG, illuminanceOf } from "./glare.ts";
import type { SkyGrid } from "./grid.ts";
import type { Landscape } from "./landscape.ts";
import type { Drawing } from "./lines.ts";
import { LiveLines } from "./live-lines.ts";
import { columnsInView, drawMesh, groundRows, type Mesh, mesh, skyRows, vertexArray } from "./meshes.ts";
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
import { type PictureLook, type Shading, shadingOf, tableOf, texelsOf, veiledAt } from "./shading.ts";

/** How directions become pixels. */
export interface SkyPlot {
  projection: Projection;
  gaze: Gaze;
  /** Of the canvas, CSS pixels. */
  plot: Plot;
  pixelsPerCssPx: number;
  /** Whether it comes soon rather than fine. */
  isMoving: boolean;
}

/** What is on the GPU of a grid in a look. */
interface Uploaded {
  look: string;
  shading: Shading;
  table: WebGLTexture | null;
  sky: Mesh;
  ground: Mesh;
  /** Stars, Moon and Sun with the light behind them and the ground before them. */
  before: { sky: WebGLTexture; veil: WebGLTexture; points: { array: WebGLVertexArrayObject; vertices: WebGLBuffer } } | null;
}

/** Of the plot on the canvas, device pixels from the lower left. */
type Area = [left: number, bottom: number, width: number, height: number];

interface Work {
  grid: SkyGrid;
  plot: SkyPlot;
  area: Area;
  use: (program: Program) => Program;
  untilPx: number;
  isEye: boolean;
}

interface Programs {
  sky: Program;
  ground: Program;
  /** Once there is land in light. */
  land: Program | null;
  point: Program;
  disc: Program;
  lines: LiveLines;
  cones: WebGLTexture;
}

/** In the order of the shaders. */
const FINISHES = ["table", "realistic", "eye"] as const;
const RADIANS = Math.PI / 180;
export class GpuPainter {
  readonly canvas = document.createElement("canvas");
  private readonly gl: WebGL2RenderingContext | null;
  private programs: Programs | null = null;
  private readonly uploads = new Map<SkyGrid, Uploaded>();
  private readonly lands = new Map<Landscape, WebGLTexture>();

  /** `changed` is called when the context was lost or is back: what is shown must be painted anew. */
  constructor(changed: () => void) {
    const { canvas } = this;
    this.gl = canvas.getContext("webgl2", { alpha: false, antialias: false, depth: false });
    const forget = (event: Event) => {
      event.preventDefault();
      this.programs = null;
      this.uploads.clear();
      this.lands.clear();
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
    if (gl === null) return;
    gl.disable(gl.SCISSOR_TEST);
    // What is opaque is shown faster: around the sky is the colour of the page.
    const [red = 0, green = 0, blue = 0] = (getComputedStyle(canvas).color.match(/\d+/g) ?? []).map(
      (channel) => Number(channel) / 255,
    );
    gl.clearColor(red, green, blue, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
  }

  /** Paints the part of a sky that lies left of a column of the canvas. */
  paint(grid: SkyGrid, look: PictureLook, plot: SkyPlot, untilPx: number, landscape: Landscape | null): void {
    const { gl } = this;
    if (gl === null) return;
    this.programs ??= {
      sky: new Program(gl, view + skyVertex, light + skyFragment),
      ground: new Program(gl, view + skyVertex, groundFragment),
      land: null,
      point: new Program(gl, view + pointVertex, light + pointFragment),
      disc: new Program(gl, discVertex, view + before + light + discFragment),
      lines: new LiveLines(gl),
      cones: floatTexture(gl, "R16F", [CONE_TABLE.width, CONE_TABLE.height], coneTable()),
    };
    const uploaded = this.uploaded(gl, grid, look);
    const { leftPx, topPx, widthPx, heightPx } = plot.plot;
    const scale = plot.pixelsPerCssPx;
    const area = [leftPx, this.canvas.height / scale - topPx - heightPx, widthPx, heightPx].map((px) =>
      Math.round(px * scale),
    ) as Area;
    const [left, bottom, width, height] = area;
    gl.enable(gl.SCISSOR_TEST);
    gl.viewport(left, bottom, width, height);
    gl.scissor(left, bottom, Math.max(Math.min(width, untilPx - left), 0), height);
    gl.disable(gl.BLEND);
    const use = (program: Program) => this.use(gl, program, look, plot, area);
    const sky = use(this.programs.sky);
    if (uploaded.table !== null) bind(gl, sky, "table", 0, uploaded.table);
    const columns = columnsInView(grid, plot.projection, plot.gaze, plot.plot);
    drawMesh(gl, uploaded.sky, columns, plot.isMoving);
    gl.enable(gl.BLEND);
    if (uploaded.before !== null)
      this.paintBefore(gl, this.programs, uploaded.before, { grid, plot, area, use, untilPx, isEye: look.colours === "eye" });
    // Ground hides all of it, and its edge is smooth.
    gl.scissor(left, bottom, Math.max(Math.min(width, untilPx - left), 0), height);
    gl.blendEquation(gl.FUNC_ADD);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    if (landscape === null) {
      const ground = use(this.programs.ground);
      const [red, green, blue] = uploaded.shading.groundRgb;
      gl.uniform3f(ground.place("ground"), red / 255, green / 255, blue / 255);
    } else {
      this.programs.land ??= new Program(gl, view + skyVertex, view + light + landscape.fragmentShader);
      bind(gl, use(this.programs.land), "faces", 0, this.uploadedLand(gl, landscape), gl.TEXTURE_2D_ARRAY);
    }
    drawMesh(gl, uploaded.ground, columns, false);
  }

  /** Draws lines and names over what was painted last. */
  drawOver(drawings: readonly Drawing[], plot: Plot, pixelsPerCssPx: number): void {
    this.programs?.lines.draw(drawings, plot, pixelsPerCssPx);
  }

  /** Moon and Sun, and stars and planets. */
  private paintBefore(
    gl: WebGL2RenderingContext,
    { point, disc, cones }: Programs,
    { points, sky, veil }: NonNullable<Uploaded["before"]>,
    { grid, plot, area, use, untilPx, isEye }: Work,
  ): void {
    const [left, bottom, width, height] = area;
    const scale = plot.pixelsPerCssPx;
    // Moon and Sun with their glare take the place of the sky.
    gl.disable(gl.BLEND);
    // What ground hides has no glare.
    for (const body of grid.discs) {
      const haloDeg = isEye && body.elevation_deg >= Math.max(grid.horizonAt(body.azimuth_deg), 0) ? HALO_DEG : 0;
      const { xPx, yPx } = plot.projection.pointFromDirection({ azimuthDeg: body.azimuth_deg, elevationDeg: body.elevation_deg });
      if (Number.isNaN(xPx)) continue;
      const reachPx = discReachPx(body, plot, haloDeg) * scale;
      const from = [xPx * scale - reachPx, this.canvas.height - yPx * scale - reachPx].map(Math.floor);
      const boxLeft = Math.max(from[0] ?? 0, left);
      const boxBottom = Math.max(from[1] ?? 0, bottom);
      const boxRight = Math.min((from[0] ?? 0) + 2 * reachPx, left + width, untilPx);
      const boxTop = Math.min((from[1] ?? 0) + 2 * reachPx, bottom + height);
      gl.scissor(boxLeft, boxBottom, Math.max(boxRight - boxLeft, 0), Math.max(boxTop - boxBottom, 0));
      const program = use(disc);
      bind(gl, program, "sky", 0, sky);
      bind(gl, program, "veil", 2, veil);
      bind(gl, program, "cone_table", 1, cones);
      paintDisc(gl, program, body, haloDeg);
    }
    gl.scissor(left, bottom, Math.max(Math.min(width, untilPx - left), 0), height);
    gl.enable(gl.BLEND);
    // A star is never darker than the sky.
    gl.blendEquation(gl.MAX);
    bind(gl, use(point), "cone_table", 1, cones);
    gl.bindVertexArray(points.array);
    gl.drawArrays(gl.POINTS, 0, grid.points.length);
    gl.bindVertexArray(null);
  }

  private use(
    gl: WebGL2RenderingContext,
    program: Program,
    { colours, exposureEv, adaptationCdM2 }: PictureLook,
    { projection, gaze }: SkyPlot,
    [left, bottom, width, height]: Area,
  ): Program {
    gl.useProgram(program.program);
    gl.uniform1i(program.place("projection"), PROJECTIONS.indexOf(projection.name));
    gl.uniform2f(program.place("plot_px"), width, height);
    gl.uniform2f(program.place("origin_px"), left, bottom);
    gl.uniformMatrix3fv(program.place("camera"), false, cameraAxes(gaze));
    gl.uniform1f(program.place("focal_px"), height / 2 / Math.tan((gaze.fieldDeg / 2) * RADIANS));
    gl.uniform1i(program.place("finish"), isOfLight(colours) ? FINISHES.indexOf(colours) : FINISHES.indexOf("table"));
    const isEye = colours === "eye";
    gl.uniform1f(program.place("exposure"), isEye ? exposedScale(exposureEv) : referenceCdM2(exposureEv));
    gl.uniform1f(program.place("adaptation"), adaptationCdM2 ?? 0);
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
      before: hasBefore ? beforeSky(gl, grid, look) : null,
    };
    this.uploads.set(grid, made);
    return made;
  }

  /** The pictures of a landscape; of two at most. */
  private uploadedLand(gl: WebGL2RenderingContext, landscape: Landscape): WebGLTexture {
    const known = this.lands.get(landscape);
    if (known !== undefined) return known;
    for (const [other, texture] of [...this.lands].slice(0, -1)) {
      gl.deleteTexture(texture);
      this.lands.delete(other);
    }
    const made = landTexture(gl, landscape.faces);
    this.lands.set(landscape, made);
    return made;
  }

  private release(gl: WebGL2RenderingContext, grid: SkyGrid, { table, sky, ground, before }: Uploaded): void {
    for (const texture of [table, before?.sky, before?.veil]) gl.deleteTexture(texture ?? null);
    for (const { array } of [sky, ground, ...(before === null ? [] : [before.points])]) gl.deleteVertexArray(array);
    for (const buffer of [sky.vertices, sky.indices, ground.vertices, ground.indices, before?.points.vertices])
      gl.deleteBuffer(buffer ?? null);
    this.uploads.delete(grid);
  }
}

function bind(
  gl: WebGL2RenderingContext,
  program: Program,
  name: string,
  unit: number,
  texture: WebGLTexture,
  kind: GLenum = gl.TEXTURE_2D,
): void {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(kind, texture);
  gl.uniform1i(program.place(name), unit);
}

/** Half a side of the square that a disc lies in, CSS pixels. */
function discReachPx(
  { radius_deg, elevation_deg }: Disc,
  { projection, gaze, plot: { widthPx, heightPx } }: SkyPlot,
  haloDeg: number,
): number {
  const degreesAPx = {
    equirectangular: 90 / heightPx,
    fisheye: 180 / Math.min(widthPx, heightPx),
    perspective: (2 * Math.tan((gaze.fieldDeg / 2) * RADIANS)) / heightPx / RADIANS,
  }[projection.name];
  // Pixels are stretched near the edge of a perspective and high up in a strip.
  return 4 + ((2 / Math.max(Math.cos(elevation_deg * RADIANS), 0.05)) * Math.max(radius_deg, haloDeg)) / degreesAPx;
}

function paintDisc(gl: WebGL2RenderingContext, program: Program, disc: Disc, haloDeg: number): void {
  gl.uniform2f(program.place("middle"), disc.azimuth_deg * RADIANS, disc.elevation_deg * RADIANS);
  gl.uniform1f(program.place("radius"), disc.radius_deg * RADIANS);
  gl.uniform4fv(program.place("lit"), disc.lit_cd_m2);
  gl.uniform4fv(program.place("dark"), disc.dark_cd_m2);
  gl.uniform1f(program.place("lit_share"), disc.lit_share);
  gl.uniform1f(program.place("bright_limb"), disc.bright_limb_deg * RADIANS);
  gl.uniform4fv(program.place("illuminance"), illuminanceOf(disc));
  gl.uniform1f(program.place("halo_deg"), haloDeg);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

/** Columns right, above and ahead, in (east, north, up). */
function cameraAxes(gaze: Gaze): number[] {
  const azimuth = gaze.azimuthDeg * RADIANS;
  const above = vectorFromDirection({ azimuthDeg: gaze.azimuthDeg, elevationDeg: gaze.elevationDeg + 90 });
  return [Math.cos(azimuth), -Math.sin(azimuth), 0, ...above, ...vectorFromDirection(gaze)];
}

/** Stars and planets as vertices with the light of the sky there, and that light for Moon and Sun. A camera has no veil. */
function beforeSky(gl: WebGL2RenderingContext, grid: SkyGrid, { sky, colours }: PictureLook) {
  const samples = Array.from({ length: grid.azimuthCount * grid.elevationCount }, (_, sample) =>
    colours === "eye" ? veiledAt(grid, sky, sample) : { light: grid.eyeAt(sky, sample), veilCdM2: 0 },
  );
  const light = texelsOf(grid, (sample) => samples[sample]?.light ?? []);
  const veil = texelsOf(grid, (sample) => [samples[sample]?.veilCdM2 ?? 0]);
  const size = [grid.azimuthCount, grid.elevationCount + 1] as const;
  const numbers = grid.points.flatMap(({ azimuthDeg, elevationDeg, illuminanceLx }) => [
    azimuthDeg * RADIANS,
    elevationDeg * RADIANS,
    ...illuminanceLx,
    ...grid.between(light, azimuthDeg, elevationDeg),
    dazzle(grid.between(light, azimuthDeg, elevationDeg)[1], grid.between(veil, azimuthDeg, elevationDeg)[0]),
  ]);
  return {
    sky: floatTexture(gl, "RGBA32F", size, light),
    veil: floatTexture(gl, "RGBA32F", size, veil),
    points: vertexArray(gl, new Float32Array(numbers), [2, 4, 4, 1]),
  };
}
