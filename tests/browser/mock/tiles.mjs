// Map tiles of the stand-in: glowing towns and rolling hills, as indexed-free RGBA PNG.
import { deflateSync, crc32 as zlibCrc32 } from "node:zlib";
import { TOWNS } from "./sky.mjs";

const SIZE = 256;

function crc32(bytes) {
  if (zlibCrc32 !== undefined) return zlibCrc32(bytes);
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  }
  return ~crc >>> 0;
}

function chunk(type, data) {
  const body = Buffer.concat([Buffer.from(type, "latin1"), data]);
  const out = Buffer.alloc(body.length + 8);
  out.writeUInt32BE(data.length, 0);
  body.copy(out, 4);
  out.writeUInt32BE(crc32(body), body.length + 4);
  return out;
}

function png(pixels) {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(SIZE, 0);
  header.writeUInt32BE(SIZE, 4);
  header.set([8, 6, 0, 0, 0], 8);
  const rows = Buffer.alloc(SIZE * (SIZE * 4 + 1));
  for (let y = 0; y < SIZE; y++) pixels.copy(rows, y * (SIZE * 4 + 1) + 1, y * SIZE * 4, (y + 1) * SIZE * 4);
  return Buffer.concat([
    Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]),
    chunk("IHDR", header),
    chunk("IDAT", deflateSync(rows)),
    chunk("IEND", Buffer.alloc(0)),
  ]);
}

export function tile(layer, z, x, y) {
  const pixels = Buffer.alloc(SIZE * SIZE * 4);
  const world = SIZE * 2 ** z;
  for (let row = 0; row < SIZE; row++) {
    const latitude = (Math.atan(Math.sinh(Math.PI * (1 - (2 * (y * SIZE + row + 0.5)) / world))) * 180) / Math.PI;
    for (let column = 0; column < SIZE; column++) {
      const longitude = ((x * SIZE + column + 0.5) / world) * 360 - 180;
      let rgba;
      if (layer !== "elevation") {
        let light = 0;
        for (const town of TOWNS) {
          const d = Math.hypot(latitude - town.latitude_deg, longitude - town.longitude_deg);
          light += Math.exp(-((d / (0.04 + 0.05 * Math.sqrt(town.population / 1e6))) ** 2));
        }
        const t = Math.min(1, light);
        rgba = [255, 190 + 60 * t, 90 + 150 * t, 255 * Math.min(1, t * 1.3)];
      } else {
        const h = 0.5 + 0.25 * Math.sin(longitude * 9) + 0.25 * Math.cos(latitude * 11 + longitude * 3);
        rgba = [60 + 150 * h, 80 + 110 * h, 90 + 60 * h, 255];
      }
      pixels.set(rgba, (row * SIZE + column) * 4);
    }
  }
  return png(pixels);
}
