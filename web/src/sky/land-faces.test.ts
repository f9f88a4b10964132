import assert from "node:assert/strict";
import { test } from "node:test";
import { FACE_DEG, faceGazes, facePoint, faceSidePx } from "./land-faces.ts";
import { perspective, vectorFromDirection } from "./projection.ts";

const SIDE_PX = 1024;
const PLOT = { leftPx: 0, topPx: 0, widthPx: SIDE_PX, heightPx: SIDE_PX };

/** A direction lies on a picture where the perspective of that picture has it. */
test("directions lie where the pictures have them", () => {
  const views = faceGazes().map((gaze) => perspective(PLOT, gaze));
  for (let azimuthDeg = 0.5; azimuthDeg < 360; azimuthDeg += 7) {
    for (const elevationDeg of [-30, -4, 0, 12, 34]) {
      const direction = { azimuthDeg, elevationDeg };
      const { face, across, down } = facePoint(vectorFromDirection(direction));
      assert.equal(face, Math.round(azimuthDeg / FACE_DEG) % 4, `${azimuthDeg}°`);
      const { xPx, yPx } = views[face]?.pointFromDirection(direction) ?? { xPx: NaN, yPx: NaN };
      assert.ok(
        Math.abs(across * SIDE_PX - xPx) < 1e-6 && Math.abs(down * SIDE_PX - yPx) < 1e-6,
        `${azimuthDeg}° ${elevationDeg}°`,
      );
    }
  }
});

/** Neighbours meet along the diagonals, and ground below a picture lies below its lower edge. */
test("the pictures meet and have no gaps", () => {
  for (const azimuthDeg of [45, 135, 225, 315]) {
    const [left, right] = [-1e-6, 1e-6].map((away) =>
      facePoint(vectorFromDirection({ azimuthDeg: azimuthDeg + away, elevationDeg: -10 })),
    );
    assert.ok(left !== undefined && right !== undefined);
    assert.equal((left.face + 1) % 4, right.face);
    assert.ok(left.across > 1 - 1e-6 && right.across < 1e-6 && Math.abs(left.down - right.down) < 1e-6);
  }
  assert.ok(facePoint(vectorFromDirection({ azimuthDeg: 0, elevationDeg: -60 })).down > 1);
});

test("pictures are as fine as the window", () => {
  assert.equal(faceSidePx(1440, 900), 1024);
  assert.equal(faceSidePx(780, 1688), 1024);
  assert.equal(faceSidePx(2560, 1440), 1536);
  assert.equal(faceSidePx(3840, 2160), 1536);
});
