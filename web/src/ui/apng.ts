// Pictures one after the other in one file: an animated PNG (PNG, third edition, W3C 2025), which every browser plays and every other
// program shows the first picture of. The pictures are PNGs of one size and kind; their compressed bytes stay as they are.

const SIGNATURE = [137, 80, 78, 71, 13, 10, 26, 10] as const;
/** Bytes of length, type and checksum around the data of a chunk. */
const AROUND = 12;

interface Chunk {
  type: string;
  data: Uint8Array;
}

/** The chunks of a PNG. */
export function chunksOf(png: Uint8Array): Chunk[] {
  const view = new DataView(png.buffer, png.byteOffset, png.byteLength);
  const chunks: Chunk[] = [];
  for (let at = SIGNATURE.length; at + AROUND <= png.length; ) {
    const length = view.getUint32(at);
    const type = String.fromCharCode(...png.subarray(at + 4, at + 8));
    chunks.push({ type, data: png.subarray(at + 8, at + 8 + length) });
    at += AROUND + length;
  }
  return chunks;
}

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? 0xedb88320 ^ (crc >>> 1) : crc >>> 1;
  return crc;
});

function crcOf(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = (CRC_TABLE[(crc ^ byte) & 0xff] as number) ^ (crc >>> 8);
  return ~crc >>> 0;
}

function written({ type, data }: Chunk): Uint8Array {
  const bytes = new Uint8Array(AROUND + data.length);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, data.length);
  bytes.set(
    [...type].map((letter) => letter.charCodeAt(0)),
    4,
  );
  bytes.set(data, 8);
  view.setUint32(8 + data.length, crcOf(bytes.subarray(4, 8 + data.length)));
  return bytes;
}

/** Data of 32-bit and 16-bit numbers. */
function numbers(...values: readonly (readonly [value: number, bytes: 1 | 2 | 4])[]): Uint8Array {
  const data = new Uint8Array(values.reduce((sum, [, bytes]) => sum + bytes, 0));
  const view = new DataView(data.buffer);
  let at = 0;
  for (const [value, bytes] of values) {
    if (bytes === 4) view.setUint32(at, value);
    else if (bytes === 2) view.setUint16(at, value);
    else view.setUint8(at, value);
    at += bytes;
  }
  return data;
}

/** The pictures in a circle for ever, each for so long; null where they are not of one size and kind. */
export function animated(pictures: readonly Uint8Array[], eachMs: number): Uint8Array<ArrayBuffer> | null {
  const all = pictures.map(chunksOf);
  const header = all[0]?.find(({ type }) => type === "IHDR")?.data;
  const isAlike = ({ type, data }: Chunk) => type !== "IHDR" || (header !== undefined && data.join() === header.join());
  if (header === undefined || !all.every((chunks) => chunks.every(isAlike))) return null;
  const size = new DataView(header.buffer, header.byteOffset);
  let sequence = 0;
  const parts: Uint8Array[] = [Uint8Array.from(SIGNATURE), written({ type: "IHDR", data: header })];
  parts.push(written({ type: "acTL", data: numbers([pictures.length, 4], [0, 4]) }));
  all.forEach((chunks, picture) => {
    const [width, height] = [size.getUint32(0), size.getUint32(4)];
    const place = [
      [width, 4],
      [height, 4],
      [0, 4],
      [0, 4],
    ] as const;
    // The whole picture takes the place of the one before.
    const control = numbers([sequence++, 4], ...place, [eachMs, 2], [1000, 2], [0, 1], [0, 1]);
    parts.push(written({ type: "fcTL", data: control }));
    for (const { type, data } of chunks) {
      if (type !== "IDAT") continue;
      if (picture === 0) parts.push(written({ type, data }));
      else {
        const numbered = new Uint8Array(4 + data.length);
        numbered.set(numbers([sequence++, 4]));
        numbered.set(data, 4);
        parts.push(written({ type: "fdAT", data: numbered }));
      }
    }
  });
  parts.push(written({ type: "IEND", data: new Uint8Array() }));
  const file = new Uint8Array(parts.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const part of parts) {
    file.set(part, at);
    at += part.length;
  }
  return file;
}
