import assert from "node:assert/strict";
import { test } from "node:test";
import { SIZES, savedSizePx } from "./saved-size.ts";

/** A picture has the shape of what is seen; 4K is 4K, and never more than the server takes. */
test("saved pictures have their shape", () => {
  assert.deepEqual(savedSizePx("equirectangular", 1.5, "screen"), { width: 2048, height_px: 512 });
  assert.deepEqual(savedSizePx("fisheye", 1.5, "screen"), { width: 1536, height_px: 1536 });
  assert.deepEqual(savedSizePx("perspective", 16 / 9, "4k"), { width: 3840, height_px: 2160 });
  assert.deepEqual(savedSizePx("equirectangular", 1, "4k"), { width: 3840, height_px: 960 });
  assert.deepEqual(savedSizePx("fisheye", 1, "4k"), { width: 2880, height_px: 2880 });
  for (const size of SIZES)
    for (const aspect of [0.4, 0.8, 1, 2.3, 5])
      for (const projection of ["equirectangular", "fisheye", "perspective"] as const) {
        const { width, height_px } = savedSizePx(projection, aspect, size);
        assert.ok(width * height_px <= 8_388_608 && Math.max(width, height_px) <= 4096 && Math.min(width, height_px) >= 16);
        if (projection === "perspective") assert.ok(Math.abs(width / height_px / aspect - 1) < 0.01, `${size} ${aspect}`);
      }
});
