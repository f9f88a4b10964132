import assert from "node:assert/strict";
import { test } from "node:test";
import { Pace } from "./pace.ts";

/** The scales of so many frames, each as long as `frameMs` says of its scale. */
function run(pace: Pace, frames: number, pixelsPerCssPx: number, frameMs: (scale: number) => number): number[] {
  let nowMs = 0;
  return Array.from({ length: frames }, () => {
    const scale = pace.scale(pixelsPerCssPx);
    pace.frame(nowMs);
    nowMs += frameMs(scale);
    return scale;
  });
}

/** A machine that needs 60 ms for every pixel of one CSS pixel is asked for half of them along each side, and no more again. */
test("a slow machine draws coarser and stays there", () => {
  const scales = run(new Pace(), 300, 1, (scale) => Math.max(60 * scale ** 2, 16.7));
  assert.equal(scales[0], 1);
  assert.ok(
    scales.slice(20).every((scale) => scale === 0.5),
    `${scales}`,
  );
});

test("a fast machine draws as fine as its screen", () => {
  assert.equal(run(new Pace(), 120, 2, () => 16.7).at(-1), 2);
  assert.ok(run(new Pace(), 120, 1, () => 16.7).every((scale) => scale === 1));
});

/** Who rests between two glances is no slow machine. */
test("a pause is no slow frame", () => {
  const pace = new Pace();
  let nowMs = 0;
  for (let i = 0; i < 40; i++) {
    pace.frame(nowMs);
    nowMs += i % 2 === 0 ? 16 : 1000;
  }
  assert.equal(pace.scale(1), 1);
});
