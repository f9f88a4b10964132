// The land in light all around, as the server pictures it.

import { facePoint } from "./land-faces.ts";
import { type SkyDirection, vectorFromDirection } from "./projection.ts";

export class Landscape {
  /** What is read without a GPU. */
  private pixels: Uint8ClampedArray[] | null = null;

  /** Pictures of one size, in the order of `faceGazes`, and what draws them: it comes with the first. */
  constructor(
    readonly faces: readonly ImageBitmap[],
    readonly fragmentShader: string,
  ) {}

  /** The bytes of the nearest pixel. */
  rgbAt(direction: SkyDirection): Uint8ClampedArray {
    this.pixels ??= this.faces.map(pixelsOf);
    const { face, across, down } = facePoint(vectorFromDirection(direction));
    const sidePx = this.faces[face]?.width ?? 1;
    const place = (part: number) => Math.min(Math.max(Math.floor(part * sidePx), 0), sidePx - 1);
    const at = 4 * (place(down) * sidePx + place(across));
    return this.pixels[face]?.subarray(at, at + 3) ?? new Uint8ClampedArray(3);
  }

  /** It is shown no more. */
  close(): void {
    for (const face of this.faces) face.close();
  }
}

function pixelsOf(face: ImageBitmap): Uint8ClampedArray {
  const context = new OffscreenCanvas(face.width, face.height).getContext("2d");
  context?.drawImage(face, 0, 0);
  return context?.getImageData(0, 0, face.width, face.height).data ?? new Uint8ClampedArray();
}
