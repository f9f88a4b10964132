import assert from "node:assert/strict";
import { test } from "node:test";
import { loadWords } from "../language/words.ts";
import { luminanceFromBrightnessCdM2 } from "../photometry.ts";
import { COLOUR_MAPS, colourTable } from "./colour-maps.ts";
import type { CompactPanorama, FourValues } from "./compact.ts";
import { SkyGrid } from "./grid.ts";
import { paintSky } from "./paint.ts";
import { compassName, equirectangular, fisheye, perspective } from "./projection.ts";
import { cameraGrey, filmed, referenceCdM2, seenByCamera } from "./realistic.ts";
import { scalePosition } from "./scale.ts";
import { PHOTOPIC, seenFrom } from "./seen.ts";
import { DARK_GROUND_RGB, GROUND_RGB, type PictureLook, shadingOf } from "./shading.ts";
import { encodeSrgb } from "./srgb.ts";
import { ticks, UNITS, unitBeside, unitFor } from "./units.ts";

await loadWords("place");

const PLOT = { leftPx: 10, topPx: 20, widthPx: 400, heightPx: 200 };
const STEP_DEG = 90 / 64;
const LOOK: PictureLook = { sky: "artificial", colours: "inferno", exposureEv: 0, adaptationCdM2: null };

const DARK = 567e-9;
const BRIGHT = 567e-5;
/** A natural sky, cd m⁻². */
const NATURAL_CD_M2 = 1.8e-4;
const EYE_PARTS = { cie_x: 1.1, photopic: 1, cie_z: 0.4, scotopic: 1.3 };

/** A sky of one luminance but for one bright sample. */
function skyWithLightAt(row: number, column: number): CompactPanorama {
  const values = new Float32Array(64 * 256).fill(DARK);
  values[row * 256 + column] = BRIGHT;
  return {
    grid: {
      azimuth_count: 256,
      elevation_count: 64,
      azimuth_first_deg: 0,
      azimuth_step_deg: 360 / 256,
      elevation_first_deg: STEP_DEG / 2,
      elevation_step_deg: STEP_DEG,
    },
    clouds: "none",
    response: { name: "photopic", unit: "cd m-2" },
    horizon_deg: new Array<number>(256).fill(0),
    planes: Object.entries(EYE_PARTS).map(([response, part]) => ({
      response,
      unit: "cd m-2",
      light: "artificial",
      natural: part * NATURAL_CD_M2,
      values: values.map((value) => part * value),
    })),
    points: [],
    discs: [],
  };
}

/** The nearest sample is the API's own value, with north at both ends. */
test("the nearest sample is the API's own value", () => {
  const grid = new SkyGrid(skyWithLightAt(0, 0));
  for (const azimuthDeg of [0, 0.6, 359.5, 360]) {
    const sample = grid.nearest(azimuthDeg, 0);
    assert.equal(sample.azimuthDeg, 0);
    assert.equal(sample.elevationDeg, STEP_DEG / 2);
    assert.equal(sample.artificial, Math.fround(BRIGHT));
    assert.equal(sample.total, Math.fround(BRIGHT) + NATURAL_CD_M2);
  }
  assert.ok(grid.nearest(1.5, 0).artificial < 1e-6);
});

/** Nothing of the natural sky is added under clouds. */
test("no natural sky is added under clouds", () => {
  const grid = new SkyGrid({ ...skyWithLightAt(0, 0), clouds: "1500" });
  const sample = grid.nearest(0, 0);
  assert.equal(sample.total, sample.artificial);
  assert.deepEqual(grid.eyeAt("total", 7), grid.eyeAt("artificial", 7));
});

/** The natural sky of a time is in the planes of all light, and nothing is added to it. */
test("all light at a time is that of its planes", () => {
  const sky = skyWithLightAt(0, 0);
  const total = sky.planes.map((plane) => ({ ...plane, light: "total" as const, values: plane.values.map((value) => value + 2) }));
  const sample = new SkyGrid({ ...sky, planes: [...sky.planes, ...total] }).nearest(0, 0);
  assert.deepEqual([sample.artificial, sample.total], [BRIGHT, BRIGHT + 2].map(Math.fround));
});

