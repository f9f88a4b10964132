// A stand-in for the engine: a plausible, quick, wrong sky from a handful of towns. For work on the viewer only.

export const TOWNS = [
  ["Nairobi", -1.286, 36.817, 4_400_000],
  ["Mombasa", -4.043, 39.668, 1_208_000],
  ["Nakuru", -0.303, 36.08, 570_000],
  ["Kisumu", -0.092, 34.768, 610_000],
  ["Eldoret", 0.514, 35.27, 475_000],
  ["Thika", -1.033, 37.069, 279_000],
  ["Nyeri", -0.42, 36.948, 125_000],
  ["Meru", 0.047, 37.649, 240_000],
  ["Garissa", -0.453, 39.646, 163_000],
  ["Kitale", 1.016, 35.006, 162_000],
  ["Voi", -3.396, 38.556, 53_000],
  ["Naivasha", -0.717, 36.431, 198_000],
].map(([name, latitudeDeg, longitudeDeg, population]) => ({
  name,
  latitude_deg: latitudeDeg,
  longitude_deg: longitudeDeg,
  population,
}));

const RAD = Math.PI / 180;
export const COLUMNS = 256;
export const ROWS = 64;
const EFFICACY = [150, 567, 45];
export const NATURAL = 1.08e5 * 10 ** (-0.4 * 22);
/** Of the server's lamps a few, each with its flux in R, G, B per DNB watt. */
export const LAMPS = {
  mixed: [0.408, 0.642, 0.186],
  hps: [0.366, 0.559, 0.068],
  lps: [0, 1.241, 0],
  pc_amber: [0.585, 0.554, 0.009],
  led_3000k: [0.554, 0.576, 0.133],
  led_4000k: [0.449, 0.725, 0.303],
  metal_halide: [0.264, 0.755, 0.365],
  mercury: [0.218, 0.818, 0.301],
};
/** What the bands R, G, B count for a response in its unit, what it sees of the natural sky, and whether that has a magnitude. */
export const RESPONSES = {
  photopic: { unit: "cd m-2", weights: EFFICACY, natural: NATURAL, hasMagnitude: true },
  scotopic: { unit: "cd m-2", weights: [15, 560, 850], natural: 2.26 * NATURAL, hasMagnitude: false },
  johnson_b: { unit: "cd m-2", weights: [0, 60, 420], natural: 0.55 * NATURAL, hasMagnitude: true },
  johnson_v: { unit: "cd m-2", weights: [120, 560, 50], natural: 0.96 * NATURAL, hasMagnitude: true },
  johnson_r: { unit: "cd m-2", weights: [520, 240, 0], natural: 1.6 * NATURAL, hasMagnitude: true },
  sqm: { unit: "cd m-2", weights: [110, 420, 220], natural: NATURAL, hasMagnitude: true },
  melanopic: { unit: "cd m-2", weights: [0, 200, 560], natural: 0.9 * NATURAL, hasMagnitude: false },
  dnb: { unit: "nW cm-2 sr-1", weights: [1e5, 0.8e5, 0], natural: 450 * NATURAL, hasMagnitude: false },
};

const magnitude = (luminance) => (luminance > 0 ? -2.5 * Math.log10(luminance / 1.08e5) : null);

function way(from, to) {
  const [a, b] = [from.latitude_deg * RAD, to.latitude_deg * RAD];
  const east = (to.longitude_deg - from.longitude_deg) * RAD;
  const half = Math.sin((b - a) / 2) ** 2 + Math.cos(a) * Math.cos(b) * Math.sin(east / 2) ** 2;
  const bearing = Math.atan2(Math.sin(east) * Math.cos(b), Math.cos(a) * Math.sin(b) - Math.sin(a) * Math.cos(b) * Math.cos(east));
  return { km: 2 * 6371 * Math.asin(Math.sqrt(half)), bearing };
}

/** radiance[band][row][column], W m⁻² sr⁻¹. */
export function radiance(place, turbidity, lamp) {
  const sky = [0, 1, 2].map(() => Array.from({ length: ROWS }, () => new Array(COLUMNS).fill(0)));
  for (const town of TOWNS) {
    const { km, bearing } = way(place, town);
    if (km > 300) continue;
    const zenith = (1.2e-7 * (town.population / 1e6)) / (1 + (km / 6) ** 2.4);
    for (let row = 0; row < ROWS; row++) {
      const elevation = (row + 0.5) * (90 / ROWS) * RAD;
      for (let column = 0; column < COLUMNS; column++) {
        const angle = Math.acos(
          Math.min(1, Math.max(-1, Math.cos(elevation) * Math.cos((column / COLUMNS) * 2 * Math.PI - bearing))),
        );
        const glow = zenith * (0.35 + (12 * turbidity * Math.exp(-angle / 0.5)) / 2.5) * Math.min(1 / Math.sin(elevation), 9);
        for (let band = 0; band < 3; band++) sky[band][row][column] += glow * lamp[band] * [0.8, 1, 1.2][band];
      }
    }
  }
  // Single precision, as the server's grid.
  return sky.map((rows) => rows.map((row) => [...Float32Array.from(row)]));
}

