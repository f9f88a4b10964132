import assert from "node:assert/strict";
import { test } from "node:test";
import type { PanoramaAnswer } from "../api/types.ts";
import { luminance_from_brightness_cd_m2, NATURAL_SKY_CD_M2 } from "../photometry.ts";
import { COLOUR_MAPS, colour_table } from "./colour_maps.ts";
import { SkyGrid } from "./grid.ts";
import { GROUND_RGB, paint_sky, type PictureLook } from "./paint.ts";
import { compass_name, equirectangular, fisheye, perspective } from "./projection.ts";
import { ToneMap } from "./realistic.ts";
import { SCALE, scale_position } from "./scale.ts";
import { marks, UNITS } from "./units.ts";

const PLOT = { left_px: 10, top_px: 20, width_px: 400, height_px: 200 };
const STEP_DEG = 90 / 64;
const LOOK: PictureLook = { sky: "artificial", colours: "inferno", exposure_ev: 0 };

/** A sky whose green radiance is 1e-9 at every sample but for one bright one. */
function answer_with_light_at(row: number, column: number): PanoramaAnswer {
  const band = (value: number) => Array.from({ length: 64 }, () => new Array<number>(256).fill(value));
  const green = band(1e-9);
  green[row]![column] = 1e-5;
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
    radiance: [band(0), green, band(0)],
  } as PanoramaAnswer;
}

test("the nearest sample is the API's own value, with north at both ends", () => {
  const grid = new SkyGrid(answer_with_light_at(0, 0));
  for (const azimuth_deg of [0, 0.6, 359.5, 360]) {
    const sample = grid.nearest(azimuth_deg, 0);
    assert.equal(sample.azimuth_deg, 0);
    assert.equal(sample.elevation_deg, STEP_DEG / 2);
    assert.ok(Math.abs(sample.artificial_cd_m2 - 567e-5) < 1e-15);
    assert.ok(Math.abs(sample.total_cd_m2 - 567e-5 - NATURAL_SKY_CD_M2) < 1e-15);
  }
  assert.ok(grid.nearest(1.5, 0).artificial_cd_m2 < 1e-6);
});

test("nothing of the natural sky is added under clouds", () => {
  const grid = new SkyGrid({ ...answer_with_light_at(0, 0), clouds: "1500" });
  const sample = grid.nearest(0, 0);
  assert.equal(sample.total_cd_m2, sample.artificial_cd_m2);
  assert.deepEqual(grid.log_luminance("total", 1e-9), grid.log_luminance("artificial", 1e-9));
});

test("a panorama with missing rows is refused", () => {
  const answer = answer_with_light_at(0, 0);
  answer.radiance[1]!.pop();
  assert.throws(() => new SkyGrid(answer), /rows/);
});

for (const [name, make] of [["equirectangular", equirectangular], ["fisheye", fisheye]] as const) {
  test(`${name}: a direction's point leads back to it`, () => {
    const projection = make(PLOT);
    for (const azimuth_deg of [0.5, 45, 90, 181, 300]) {
      for (const elevation_deg of [1, 30, 89]) {
        const { x_px, y_px } = projection.point_from_direction({ azimuth_deg, elevation_deg });
        const back = projection.direction_from_point(x_px, y_px);
        assert.ok(back !== null);
        assert.ok(Math.abs(back.azimuth_deg - azimuth_deg) < 1e-9);
        assert.ok(Math.abs(back.elevation_deg - elevation_deg) < 1e-9);
      }
    }
  });
}

test("the fisheye has north up, east left and the zenith in the middle", () => {
  const projection = fisheye(PLOT);
  const point = (azimuth_deg: number, elevation_deg: number) => projection.point_from_direction({ azimuth_deg, elevation_deg });
  const zenith = point(0, 90);
  assert.deepEqual(zenith, { x_px: 210, y_px: 120 });
  assert.ok(point(0, 0).y_px < zenith.y_px - 99);
  assert.ok(point(90, 0).x_px < zenith.x_px - 99);
  assert.equal(projection.direction_from_point(11, 21), null);
});