for (const [name, make] of [
  ["equirectangular", equirectangular],
  ["fisheye", fisheye],
] as const) {
  test(`${name}: a direction's point leads back to it`, () => {
    const projection = make(PLOT);
    for (const azimuthDeg of [0.5, 45, 90, 181, 300]) {
      for (const elevationDeg of [1, 30, 89]) {
        const { xPx, yPx } = projection.pointFromDirection({ azimuthDeg, elevationDeg });
        const back = projection.directionFromPoint(xPx, yPx);
        assert.ok(back !== null);
        assert.ok(Math.abs(back.azimuthDeg - azimuthDeg) < 1e-9);
        assert.ok(Math.abs(back.elevationDeg - elevationDeg) < 1e-9);
      }
    }
  });
}

/** The fisheye has north up, east left and the zenith in the middle. */
test("the fisheye has north up and east left", () => {
  const projection = fisheye(PLOT);
  const point = (azimuthDeg: number, elevationDeg: number) => projection.pointFromDirection({ azimuthDeg, elevationDeg });
  const zenith = point(0, 90);
  assert.deepEqual(zenith, { xPx: 210, yPx: 120 });
  assert.ok(point(0, 0).yPx < zenith.yPx - 99);
  assert.ok(point(90, 0).xPx < zenith.xPx - 99);
  assert.equal(projection.directionFromPoint(11, 21), null);
});

/** A light is painted where its direction lies, in both projections. */
test("a light is painted where its direction lies", () => {
  const grid = new SkyGrid(skyWithLightAt(20, 64));
  const direction = { azimuthDeg: 90, elevationDeg: 20.5 * STEP_DEG };
  for (const projection of [equirectangular(PLOT), fisheye(PLOT)]) {
    const picture = { width: 420, height: 240, data: new Uint8ClampedArray(420 * 240 * 4) } as ImageData;
    paintSky(picture, grid, LOOK, projection, 1);
    let brightest = { sum: -1, x: 0, y: 0 };
    for (let i = 0; i < 420 * 240; i++) {
      const sum = picture.data[i * 4]! + picture.data[i * 4 + 1]! + picture.data[i * 4 + 2]!;
      if (sum > brightest.sum) brightest = { sum, x: i % 420, y: Math.floor(i / 420) };
    }
    const { xPx, yPx } = projection.pointFromDirection(direction);
    assert.ok(Math.abs(brightest.x + 0.5 - xPx) <= 1.5, `${projection.name}: ${brightest.x} for ${xPx}`);
    assert.ok(Math.abs(brightest.y + 0.5 - yPx) <= 1.5, `${projection.name}: ${brightest.y} for ${yPx}`);
    assert.equal(picture.data[3], 0, "outside the sky nothing is painted");
  }
});

/** The scale runs from 25 to 15 magnitudes and is clamped. */
test("the scale runs from 25 to 15 magnitudes", () => {
  const position = (mag: number) => scalePosition("cd/m²", luminanceFromBrightnessCdM2(mag));
  for (const [mag, at] of [
    [25, 0],
    [20, 0.5],
    [15, 1],
    [30, 0],
  ] as const)
    assert.ok(Math.abs(position(mag) - at) < 1e-12, `${mag}`);
  assert.equal(scalePosition("nW/cm²/sr", 1e-3), 0);
  assert.equal(scalePosition("nW/cm²/sr", 10), 1);
});

/** Every colour map gets lighter all the way, so that its order is seen without colour. */
test("every colour map gets lighter all the way", () => {
  for (const name of COLOUR_MAPS) {
    const table = colourTable(name, 256);
    const lightness = (i: number) =>
      0.2126 * (table[i * 3]! / 255) ** 2.2 + 0.7152 * (table[i * 3 + 1]! / 255) ** 2.2 + 0.0722 * (table[i * 3 + 2]! / 255) ** 2.2;
    for (let i = 8; i < 256; i += 8) assert.ok(lightness(i) > lightness(i - 8), `${name} at ${i}`);
  }
});

test("compass names wrap around", () => {
  assert.deepEqual([0, 44, 90, 225, 359, -1].map(compassName), ["N", "NE", "E", "SW", "N", "N"]);
});

/** A hill of 20° around the east. */
function skyWithHill(): CompactPanorama {
  const horizonDeg = Array.from({ length: 256 }, (_, column) => Math.max(20 - Math.abs(column - 64), 0));
  return { ...skyWithLightAt(40, 200), horizon_deg: horizonDeg };
}

/** Below the horizon there is no light, the natural sky included. */
test("below the horizon there is no light", () => {
  const grid = new SkyGrid(skyWithHill());
  const hidden = grid.nearest(90, 10);
  assert.equal(hidden.isBelowHorizon, true);
  assert.deepEqual([hidden.artificial, hidden.total], [0, 0]);
  assert.equal(grid.nearest(90, 30).isBelowHorizon, false);
  assert.equal(grid.nearest(270, 0).isBelowHorizon, false);
  assert.equal(new SkyGrid(skyWithLightAt(0, 0)).nearest(90, 0).isBelowHorizon, false);
});

