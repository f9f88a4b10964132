import assert from "node:assert/strict";
import { test } from "node:test";
import { deflateSync } from "node:zlib";
import { animated, chunksOf } from "./apng.ts";

const END = { type: "IEND", data: new Uint8Array() };

/** A grey PNG of a width and height, its data in two chunks; checksums are left out, for nothing here reads them. */
function png(width: number, height: number, grey: number): Uint8Array {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, 0, 0, 0, 0], 8);
  const rows = Buffer.concat(Array.from({ length: height }, () => Buffer.from([0, ...Array(width).fill(grey)])));
  const data = deflateSync(rows);
  const chunk = (type: string, bytes: Uint8Array) => {
    const length = Buffer.alloc(4);
    length.writeUInt32BE(bytes.length);
    return Buffer.concat([length, Buffer.from(type, "latin1"), bytes, Buffer.alloc(4)]);
  };
  const half = data.length >> 1;
  return Buffer.concat([
    Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]),
    chunk("IHDR", header),
    chunk("IDAT", data.subarray(0, half)),
    chunk("IDAT", data.subarray(half)),
    chunk(END.type, END.data),
  ]);
}

/** Two pictures become two frames whose data are theirs, numbered in one sequence, and every checksum is right. */
test("two pictures become two frames", () => {
  const [before, after] = [png(3, 2, 10), png(3, 2, 200)];
  const file = animated([before, after], 2000);
  assert.ok(file !== null);
  const chunks = chunksOf(file);
  assert.deepEqual(
    chunks.map(({ type }) => type),
    ["IHDR", "acTL", "fcTL", "IDAT", "IDAT", "fcTL", "fdAT", "fdAT", "IEND"],
  );
  const number = (data: Uint8Array, at = 0) => new DataView(data.buffer, data.byteOffset).getUint32(at);
  const of = (wanted: string) => chunks.filter(({ type }) => type === wanted).map(({ data }) => data);
  assert.deepEqual(
    of("acTL").map((data) => [number(data), number(data, 4)]),
    [[2, 0]],
  );
  assert.deepEqual(
    [...of("fcTL"), ...of("fdAT")].map((data) => number(data)),
    [0, 1, 2, 3],
  );
  assert.deepEqual(
    of("fcTL").map((data) => [number(data, 4), number(data, 8)]),
    [
      [3, 2],
      [3, 2],
    ],
  );
  const joined = (parts: readonly Uint8Array[]) => Buffer.concat(parts).toString("hex");
  const data = (of: Uint8Array) =>
    chunksOf(of)
      .filter(({ type }) => type === "IDAT")
      .map((chunk) => chunk.data);
  assert.equal(joined(of("IDAT")), joined(data(before)));
  assert.equal(joined(of("fdAT").map((bytes) => bytes.subarray(4))), joined(data(after)));
  // The end of every PNG: an empty chunk with a known checksum.
  assert.equal(Buffer.from(file.subarray(-12)).toString("hex"), "0000000049454e44ae426082");
});

test("pictures of two sizes are no frames", () => {
  assert.equal(animated([png(3, 2, 10), png(2, 3, 10)], 1000), null);
  assert.equal(animated([], 1000), null);
});
