// Lines and names over the sky by WebGL, while it moves: a canvas that WebGL paints is shown as it is, and drawing the same on a
// canvas of the processor takes longer than the sky.

import { Program, pictureTexture } from "./gl.ts";
import { type Drawing, drawName, type Ink, type Name, placed } from "./lines.ts";
import type { Plot } from "./projection.ts";
import lineFragment from "./shaders/line.frag?raw";
import lineVertex from "./shaders/line.vert?raw";
import nameFragment from "./shaders/name.frag?raw";
import nameVertex from "./shaders/name.vert?raw";

interface Written {
  texture: WebGLTexture;
  widthPx: number;
  heightPx: number;
}

/** Names that are kept; more are written anew. */
const MAX_WRITTEN = 96;
/** Room around a name for its edge. */
const ROOM_PX = 6;

export class LiveLines {
  private readonly line: Program;
  private readonly name: Program;
  private readonly ends: WebGLBuffer;
  private readonly array: WebGLVertexArrayObject;
  private readonly written = new Map<string, Written>();
  private readonly page = document.createElement("canvas").getContext("2d", { willReadFrequently: true });

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.line = new Program(gl, lineVertex, lineFragment);
    this.name = new Program(gl, nameVertex, nameFragment);
    this.ends = gl.createBuffer();
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.ends);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    gl.bindVertexArray(null);
  }

  /** Draws over what is on the canvas, `pixelsPerCssPx` device pixels a CSS pixel. */
  draw(drawings: readonly Drawing[], plot: Plot, pixelsPerCssPx: number): void {
    const { gl } = this;
    const { width, height } = gl.canvas;
    gl.viewport(0, 0, width, height);
    gl.enable(gl.BLEND);
    gl.blendEquation(gl.FUNC_ADD);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.bindVertexArray(this.array);
    for (const drawing of drawings) {
      const clipped = [plot.leftPx, height / pixelsPerCssPx - plot.topPx - plot.heightPx, plot.widthPx, plot.heightPx] as const;
      const [left, bottom, wide, high] = clipped.map((px) => Math.round(px * pixelsPerCssPx)) as [number, number, number, number];
      if (drawing.isClipped) gl.scissor(left, bottom, wide, high);
      else gl.scissor(0, 0, width, height);
      this.drawLines(drawing, [width / pixelsPerCssPx, height / pixelsPerCssPx]);
      this.drawNames(drawing, [width / pixelsPerCssPx, height / pixelsPerCssPx], pixelsPerCssPx);
    }
    gl.bindVertexArray(null);
  }

  private drawLines({ lines }: Drawing, canvasPx: readonly [number, number]): void {
    const { gl, line } = this;
    const byInk = new Map<Ink, number[]>();
    for (const { points, ink } of lines) {
      const ends = byInk.get(ink) ?? [];
      byInk.set(ink, ends);
      points.forEach((point, i) => {
        const before = points[i - 1];
        if (before !== undefined) ends.push(...before, ...point);
      });
    }
    gl.useProgram(line.program);
    gl.uniform2f(line.place("canvas_px"), ...canvasPx);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.ends);
    for (const [[red, green, blue, part], ends] of byInk) {
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(ends), gl.DYNAMIC_DRAW);
      const [r, g, b] = [red, green, blue].map((channel) => (channel / 255) * part) as [number, number, number];
      gl.uniform4f(line.place("ink"), r, g, b, part);
      gl.drawArrays(gl.LINES, 0, ends.length / 2);
    }
  }

  private drawNames({ names }: Drawing, canvasPx: readonly [number, number], pixelsPerCssPx: number): void {
    const { gl, name, page } = this;
    if (page === null) return;
    gl.useProgram(name.program);
    gl.uniform2f(name.place("canvas_px"), ...canvasPx);
    gl.activeTexture(gl.TEXTURE0);
    gl.uniform1i(name.place("written"), 0);
    for (const each of names) {
      const { texture, widthPx, heightPx } = this.writing(page, each, pixelsPerCssPx);
      const [xPx, yPx] = placed(page, each);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.uniform4f(name.place("box_px"), xPx - widthPx / 2, yPx - heightPx / 2, widthPx, heightPx);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
  }

  /** A name on a texture, whose middle is the point that it is written at. */
  private writing(page: CanvasRenderingContext2D, name: Name, pixelsPerCssPx: number): Written {
    const key = [name.text, name.font, name.ink, name.align, name.baseline, pixelsPerCssPx].join();
    const known = this.written.get(key);
    if (known !== undefined) return known;
    if (this.written.size >= MAX_WRITTEN) this.forget();
    page.font = name.font;
    const { width, fontBoundingBoxAscent, fontBoundingBoxDescent } = page.measureText(name.text);
    const size = [2 * (width + ROOM_PX), 2 * (fontBoundingBoxAscent + fontBoundingBoxDescent + ROOM_PX)] as const;
    const [wide, high] = size.map((px) => Math.ceil(px * pixelsPerCssPx)) as [number, number];
    page.canvas.width = wide;
    page.canvas.height = high;
    page.setTransform(pixelsPerCssPx, 0, 0, pixelsPerCssPx, 0, 0);
    const [widthPx, heightPx] = [wide / pixelsPerCssPx, high / pixelsPerCssPx];
    const { within: _, ...free } = name;
    drawName(page, { ...free, at: [widthPx / 2, heightPx / 2] });
    const made = { texture: pictureTexture(this.gl, page.canvas), widthPx, heightPx };
    this.written.set(key, made);
    return made;
  }

  private forget(): void {
    for (const { texture } of this.written.values()) this.gl.deleteTexture(texture);
    this.written.clear();
  }
}