test("a light is painted where its direction lies, in both projections", () => {
  const grid = new SkyGrid(answer_with_light_at(20, 64));
  const direction = { azimuth_deg: 90, elevation_deg: 20.5 * STEP_DEG };
  for (const projection of [equirectangular(PLOT), fisheye(PLOT)]) {
    const picture = { width: 420, height: 240, data: new Uint8ClampedArray(420 * 240 * 4) } as ImageData;
    paint_sky(picture, grid, LOOK, projection, 1);
    let brightest = { sum: -1, x: 0, y: 0 };
    for (let i = 0; i < 420 * 240; i++) {
      const sum = picture.data[i * 4]! + picture.data[i * 4 + 1]! + picture.data[i * 4 + 2]!;
      if (sum > brightest.sum) brightest = { sum, x: i % 420, y: Math.floor(i / 420) };
    }
    const { x_px, y_px } = projection.point_from_direction(direction);
    assert.ok(Math.abs(brightest.x + 0.5 - x_px) <= 1.5, `${projection.name}: ${brightest.x} for ${x_px}`);
    assert.ok(Math.abs(brightest.y + 0.5 - y_px) <= 1.5, `${projection.name}: ${brightest.y} for ${y_px}`);
    assert.equal(picture.data[3], 0, "outside the sky nothing is painted");
  }
});

test("the scale runs from 25 to 15 magnitudes and is clamped", () => {
  assert.equal(scale_position(SCALE, 25), 0);
  assert.equal(scale_position(SCALE, 20), 0.5);
  assert.equal(scale_position(SCALE, 15), 1);
  assert.equal(scale_position(SCALE, 30), 0);
  assert.ok(luminance_from_brightness_cd_m2(15) > luminance_from_brightness_cd_m2(25));
});

test("every colour map gets lighter all the way, so that its order is seen without colour", () => {
  for (const name of COLOUR_MAPS) {
    const table = colour_table(name, 256);
    const lightness = (i: number) => 0.2126 * (table[i * 3]! / 255) ** 2.2 + 0.7152 * (table[i * 3 + 1]! / 255) ** 2.2 + 0.0722 * (table[i * 3 + 2]! / 255) ** 2.2;
    for (let i = 8; i < 256; i += 8) assert.ok(lightness(i) > lightness(i - 8), `${name} at ${i}`);
  }
});

test("compass names wrap around", () => {
  assert.deepEqual([0, 44, 90, 225, 359, -1].map(compass_name), ["N", "NE", "E", "SW", "N", "N"]);
});

/** A hill of 20° around the east; its samples are dark as the API has them. */
function answer_with_hill(): PanoramaAnswer {
  const answer = answer_with_light_at(40, 200);
  const horizon_deg = Array.from({ length: 256 }, (_, column) => Math.max(20 - Math.abs(column - 64), 0));
  for (const band of answer.radiance) {
    band.forEach((values, row) => values.forEach((_, column) => {
      if ((row + 0.5) * STEP_DEG < horizon_deg[column]!) values[column] = 0;
    }));
  }
  return { ...answer, horizon_deg };
}

test("below the horizon there is no light, the natural sky included", () => {
  const grid = new SkyGrid(answer_with_hill());
  const hidden = grid.nearest(90, 10);
  assert.equal(hidden.is_below_horizon, true);
  assert.deepEqual([hidden.artificial_cd_m2, hidden.total_cd_m2], [0, 0]);
  assert.equal(grid.nearest(90, 30).is_below_horizon, false);
  assert.equal(grid.nearest(270, 0).is_below_horizon, false);
  assert.equal(new SkyGrid(answer_with_light_at(0, 0)).nearest(90, 0).is_below_horizon, false);
});

test("the horizon is linear between columns, and wraps", () => {
  const grid = new SkyGrid({ ...answer_with_light_at(0, 0), horizon_deg: Array.from({ length: 256 }, (_, column) => (column === 0 ? 8 : 0)) });
  assert.equal(grid.horizon_at(0), 8);
  assert.equal(grid.horizon_at(360), 8);
  assert.ok(Math.abs(grid.horizon_at(359.296875) - 4) < 1e-9);
});

test("ground is painted up to the profile, and the sky above it keeps its colour", () => {
  const grid = new SkyGrid(answer_with_hill());
  for (const projection of [equirectangular(PLOT), fisheye(PLOT)]) {
    const picture = { width: 420, height: 240, data: new Uint8ClampedArray(420 * 240 * 4) } as ImageData;
    paint_sky(picture, grid, LOOK, projection, 1);
    const colour_at = (azimuth_deg: number, elevation_deg: number) => {
      const { x_px, y_px } = projection.point_from_direction({ azimuth_deg, elevation_deg });
      return [...picture.data.slice((Math.floor(y_px) * 420 + Math.floor(x_px)) * 4).slice(0, 3)];
    };
    assert.deepEqual(colour_at(90, 18), [...GROUND_RGB], projection.name);
    assert.deepEqual(colour_at(90, 21.5), colour_at(90, 40), projection.name);
    assert.notDeepEqual(colour_at(270, 5), [...GROUND_RGB], projection.name);
  }
});