/** What a response sees, [row][column]. */
export function valuesOf(sky, { weights }) {
  const value = (row, column) => weights.reduce((sum, weight, band) => sum + weight * sky[band][row][column], 0);
  return Array.from({ length: ROWS }, (_, row) => Array.from({ length: COLUMNS }, (_, column) => Math.fround(value(row, column))));
}

/** What the responses see of a radiance in R, G, B at the zenith. */
function zenithByResponse(radiance) {
  return Object.entries(RESPONSES).map(([response, { unit, weights, natural, hasMagnitude }]) => {
    const value = weights.reduce((sum, weight, band) => sum + weight * radiance[band], 0);
    const mag = (light) => (hasMagnitude ? magnitude(light) : null);
    const total = value + natural;
    return { response, unit, value, total, brightness_mag_arcsec2: mag(value), total_brightness_mag_arcsec2: mag(total) };
  });
}

export function quantities(sky) {
  const luminance = (row, column) => EFFICACY.reduce((sum, k, band) => sum + k * sky[band][row][column], 0);
  const step = 90 / ROWS;
  const sums = { zenith: [0, 0], sqm: [0, 0], mean: [0, 0] };
  let horizontal = 0;
  let brightest = [0, 0, 0];
  for (let row = 0; row < ROWS; row++) {
    const solid = ((2 * Math.PI) / COLUMNS) * (Math.sin((row + 1) * step * RAD) - Math.sin(row * step * RAD));
    const off = 90 - (row + 0.5) * step;
    for (let column = 0; column < COLUMNS; column++) {
      const value = luminance(row, column);
      for (const [name, weight] of [
        ["zenith", off <= 5 ? 1 : 0],
        ["sqm", Math.exp(-0.5 * (off / 8.49) ** 2)],
        ["mean", 1],
      ]) {
        sums[name][0] += weight * solid * value;
        sums[name][1] += weight * solid;
      }
      horizontal += value * solid * Math.cos(off * RAD);
      if (value > brightest[0]) brightest = [value, row, column];
    }
  }
  const [zenith, sqm, mean] = [sums.zenith, sums.sqm, sums.mean].map(([value, weight]) => value / weight);
  const totalMag = magnitude(zenith + NATURAL);
  const zenithRadiance = sky.map((band) => band[ROWS - 1].reduce((sum, value) => sum + value, 0) / COLUMNS);
  const byResponse = zenithByResponse(zenithRadiance);
  const scotopic = byResponse.find(({ response }) => response === "scotopic").value;
  const ends = [21.99, 21.89, 21.69, 20.49, 19.5, 18.94, 18.38];
  const place = ends.findIndex((end) => totalMag > end);
  return {
    zenith_luminance_cd_m2: zenith,
    zenith_brightness_mag_arcsec2: magnitude(zenith),
    zenith_total_luminance_cd_m2: zenith + NATURAL,
    zenith_total_brightness_mag_arcsec2: totalMag,
    ratio_to_natural: zenith / NATURAL,
    sqm_luminance_cd_m2: sqm,
    sqm_total_brightness_mag_arcsec2: magnitude(sqm + NATURAL),
    mean_luminance_cd_m2: mean,
    horizontal_illuminance_lx: horizontal,
    horizontal_total_illuminance_lx: horizontal + Math.PI * NATURAL,
    brightest_luminance_cd_m2: brightest[0],
    brightest_azimuth_deg: (brightest[2] * 360) / COLUMNS,
    brightest_elevation_deg: (brightest[1] + 0.5) * step,
    bortle_class: place >= 0 ? place + 1 : totalMag >= 17.8 ? 8 : 9,
    naked_eye_limit_mag: Math.max(2, 6.27 - 0.33 * Math.max(0, 22 - totalMag)),
    zenith_radiance_w_m2_sr: zenithRadiance,
    zenith_by_response: byResponse,
    zenith_scotopic_luminance_cd_m2: scotopic,
    zenith_scotopic_photopic_ratio: zenith > 0 ? scotopic / zenith : null,
    zenith_colour_temperature_k: zenith > 0 ? 3000 : null,
    zenith_chromaticity: zenith > 0 ? [0.44, 0.4] : null,
  };
}
