// Moving pictures for programs that play no animated PNG: a GIF (GIF89a, CompuServe 1990). It has 256 colours for all of its pictures,
// so they are chosen by median cut (Heckbert 1982) and what they miss is spread over the pixels beside (Floyd and Steinberg 1976):
// a dark sky is one long gradient, which would fall into bands.

const MAX_COLOURS = 256;
/** Bits of a channel by which the nearest colour is remembered. */
const KEY_BITS = 7;
/** Codes of LZW have at most 12 bits. */
const MAX_CODES = 4096;
const CLEAR = MAX_COLOURS;
const END = MAX_COLOURS + 1;

/** A picture's pixels, four bytes each; all are opaque. */
export interface Pixels {
  width: number;
  height: number;
  data: Uint8ClampedArray;
}

type Colour = readonly [red: number, green: number, blue: number];

interface Box {
  /** Colours with how many pixels have them. */
  colours: (readonly [...Colour, count: number])[];
  /** The channel that spreads most, and how much: weighed by how many pixels it would serve. */
  channel: 0 | 1 | 2;
  need: number;
}

function boxOf(colours: Box["colours"]): Box {
  let [channel, widest]: [0 | 1 | 2, number] = [0, -1];
  for (const at of [0, 1, 2] as const) {
    let [least, most] = [255, 0];
    for (const colour of colours) {
      least = Math.min(least, colour[at]);
      most = Math.max(most, colour[at]);
    }
    if (most - least > widest) [channel, widest] = [at, most - least];
  }
  const pixels = colours.reduce((sum, [, , , count]) => sum + count, 0);
  // A gradient over many pixels is seen more than a word's edges: its square root lets small bright things have colours too.
  return { colours, channel, need: colours.length < 2 ? 0 : widest * Math.sqrt(pixels) };
}

/** Colours that stand for those of all pictures. */
export function paletteOf(pictures: readonly Pixels[]): Colour[] {
  const counts = new Map<number, number>();
  for (const { data } of pictures)
    for (let i = 0; i < data.length; i += 4) {
      const key = ((data[i] as number) << 16) | ((data[i + 1] as number) << 8) | (data[i + 2] as number);
      counts.set(key, (counts.get(key) ?? 0) + 1);
    }
  const all = [...counts].map(([key, count]) => [key >> 16, (key >> 8) & 255, key & 255, count] as const);
  const boxes = [boxOf(all)];
  while (boxes.length < MAX_COLOURS) {
    const widest = boxes.reduce((most, box) => (box.need > most.need ? box : most));
    if (widest.need === 0) break;
    const { colours, channel } = widest;
    colours.sort((a, b) => a[channel] - b[channel]);
    const half = colours.reduce((sum, [, , , count]) => sum + count, 0) / 2;
    let [cut, sum] = [0, 0];
    while (cut < colours.length - 1 && sum < half) sum += colours[cut++]?.[3] ?? 0;
    cut = Math.max(cut, 1);
    boxes.splice(boxes.indexOf(widest), 1, boxOf(colours.slice(0, cut)), boxOf(colours.slice(cut)));
  }
  return boxes.map(({ colours }) => {
    const pixels = colours.reduce((sum, [, , , count]) => sum + count, 0);
    const mean = (at: 0 | 1 | 2) => Math.round(colours.reduce((sum, colour) => sum + colour[at] * colour[3], 0) / pixels);
    return [mean(0), mean(1), mean(2)];
  });
}

