// The compact panorama of the stand-in: the layout of docs/guide.md#compact.
import { COLUMNS, RESPONSES, valuesOf } from "./sky.mjs";

const STEPS_PER_E = 2048;
const BRIGHTEST_CODE = 65535;
/** What the bands R, G, B count for the colours of the eye. */
const EYE = {
  cie_x: { unit: "cd m-2", weights: [340, 470, 180], natural: RESPONSES.photopic.natural },
  photopic: RESPONSES.photopic,
  cie_z: { unit: "cd m-2", weights: [0, 40, 900], natural: RESPONSES.photopic.natural },
  scotopic: RESPONSES.scotopic,
};

/** Codes of values, and the value of code 1. */
function logarithms(values) {
  const brightest = values.reduce((most, value) => Math.max(most, value), 0);
  const code = (value) => (value > 0 ? BRIGHTEST_CODE - Math.round(STEPS_PER_E * Math.log(brightest / value)) : 0);
  return { codes: values.map(code), lowest: brightest * Math.exp((1 - BRIGHTEST_CODE) / STEPS_PER_E) };
}

/** Differences to the gradient of the neighbours, low bytes before high ones. */
function stored(codes, base) {
  const above = codes.map((code, i) => code - (base?.[i] ?? 0));
  const zigzag = above.map((value, i) => {
    const [left, low] = [i % COLUMNS > 0, i >= COLUMNS];
    const predicted = (left ? above[i - 1] : 0) + (low ? above[i - COLUMNS] : 0) - (left && low ? above[i - COLUMNS - 1] : 0);
    const difference = ((value - predicted) << 16) >> 16;
    return ((difference << 1) ^ (difference >> 15)) & 0xffff;
  });
  return [...zigzag.map((value) => value & 0xff), ...zigzag.map((value) => value >> 8)];
}

/** The file of a sky of R, G, B. */
export function compact(header, sky) {
  const responses = { ...EYE, [header.response.name]: RESPONSES[header.response.name] };
  const planes = Object.entries(responses).map(([response, { unit, weights, natural }]) => ({
    about: { response, unit, light: "artificial", natural },
    ...logarithms(valuesOf(sky, { weights }).flat()),
  }));
  const text = new TextEncoder().encode(
    JSON.stringify({
      ...header,
      steps_per_e: STEPS_PER_E,
      planes: planes.map(({ about, lowest }) => ({ ...about, lowest })),
      horizon_deg: new Array(COLUMNS).fill(0),
      points: { count: 0, lowest_lx: [0, 0, 0, 0] },
      discs: [],
    }),
  );
  const length = new Uint8Array(4);
  new DataView(length.buffer).setUint32(0, text.length, true);
  const samples = planes.flatMap(({ codes }, i) => stored(codes, i === 1 ? null : planes[1].codes));
  return Buffer.concat([Buffer.from("SKYGLOW\x01", "latin1"), length, text, Uint8Array.from(samples)]);
}