test("perspective: a direction's point leads back to it, straight lines stay straight, and nothing lies behind", () => {
  const gaze = { azimuth_deg: 350, elevation_deg: 20, field_deg: 60 };
  const projection = perspective(PLOT, gaze);
  const middle = projection.point_from_direction(gaze);
  assert.ok(Math.abs(middle.x_px - 210) < 1e-9 && Math.abs(middle.y_px - 120) < 1e-9);
  for (const [azimuth_deg, elevation_deg] of [[350, 20], [10, 5], [320, 40], [355, -5]] as const) {
    const { x_px, y_px } = projection.point_from_direction({ azimuth_deg, elevation_deg });
    const back = projection.direction_from_point(x_px, y_px);
    assert.ok(back !== null && Math.abs(back.azimuth_deg - azimuth_deg) < 1e-9 && Math.abs(back.elevation_deg - elevation_deg) < 1e-9, JSON.stringify(back));
  }
  // Half the field above the middle is the upper edge.
  assert.ok(Math.abs(projection.point_from_direction({ azimuth_deg: 350, elevation_deg: 50 }).y_px - PLOT.top_px) < 1e-9);
  // The horizon is a straight level line, and east lies right of north.
  const horizon = [330, 350, 10].map((azimuth_deg) => projection.point_from_direction({ azimuth_deg, elevation_deg: 0 }));
  for (const point of horizon) assert.ok(Math.abs(point.y_px - (horizon[0]?.y_px ?? 0)) < 1e-9);
  assert.ok((horizon[2]?.x_px ?? 0) > (horizon[0]?.x_px ?? 0));
  assert.ok(Number.isNaN(projection.point_from_direction({ azimuth_deg: 170, elevation_deg: 0 }).x_px));
  assert.equal(projection.direction_from_point(5, 120), null);
});

test("the brightest direction is found", () => {
  const { azimuth_deg, elevation_deg } = new SkyGrid(answer_with_light_at(3, 100)).brightest();
  assert.ok(Math.abs(azimuth_deg - (100 * 360) / 256) < 1e-9 && Math.abs(elevation_deg - 3.5 * STEP_DEG) < 1e-9);
});

test("the realistic picture shows a millicandela as middle grey, sodium orange, and bright light white", () => {
  const bytes = new Uint8ClampedArray(3);
  const shown = (exposure_ev: number, red: number, green: number, blue: number) => {
    new ToneMap(exposure_ev).write(bytes, 0, red, green, blue);
    return [...bytes] as [number, number, number];
  };
  assert.equal(new ToneMap(0).grey(1e-3), 118);
  assert.equal(new ToneMap(1).grey(0.5e-3), 118);
  assert.deepEqual(shown(0, 0, 0, 0), [0, 0, 0]);
  assert.deepEqual(shown(0, 1, 1, 1), [255, 255, 255]);
  const [red, green, blue] = shown(0, 2.5e-6, 1.1e-6, 0.1e-6);
  assert.ok(red > green + 20 && green > blue + 40, `${red} ${green} ${blue}`);
  const half = shown(1, 1.25e-6, 0.55e-6, 0.05e-6);
  assert.deepEqual(half, [red, green, blue], "a stop more is half the light");
});

test("the scale's marks are round in every unit, ascend, and lie on the scale", () => {
  for (const unit of UNITS) {
    const luminances = marks(unit).map(({ luminance_cd_m2 }) => luminance_cd_m2);
    assert.ok(luminances.length >= 10 && luminances.length <= 14, `${unit} ${luminances.length}`);
    assert.ok(luminances.every((mark, i) => i === 0 || mark > (luminances[i - 1] ?? 0)));
    const positions = luminances.map((mark) => scale_position(SCALE, -2.5 * Math.log10(mark / 1.08e5)));
    assert.ok(positions.every((at, i) => at >= 0 && at <= 1 && (i === 0 || at > (positions[i - 1] ?? 0))), `${unit} ${positions}`);
  }
  assert.ok(marks("ratio").some(({ luminance_cd_m2 }) => Math.abs(luminance_cd_m2 / NATURAL_SKY_CD_M2 - 1) < 1e-9));
});