/** For every pixel the number of a colour; what each misses is spread over those that come next. */
export function dithered({ width, height, data }: Pixels, palette: readonly Colour[]): Uint8Array {
  const nearest = new Int16Array(1 << (3 * KEY_BITS)).fill(-1);
  const find = (red: number, green: number, blue: number): number => {
    const shift = 8 - KEY_BITS;
    const key = ((red >> shift) << (2 * KEY_BITS)) | ((green >> shift) << KEY_BITS) | (blue >> shift);
    const known = nearest[key] as number;
    if (known >= 0) return known;
    let [best, least] = [0, Number.POSITIVE_INFINITY];
    palette.forEach(([r, g, b], i) => {
      // The eye sees differences of green most.
      const distance = 2 * (r - red) ** 2 + 4 * (g - green) ** 2 + 3 * (b - blue) ** 2;
      if (distance < least) [best, least] = [i, distance];
    });
    nearest[key] = best;
    return best;
  };
  const indices = new Uint8Array(width * height);
  // Of this row and the next, three channels a pixel, with a pixel beside each end.
  let [errors, after] = [new Float32Array(3 * (width + 2)), new Float32Array(3 * (width + 2))];
  for (let y = 0; y < height; y++) {
    // Rows go there and back, so that no pattern leans to one side.
    const step = y % 2 === 0 ? 1 : -1;
    for (let n = 0; n < width; n++) {
      const x = step > 0 ? n : width - 1 - n;
      const at = 3 * (x + 1);
      const from = 4 * (y * width + x);
      const value = (c: number) => Math.min(Math.max(Math.round((data[from + c] as number) + (errors[at + c] as number)), 0), 255);
      const wanted = [value(0), value(1), value(2)] as const;
      const index = find(...wanted);
      indices[y * width + x] = index;
      const colour = palette[index] as Colour;
      for (let c = 0; c < 3; c++) {
        const missed = ((wanted[c] as number) - (colour[c] as number)) / 16;
        errors[at + 3 * step + c] = (errors[at + 3 * step + c] as number) + 7 * missed;
        after[at - 3 * step + c] = (after[at - 3 * step + c] as number) + 3 * missed;
        after[at + c] = (after[at + c] as number) + 5 * missed;
        after[at + 3 * step + c] = (after[at + 3 * step + c] as number) + missed;
      }
    }
    [errors, after] = [after, errors.fill(0)];
  }
  return indices;
}

/** LZW with codes that grow from 9 to 12 bits, the lowest bit first. */
export function compressed(indices: Uint8Array): number[] {
  const bytes: number[] = [];
  let [bits, held] = [0, 0];
  let size = 9;
  const write = (code: number) => {
    bits |= code << held;
    held += size;
    for (; held >= 8; held -= 8) {
      bytes.push(bits & 255);
      bits >>>= 8;
    }
  };
  let codes = new Map<number, number>();
  write(CLEAR);
  let prefix = indices[0] as number;
  for (const index of indices.subarray(1)) {
    const key = prefix * MAX_COLOURS + index;
    const known = codes.get(key);
    if (known !== undefined) {
      prefix = known;
      continue;
    }
    write(prefix);
    prefix = index;
    const next = END + 1 + codes.size;
    if (next === MAX_CODES) {
      write(CLEAR);
      codes = new Map();
      size = 9;
      continue;
    }
    // A reader knows a code one later than it was made.
    if (next === 1 << size) size += 1;
    codes.set(key, next);
  }
  write(prefix);
  write(END);
  if (held > 0) bytes.push(bits & 255);
  return bytes;
}

/** The pictures in a circle for ever, each for so long; null where they are not of one size. */
export function gifOf(pictures: readonly Pixels[], eachMs: number): Uint8Array<ArrayBuffer> | null {
  const [first] = pictures;
  if (first === undefined) return null;
  const { width, height } = first;
  if (pictures.some((picture) => picture.width !== width || picture.height !== height)) return null;
  const palette = paletteOf(pictures);
  const short = (value: number) => [value & 255, value >> 8];
  const table = Array.from({ length: MAX_COLOURS }, (_, i) => palette[i] ?? [0, 0, 0]).flat();
  const text = (letters: string) => [...letters].map((letter) => letter.charCodeAt(0));
  const parts: (readonly number[])[] = [
    // A table of 256 colours for all.
    [...text("GIF89a"), ...short(width), ...short(height), 0xf7, 0, 0, ...table],
    [0x21, 0xff, 11, ...text("NETSCAPE2.0"), 3, 1, ...short(0), 0],
  ];
  for (const picture of pictures) {
    parts.push([0x21, 0xf9, 4, 0, ...short(Math.round(eachMs / 10)), 0, 0]);
    parts.push([0x2c, ...short(0), ...short(0), ...short(width), ...short(height), 0, 8]);
    const bytes = compressed(dithered(picture, palette));
    for (let at = 0; at < bytes.length; at += 255) {
      const block = bytes.slice(at, at + 255);
      parts.push([block.length, ...block]);
    }
    parts.push([0]);
  }
  parts.push([0x3b]);
  return Uint8Array.from(parts.flat());
}
