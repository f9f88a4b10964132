// Reads the server's compact panorama: a header, planes of logarithms as differences to their neighbours' gradient, points of light.
// docs/guide.md#compact has the layout.

import type { CompactDisc, CompactHeader, CompactPlane } from "../api/schema.ts";
import { words } from "../language/words.ts";

/** X, photopic, Z and scotopic. */
export type FourValues = readonly [x: number, photopic: number, z: number, scotopic: number];

/** Moon or Sun. */
export type Disc = CompactDisc;

/** What one response sees: [row][column]; hidden samples have the value of the lowest visible one of their column. */
export type Plane = Pick<CompactPlane, "response" | "unit" | "light" | "natural"> & { values: Float32Array };

/** A star or planet that is seen. */
export interface PointLight {
  azimuthDeg: number;
  elevationDeg: number;
  /** Across its beam. */
  illuminanceLx: FourValues;
}

export type CompactPanorama = Pick<CompactHeader, "grid" | "clouds" | "response" | "horizon_deg" | "discs"> & {
  planes: Plane[];
  points: PointLight[];
};

const MAGIC = "SKYGLOW\x01";
/** Magic number and length of the header. */
const HEADER_AT = 12;
const ANGLE_STEPS = 65_536;
/** The plane that the others of its light are compared with. */
const BASE = 1;

export function readCompactPanorama(buffer: ArrayBuffer): CompactPanorama {
  const bytes = new Uint8Array(buffer);
  if (String.fromCharCode(...bytes.subarray(0, MAGIC.length)) !== MAGIC) throw new Error(words().problems.notAPanorama);
  const headerLength = new DataView(buffer).getUint32(MAGIC.length, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(HEADER_AT, HEADER_AT + headerLength))) as CompactHeader;
  const { grid, points, steps_per_e: stepsPerE } = header;
  const reader = new Reader(bytes, HEADER_AT + headerLength, stepsPerE);
  const sizes: Size = { width: grid.azimuth_count, count: grid.azimuth_count * grid.elevation_count };
  const planes = (["artificial", "total"] as const).flatMap((light) => {
    const group = header.planes.filter((plane) => plane.light === light);
    const values = reader.group(
      group.map(({ lowest }) => lowest),
      sizes,
    );
    return group.map(({ lowest: _, ...plane }, i) => ({ ...plane, values: values[i] ?? new Float32Array() }));
  });
  const azimuths = reader.numbers(points.count);
  const elevations = reader.numbers(points.count);
  const [x, photopic, z, scotopic] = reader.group(points.lowest_lx, { width: Math.max(points.count, 1), count: points.count });
  reader.end();
  return {
    ...header,
    planes,
    points: Array.from({ length: points.count }, (_, i) => ({
      azimuthDeg: ((azimuths[i] ?? 0) / ANGLE_STEPS) * 360,
      elevationDeg: (((elevations[i] ?? 0) + 0.5) / ANGLE_STEPS) * 90,
      illuminanceLx: [x?.[i] ?? 0, photopic?.[i] ?? 0, z?.[i] ?? 0, scotopic?.[i] ?? 0],
    })),
  };
}

interface Size {
  width: number;
  count: number;
}

class Reader {
  constructor(
    private readonly bytes: Uint8Array,
    private at: number,
    private readonly stepsPerE: number,
  ) {}

  /** Numbers of 16 bits: all low bytes come before all high ones. */
  numbers(count: number): Uint16Array {
    const { bytes, at } = this;
    if (at + 2 * count > bytes.length) throw new Error(words().problems.notAPanorama);
    this.at += 2 * count;
    return Uint16Array.from({ length: count }, (_, i) => (bytes[at + i] ?? 0) | ((bytes[at + count + i] ?? 0) << 8));
  }

  /** Planes that belong together. */
  group(lowest: readonly number[], size: Size): Float32Array[] {
    const codes = lowest.map(() => this.summed(size));
    return codes.map((plane, place) => {
      const base = place === BASE ? undefined : codes[BASE];
      return Float32Array.from(plane, (code, i) => {
        const whole = base === undefined ? code : (code + (base[i] ?? 0)) & 0xffff;
        return whole === 0 ? 0 : (lowest[place] ?? 0) * Math.exp((whole - 1) / this.stepsPerE);
      });
    });
  }

  end(): void {
    if (this.at !== this.bytes.length) throw new Error(words().problems.notAPanorama);
  }

  /** The plane of which the file has the differences to what the left, lower and lower left neighbours predict. */
  private summed({ width, count }: Size): Uint16Array {
    const plane = this.numbers(count);
    for (let i = 0; i < count; i++) {
      const zigzag = plane[i] ?? 0;
      const left = i % width === 0 ? 0 : (plane[i - 1] ?? 0);
      const low = i < width ? 0 : (plane[i - width] ?? 0);
      const both = i % width === 0 || i < width ? 0 : (plane[i - width - 1] ?? 0);
      plane[i] = ((zigzag >> 1) ^ -(zigzag & 1)) + left + low - both;
    }
    return plane;
  }
}