/** The horizon is linear between columns, and wraps. */
test("the horizon is linear between columns", () => {
  const grid = new SkyGrid({
    ...skyWithLightAt(0, 0),
    horizon_deg: Array.from({ length: 256 }, (_, column) => (column === 0 ? 8 : 0)),
  });
  assert.equal(grid.horizonAt(0), 8);
  assert.equal(grid.horizonAt(360), 8);
  assert.ok(Math.abs(grid.horizonAt(359.296875) - 4) < 1e-9);
});

/** Ground is painted up to the profile, and the sky above it keeps its colour. */
test("ground is painted up to the profile", () => {
  const grid = new SkyGrid(skyWithHill());
  for (const projection of [equirectangular(PLOT), fisheye(PLOT)]) {
    const picture = { width: 420, height: 240, data: new Uint8ClampedArray(420 * 240 * 4) } as ImageData;
    paintSky(picture, grid, LOOK, projection, 1);
    const colourAt = (azimuthDeg: number, elevationDeg: number) => {
      const { xPx, yPx } = projection.pointFromDirection({ azimuthDeg, elevationDeg });
      return [...picture.data.slice((Math.floor(yPx) * 420 + Math.floor(xPx)) * 4).slice(0, 3)];
    };
    assert.deepEqual(colourAt(90, 18), [...GROUND_RGB], projection.name);
    assert.deepEqual(colourAt(90, 21.5), colourAt(90, 40), projection.name);
    assert.notDeepEqual(colourAt(270, 5), [...GROUND_RGB], projection.name);
    paintSky(picture, grid, { ...LOOK, colours: "eye" }, projection, 1);
    assert.deepEqual(colourAt(90, 18), [...DARK_GROUND_RGB], projection.name);
  }
});

/** Perspective: a direction's point leads back to it, straight lines stay straight, and nothing lies behind. */
test("perspective: points lead back to directions", () => {
  const gaze = { azimuthDeg: 350, elevationDeg: 20, fieldDeg: 60 };
  const projection = perspective(PLOT, gaze);
  const middle = projection.pointFromDirection(gaze);
  assert.ok(Math.abs(middle.xPx - 210) < 1e-9 && Math.abs(middle.yPx - 120) < 1e-9);
  for (const [azimuthDeg, elevationDeg] of [
    [350, 20],
    [10, 5],
    [320, 40],
    [355, -5],
  ] as const) {
    const { xPx, yPx } = projection.pointFromDirection({ azimuthDeg, elevationDeg });
    const back = projection.directionFromPoint(xPx, yPx);
    assert.ok(
      back !== null && Math.abs(back.azimuthDeg - azimuthDeg) < 1e-9 && Math.abs(back.elevationDeg - elevationDeg) < 1e-9,
      JSON.stringify(back),
    );
  }
  // Half the field above the middle is the upper edge.
  assert.ok(Math.abs(projection.pointFromDirection({ azimuthDeg: 350, elevationDeg: 50 }).yPx - PLOT.topPx) < 1e-9);
  // The horizon is a straight level line, and east lies right of north.
  const horizon = [330, 350, 10].map((azimuthDeg) => projection.pointFromDirection({ azimuthDeg, elevationDeg: 0 }));
  for (const point of horizon) assert.ok(Math.abs(point.yPx - (horizon[0]?.yPx ?? 0)) < 1e-9);
  assert.ok((horizon[2]?.xPx ?? 0) > (horizon[0]?.xPx ?? 0));
  assert.ok(Number.isNaN(projection.pointFromDirection({ azimuthDeg: 170, elevationDeg: 0 }).xPx));
  assert.equal(projection.directionFromPoint(5, 120), null);
});

test("the brightest direction is found", () => {
  const { azimuthDeg, elevationDeg } = new SkyGrid(skyWithLightAt(3, 100)).brightest();
  assert.ok(Math.abs(azimuthDeg - (100 * 360) / 256) < 1e-9 && Math.abs(elevationDeg - 3.5 * STEP_DEG) < 1e-9);
});

const camera = (seen: FourValues, exposureEv: number) =>
  filmed(seenByCamera(seen, referenceCdM2(exposureEv))).map((channel) => Math.round(255 * encodeSrgb(channel)));

