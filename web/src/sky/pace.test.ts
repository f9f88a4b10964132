import assert from "node:assert/strict";
import { test } from "node:test";
import { Pace } from "./pace.ts";

const CSS_PIXELS = 1048 * 640;

/** The scales of so many frames, each as long as `frameMs` says of its scale. */
function run(
  pace: Pace,
  frames: number,
  pixelsPerCssPx: number,
  frameMs: (scale: number) => number,
  cssPixels = CSS_PIXELS,
): number[] {
  let nowMs = 0;
  return Array.from({ length: frames }, () => {
    const scale = pace.scale(pixelsPerCssPx, cssPixels);
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
  assert.equal(pace.scale(1, CSS_PIXELS), 1);
});

/** A page of 4K without a card: it begins coarser, and frames of more than a second make it coarser still. */
test("a very slow machine draws coarser too", () => {
  const large = 3448 * 1536;
  const scales = run(new Pace(), 12, 1, (scale) => 6000 * scale ** 2, large);
  assert.equal(scales[0], 0.5);
  assert.equal(scales.at(-1), 0.35);
  assert.equal(run(new Pace(), 200, 1, () => 16.7, large).at(-1), 1);
});
