import assert from "node:assert/strict";
import { test } from "node:test";
import type { EditAnswer } from "../api/schema.ts";
import {
  EMPTY_PAINTING,
  editFrom,
  editFromAnswer,
  isFull,
  type PaintChange,
  paintingFromScenario,
  scenarioBody,
  withEdit,
  withRedo,
  withUndo,
} from "./painting.ts";

const CHANGE: PaintChange = {
  kind: "factor",
  factor: 0.5,
  lamp: "pc_amber",
  lampFrom: null,
  emission: "full_cutoff",
  addRadianceNwCm2Sr: 20,
};
const BRUSH = {
  shape: "brush",
  points: [
    [9, 46],
    [9.1, 46.000001234],
  ],
  radiusM: 3000,
} as const;
const AREA = {
  shape: "area",
  points: [
    [9, 46],
    [9.1, 46],
    [9, 46.1],
  ],
} as const;

/** A stroke becomes the edit that its change says. */
test("a stroke becomes an edit", () => {
  const brush = {
    points: [
      [9, 46],
      [9.1, 46],
    ],
    radius_m: 3000,
  };
  assert.deepEqual(editFrom(BRUSH, CHANGE), { brush, factor: 0.5 });
  assert.deepEqual(editFrom(BRUSH, { ...CHANGE, kind: "lamp" }), { brush, lamp: { to: "pc_amber" } });
  assert.deepEqual(editFrom(BRUSH, { ...CHANGE, kind: "lamp", lampFrom: "hps" }), { brush, lamp: { to: "pc_amber", from: "hps" } });
  assert.deepEqual(editFrom(BRUSH, { ...CHANGE, kind: "emission" }), { brush, emission: "full_cutoff" });
  assert.deepEqual(editFrom(BRUSH, { ...CHANGE, kind: "add" }), { brush, add_radiance_nw_cm2_sr: 20 });
  const ring = [
    [9, 46],
    [9.1, 46],
    [9, 46.1],
    [9, 46],
  ];
  assert.deepEqual(editFrom(AREA, CHANGE), { polygon: { type: "Polygon", coordinates: [ring] }, factor: 0.5 });
});

test("the server's answer gives back what was sent", () => {
  const area = { type: "MultiPoint", coordinates: [[9, 46]] };
  const none = {
    area,
    radius_m: 3000,
    lit_pixels: 4,
    factor: null,
    add_radiance_nw_cm2_sr: null,
    lamp: null,
    lamp_from: null,
    keep: null,
    emission: null,
  };
  const brush = { points: [[9, 46]], radius_m: 3000 };
  const cases: [Partial<Record<keyof EditAnswer, unknown>>, unknown][] = [
    [{ factor: 0 }, { brush, factor: 0 }],
    [{ factor: 1 }, { brush, factor: 1 }],
    [
      { factor: 1, lamp: "led_4000k", lamp_from: "hps", keep: "luminous_flux" },
      { brush, lamp: { to: "led_4000k", from: "hps", keep: "luminous_flux" } },
    ],
    [
      { factor: 0.5, emission: [1, 0, 0] },
      { brush, factor: 0.5, emission: [1, 0, 0] },
    ],
    [
      { add_radiance_nw_cm2_sr: 5, lamp: [0.1, 0.2, 0.3] },
      { brush, add_radiance_nw_cm2_sr: 5, lamp: [0.1, 0.2, 0.3] },
    ],
  ];
  for (const [answer, sent] of cases) assert.deepEqual(editFromAnswer({ ...none, ...answer } as EditAnswer), sent);
  const polygon = {
    type: "MultiPolygon",
    coordinates: [
      [
        [
          [9, 46],
          [9.1, 46],
          [9, 46.1],
          [9, 46],
        ],
      ],
    ],
  };
  assert.deepEqual(editFromAnswer({ ...none, area: polygon, radius_m: null, factor: 2 } as EditAnswer), { polygon, factor: 2 });
});

test("strokes are undone and redone in order", () => {
  const [first, second, third] = [0, 0.5, 2].map((factor) => editFrom(BRUSH, { ...CHANGE, factor }));
  let painting = withUndo(withEdit(withEdit(EMPTY_PAINTING, first!), second!));
  assert.deepEqual(painting.done, [first]);
  assert.deepEqual(painting.undone, [second]);
  painting = withRedo(painting);
  assert.deepEqual(painting.done, [first, second]);
  // A new stroke ends what could be redone.
  painting = withEdit(withUndo(painting), third!);
  assert.deepEqual(painting.done, [first, third]);
  assert.deepEqual(painting.undone, []);
  assert.deepEqual(withRedo(painting), painting);
  assert.deepEqual(scenarioBody(painting), { edits: [first, third] });
  painting = { ...painting, base: "p-0123456789abcdef0123", title: "Half" };
  assert.deepEqual(scenarioBody(painting), { edits: [first, third], base: "p-0123456789abcdef0123", title: "Half" });
  assert.deepEqual(scenarioBody(withUndo(EMPTY_PAINTING)), { edits: [] });
});

test("painting goes on from what was painted before", () => {
  const edit = { area: { type: "MultiPoint", coordinates: [[9, 46]] }, radius_m: 100, factor: 0.2, lit_pixels: 1 };
  const painting = paintingFromScenario({ edits: [edit], base: null, title: null });
  assert.deepEqual(scenarioBody(painting), { edits: [{ brush: { points: [[9, 46]], radius_m: 100 }, factor: 0.2 }] });
  assert.ok(!isFull(painting));
  assert.ok(isFull({ ...painting, done: new Array(100).fill(painting.done[0]) }));
});