/** The realistic picture shows a millicandela as middle grey, sodium orange, and bright light white. */
test("a millicandela is middle grey, sodium orange", () => {
  const white = (luminance: number): FourValues => [
    (0.372 / 0.3713) * luminance,
    luminance,
    (0.2567 / 0.3713) * luminance,
    1.6 * luminance,
  ];
  assert.equal(cameraGrey(1e-3, 0), 118);
  assert.equal(cameraGrey(0.5e-3, 1), 118);
  assert.deepEqual(camera([0, 0, 0, 0], 0), [0, 0, 0]);
  assert.deepEqual(camera(white(1.1), 0), [255, 255, 255]);
  assert.ok(camera(white(1e-3), 0).every((byte) => Math.abs(byte - 118) <= 1));
  const sodium = (luminance: number): FourValues => [1.21 * luminance, luminance, 0.13 * luminance, 0.6 * luminance];
  const [red = 0, green = 0, blue = 0] = camera(sodium(1e-3), 0);
  assert.ok(red > green + 20 && green > blue + 40, `${red} ${green} ${blue}`);
  assert.deepEqual(camera(sodium(0.5e-3), 1), [red, green, blue], "a stop more is half the light");
});

/** Every sample of the shading is what the eye or the camera sees of it; above them lies the highest row across the zenith. */
test("the shading is continuous over the zenith", () => {
  const grid = new SkyGrid(skyWithLightAt(63, 10));
  for (const colours of ["eye", "realistic", "inferno"] as const) {
    const { texels } = shadingOf(grid, { sky: "total", colours, exposureEv: 0, adaptationCdM2: null });
    assert.equal(texels.length, 65 * 256 * 4);
    const red = (row: number, column: number) => texels[4 * (row * 256 + column)];
    assert.equal(red(64, 10 + 128), red(63, 10), colours);
    assert.ok((red(64, 138) ?? 0) > (red(64, 10) ?? 0), colours);
  }
});

/** The scale's marks are round in every unit, ascend, and lie on the scale. */
test("the scale's ticks are round in every unit", () => {
  for (const unit of UNITS) {
    const luminances = ticks(unit).map(({ value }) => value);
    assert.ok(luminances.length >= 10 && luminances.length <= 14, `${unit} ${luminances.length}`);
    assert.ok(luminances.every((mark, i) => i === 0 || mark > (luminances[i - 1] ?? 0)));
    const positions = luminances.map((mark) => scalePosition("cd/m²", mark));
    assert.ok(
      positions.every((at, i) => at >= 0 && at <= 1 && (i === 0 || at > (positions[i - 1] ?? 0))),
      `${unit} ${positions}`,
    );
  }
  assert.ok(ticks("ratio").some(({ value }) => Math.abs(value / (PHOTOPIC.natural ?? 0) - 1) < 1e-9));
});

/** A response has its own natural sky, and its units are those that it has. */
test("a response has its own natural sky and units", () => {
  const seen = (name: string, unit: string, natural: number) => seenFrom({ name, unit }, natural);
  const dark = seen("scotopic", "cd m-2", 0.25);
  assert.deepEqual(dark, { response: "scotopic", unit: "cd/m²", natural: 0.25, hasMagnitude: false });
  assert.deepEqual(
    UNITS.map((unit) => [unitFor(unit, dark), unitBeside(unitFor(unit, dark), dark)]),
    [
      ["luminance", "ratio"],
      ["luminance", "ratio"],
      ["ratio", "luminance"],
    ],
  );
  assert.ok(ticks("ratio", dark).every(({ value }) => Number.isFinite(value)));
  const meter = seen("sqm", "cd m-2", 0.5);
  assert.deepEqual([unitFor("magnitude", meter), unitBeside("ratio", meter)], ["magnitude", "magnitude"]);
  // Through clouds nothing of the natural sky is seen.
  const satellite = seen("dnb", "nW cm-2 sr-1", 0);
  assert.deepEqual(
    [satellite.unit, unitFor("ratio", satellite), unitBeside("luminance", satellite)],
    ["nW/cm²/sr", "luminance", null],
  );
  assert.ok(ticks("luminance", satellite).length > 8);
  const grid = new SkyGrid({ ...skyWithLightAt(0, 0), response: { name: "scotopic", unit: "cd m-2" } });
  assert.ok(Math.abs(grid.nearest(0, 0).total / (EYE_PARTS.scotopic * (BRIGHT + NATURAL_CD_M2)) - 1) < 1e-6);
});
