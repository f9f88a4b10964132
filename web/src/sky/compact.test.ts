import assert from "node:assert/strict";
import { test } from "node:test";
import { readCompactPanorama } from "./compact.ts";

const STEPS_PER_E = 2048;
const WIDTH = 4;

/** Codes as the server stores them: differences to the neighbours' gradient, then all low and all high bytes. */
function stored(codes: readonly number[], width: number): number[] {
  const zigzag = codes.map((code, i) => {
    const before = (back: number, isThere: boolean) => (isThere ? (codes[i - back] ?? 0) : 0);
    const [hasLeft, hasLow] = [i % width > 0, i >= width];
    const predicted = before(1, hasLeft) + before(width, hasLow) - before(width + 1, hasLeft && hasLow);
    const difference = ((code - predicted) << 16) >> 16;
    return ((difference << 1) ^ (difference >> 15)) & 0xffff;
  });
  return [...zigzag.map((value) => value & 0xff), ...zigzag.map((value) => value >> 8)];
}

/** A file of two planes of 4 × 2 samples and one star. */
function file(planes: readonly number[][], star: readonly number[]): ArrayBuffer {
  const header = new TextEncoder().encode(
    JSON.stringify({
      grid: { azimuth_count: WIDTH, elevation_count: 2 },
      clouds: "none",
      response: { name: "photopic", unit: "cd m-2" },
      steps_per_e: STEPS_PER_E,
      horizon_deg: [0, 0, 0, 0],
      planes: ["cie_x", "photopic"].map((response) => ({
        response,
        unit: "cd m-2",
        light: "artificial",
        natural: 1,
        lowest: 1e-6,
      })),
      points: { count: 1, lowest_lx: [1e-9, 1e-9, 1e-9, 1e-9] },
      discs: [],
    }),
  );
  const [x = [], photopic = []] = planes;
  const above = (codes: readonly number[], base: readonly number[]) => codes.map((code, i) => (code - (base[i] ?? 0)) & 0xffff);
  const [azimuth = 0, elevation = 0, brightness = 0] = star;
  const bytes = [
    ...new TextEncoder().encode("SKYGLOW\x01"),
    header.length & 0xff,
    header.length >> 8,
    0,
    0,
    ...header,
    ...stored(above(x, photopic), WIDTH),
    ...stored(photopic, WIDTH),
    ...[azimuth & 0xff, azimuth >> 8, elevation & 0xff, elevation >> 8],
    ...stored([STEPS_PER_E], 1),
    ...stored([brightness], 1),
    ...stored([0], 1),
    ...stored([0], 1),
  ];
  return Uint8Array.from(bytes).buffer;
}

const PHOTOPIC = [1, 2, 60_000, 65_535, 0, 700, 1024, 2049];
const X = [5, 0, 59_000, 65_000, 1, 701, 1000, 0];

/** Logarithms of any size come back, darkness and steps over the end of 16 bits with them. */
test("planes and points are read", () => {
  const { planes, points } = readCompactPanorama(file([X, PHOTOPIC], [0x4000, 0x8000, 1]));
  for (const [i, codes] of [X, PHOTOPIC].entries()) {
    codes.forEach((code, at) => {
      const value = code === 0 ? 0 : 1e-6 * Math.exp((code - 1) / STEPS_PER_E);
      const found = planes[i]?.values[at] ?? NaN;
      assert.ok(Math.abs(found - value) <= 1e-6 * value, `${i} ${at}: ${found} for ${value}`);
    });
  }
  const [point] = points;
  assert.ok(points.length === 1 && point?.azimuthDeg === 90 && Math.abs(point.elevationDeg - 45) < 1e-2);
  assert.ok(Math.abs(point.illuminanceLx[1] / 1e-9 - 1) < 1e-6 && Math.abs(point.illuminanceLx[0] / 1e-9 / Math.E - 1) < 1e-6);
});

/** What is no panorama, is cut off or goes on is refused. */
test("other files are refused", () => {
  const good = file([X, PHOTOPIC], [0, 0, 1]);
  const longer = new Uint8Array(good.byteLength + 1);
  longer.set(new Uint8Array(good));
  for (const bad of [good.slice(0, -1), longer.buffer, good.slice(1), new ArrayBuffer(0)]) {
    assert.throws(() => readCompactPanorama(bad), /no panorama/);
  }
});
