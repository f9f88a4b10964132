import assert from "node:assert/strict";
import { test } from "node:test";
import { compressed, dithered, gifOf, type Pixels, paletteOf } from "./gif.ts";

function picture(width: number, height: number, colourAt: (x: number, y: number) => readonly number[]): Pixels {
  const data = new Uint8ClampedArray(4 * width * height);
  for (let i = 0; i < width * height; i++) data.set([...colourAt(i % width, Math.floor(i / width)), 255], 4 * i);
  return { width, height, data };
}

/** What a reader of GIF makes of LZW (GIF89a, appendix F). */
function expanded(bytes: readonly number[]): number[] {
  const found: number[] = [];
  let [at, bit, size] = [0, 0, 9];
  let table: number[][] = [];
  const clear = () => {
    table = Array.from({ length: 258 }, (_, i) => (i < 256 ? [i] : []));
    size = 9;
  };
  const read = () => {
    let code = 0;
    for (let n = 0; n < size; n++) {
      code |= (((bytes[at] ?? 0) >> bit) & 1) << n;
      bit += 1;
      if (bit === 8) [at, bit] = [at + 1, 0];
    }
    return code;
  };
  clear();
  let before: number[] | null = null;
  for (;;) {
    const code = read();
    if (code === 257) return found;
    if (code === 256) {
      clear();
      before = null;
      continue;
    }
    const entry: number[] = table[code] ?? [...(before ?? []), before?.[0] ?? 0];
    found.push(...entry);
    if (before !== null && table.length < 4096) table.push([...before, entry[0] as number]);
    before = entry;
    if (table.length === 1 << size && size < 12) size += 1;
  }
}

/** Codes of all sizes, and a table that is full and begun anew, come back as they were. */
test("what is compressed comes back", () => {
  let seed = 1;
  const random = () => {
    seed = (seed * 1103515245 + 12345) % 2 ** 31;
    return seed >> 16;
  };
  for (const length of [1, 2, 300, 30_000]) {
    const indices = Uint8Array.from({ length }, () => random() % 256);
    assert.deepEqual(expanded(compressed(indices)), [...indices], `noise of ${length}`);
    const even = new Uint8Array(length).fill(7);
    assert.deepEqual(expanded(compressed(even)), [...even], `one colour, ${length}`);
  }
});

/** A gradient of more shades than a GIF has is, seen from a distance, the same: no bands. */
test("a dark gradient has no bands", () => {
  const [width, height] = [400, 64];
  // From blue-grey to a dull orange, as over a town, with noise of other colours to take colours away.
  const shade = (x: number) => [10 + 0.12 * x, 12 + 0.08 * x, 20 + 0.03 * x];
  const smooth = picture(width, height, (x, y) =>
    y < 4 ? [(37 * x) % 256, (91 * x) % 256, (53 * x) % 256] : shade(x).map(Math.round),
  );
  const palette = paletteOf([smooth]);
  assert.ok(palette.length <= 256);
  const indices = dithered(smooth, palette);
  let largest = 0;
  for (let x = 8; x + 16 < width; x += 8)
    for (const c of [0, 1, 2] as const) {
      let [sum, wanted, count] = [0, 0, 0];
      for (let y = 8; y < height; y++)
        for (let i = x; i < x + 16; i++) {
          sum += palette[indices[y * width + i] as number]?.[c] ?? 0;
          wanted += Math.round(shade(i)[c] as number);
          count += 1;
        }
      largest = Math.max(largest, Math.abs(sum - wanted) / count);
    }
  assert.ok(largest < 0.5, `a mean is ${largest} off`);
});

test("few colours are kept as they are", () => {
  const flag = picture(6, 4, (x) => (x < 3 ? [200, 10, 10] : [10, 10, 200]));
  const palette = paletteOf([flag]);
  assert.deepEqual(new Set(palette.map(String)), new Set(["200,10,10", "10,10,200"]));
  const indices = dithered(flag, palette);
  assert.deepEqual(palette[indices[0] as number], [200, 10, 10]);
  assert.deepEqual(palette[indices[5] as number], [10, 10, 200]);
});

test("a GIF has its pictures for as long", () => {
  const pictures = [10, 200].map((grey) => picture(5, 3, () => [grey, grey, grey]));
  const file = gifOf(pictures, 2000);
  assert.ok(file !== null);
  assert.equal(Buffer.from(file.subarray(0, 6)).toString("latin1"), "GIF89a");
  assert.deepEqual([file[6], file[8], file.at(-1)], [5, 3, 0x3b]);
  const controls = [...file.keys()].filter((at) => file[at] === 0x21 && file[at + 1] === 0xf9);
  assert.deepEqual(
    controls.map((at) => (file[at + 4] ?? 0) + 256 * (file[at + 5] ?? 0)),
    [200, 200],
  );
  assert.equal(gifOf([picture(1, 1, () => [0, 0, 0]), picture(2, 1, () => [0, 0, 0])], 100), null);
  assert.equal(gifOf([], 100), null);
});
