// Programs and textures of WebGL2.

type Size = readonly [width: number, height: number];

/** A program with its uniforms by name. */
export class Program {
  readonly program: WebGLProgram;
  private readonly places = new Map<string, WebGLUniformLocation | null>();

  constructor(
    private readonly gl: WebGL2RenderingContext,
    vertex: string,
    fragment: string,
  ) {
    this.program = gl.createProgram();
    for (const [type, text] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ] as const) {
      const shader = gl.createShader(type);
      if (shader === null) continue;
      gl.shaderSource(
        shader,
        `#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\nprecision highp sampler2DArray;\n${text}`,
      );
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
        throw new Error(gl.getShaderInfoLog(shader) ?? "");
      gl.attachShader(this.program, shader);
      gl.deleteShader(shader);
    }
    gl.linkProgram(this.program);
    // A lost context links nothing, and comes back with a program of its own.
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost())
      throw new Error(gl.getProgramInfoLog(this.program) ?? "");
  }

  place(name: string): WebGLUniformLocation | null {
    if (!this.places.has(name)) this.places.set(name, this.gl.getUniformLocation(this.program, name));
    return this.places.get(name) ?? null;
  }
}

/** A texture of floats: four of 32 bits, which are not interpolated, or one of 16 bits, which is. */
export function floatTexture(gl: WebGL2RenderingContext, format: "RGBA32F" | "R16F", size: Size, data: Float32Array) {
  return texture(gl, () => {
    const isLight = format !== "R16F";
    gl.texImage2D(gl.TEXTURE_2D, 0, gl[format], ...size, 0, isLight ? gl.RGBA : gl.RED, gl.FLOAT, data);
    return format === "RGBA32F" ? gl.NEAREST : gl.LINEAR;
  });
}

/** A row of colours, bytes. */
export function colourTexture(gl: WebGL2RenderingContext, rgb: Uint8ClampedArray) {
  return texture(gl, () => {
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, rgb.length / 3, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array(rgb));
    return gl.NEAREST;
  });
}

/** What is on a canvas, with colours premultiplied. */
export function pictureTexture(gl: WebGL2RenderingContext, source: HTMLCanvasElement) {
  return texture(gl, () => {
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, true);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, source);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    return gl.LINEAR;
  });
}

/** Pictures of one size in layers, that light is averaged of where they are shown smaller. */
export function landTexture(gl: WebGL2RenderingContext, pictures: readonly ImageBitmap[]): WebGLTexture {
  const made = gl.createTexture();
  const kind = gl.TEXTURE_2D_ARRAY;
  const { width = 1, height = 1 } = pictures[0] ?? {};
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(kind, made);
  gl.texStorage3D(kind, Math.floor(Math.log2(Math.max(width, height))) + 1, gl.SRGB8_ALPHA8, width, height, pictures.length);
  pictures.forEach((picture, layer) => {
    gl.texSubImage3D(kind, 0, 0, 0, layer, width, height, 1, gl.RGBA, gl.UNSIGNED_BYTE, picture);
  });
  gl.generateMipmap(kind);
  gl.texParameteri(kind, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_NEAREST);
  gl.texParameteri(kind, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(kind, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(kind, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return made;
}

function texture(gl: WebGL2RenderingContext, fill: () => number): WebGLTexture {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  const filter = fill();
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
  // Azimuths go round.
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.REPEAT);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return made;
}
