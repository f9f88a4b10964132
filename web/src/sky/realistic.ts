// The sky as a camera would show it: three bands by the CIE 1931 observer (Wyman, Sloan, Shirley 2013) to sRGB (IEC 61966-2-1)
// at a fixed exposure. The server's `realistic` is the authority.

import { LUMINOUS_EFFICACY_LM_W } from "../photometry.ts";

/** Luminance that an exposure of 0 EV shows as middle grey (18 % of display white), cd m⁻². */
const MIDDLE_GREY_LUMINANCE_CD_M2 = 1e-3;
const BAND_START_NM = [600, 500, 400] as const;
const BAND_STEPS = 100;
/** XYZ from linear sRGB primaries, D65 (IEC 61966-2-1), inverted. */
const SRGB_FROM_XYZ = [
  [3.2404542, -1.5371385, -0.4985314],
  [-0.969266, 1.8760108, 0.041556],
  [0.0556434, -0.2040259, 1.0572252],
] as const;
const LUMINANCE_WEIGHTS = [0.2126, 0.7152, 0.0722] as const;
/** Steps of the encoding's table: the darkest is less than a byte wide. */
const ENCODED_STEPS = 4096;

type Three = [number, number, number];

/** CIE 1931 colour matching functions at a wavelength (Wyman, Sloan, Shirley 2013, multi-lobe fit). */
function colourMatchingXyz(wavelengthNm: number): Three {
  const lobe = (centre: number, low: number, high: number) => {
    const t = (wavelengthNm - centre) * (wavelengthNm < centre ? low : high);
    return Math.exp(-0.5 * t * t);
  };
  return [
    0.362 * lobe(442, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323) - 0.065 * lobe(501.1, 0.049, 0.0382),
    0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322),
    1.217 * lobe(437, 0.0845, 0.0278) + 0.681 * lobe(459, 0.0385, 0.0725),
  ];
}

/** X, Y, Z [cd m⁻²] of 1 W m⁻² sr⁻¹ in a band whose light is weighted as lamps shine. */
function xyzOfBand(band: 0 | 1 | 2): Three {
  const startNm = BAND_START_NM[band];
  const xyz: Three = [0, 0, 0];
  for (let step = 0; step < BAND_STEPS; step++) {
    const wavelengthNm = startNm + step + 0.5;
    const weight = startNm < 500 ? 1 : 1 - Math.abs(wavelengthNm - 600) / 100;
    colourMatchingXyz(wavelengthNm).forEach((value, i) => {
      xyz[i as 0 | 1 | 2] += weight * value;
    });
  }
  const scale = LUMINOUS_EFFICACY_LM_W[band] / xyz[1];
  return [scale * xyz[0], scale * xyz[1], scale * xyz[2]];
}

function srgbFromXyz([x, y, z]: Three): Three {
  return SRGB_FROM_XYZ.map((row) => row[0] * x + row[1] * y + row[2] * z) as Three;
}

function encodeSrgb(linear: number): number {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
}

const BANDS = [xyzOfBand(0), xyzOfBand(1), xyzOfBand(2)] as const;
/** Linear sRGB of the natural sky's light, which has as much at every wavelength, per cd m⁻². */
const NATURAL = srgbFromXyz([1, 1, 1]);
const ENCODED = Uint8ClampedArray.from({ length: ENCODED_STEPS + 1 }, (_, i) => 255 * encodeSrgb(i / ENCODED_STEPS));

/** What the zenith's light says of the lamps within each band: factors on X, Y and Z of the bands' light. */
export type Tint = readonly [x: number, y: number, z: number];
export const NO_TINT: Tint = [1, 1, 1];

/** The tint that gives the zenith's radiance in R, G, B [W m⁻² sr⁻¹] its luminance [cd m⁻²] and chromaticity x, y. */
export function tintOf(radiance: readonly number[], luminanceCdM2: number, chromaticity: readonly number[]): Tint {
  const [x = 0, y = 0] = chromaticity;
  const wanted = [x / y, 1, (1 - x - y) / y] as const;
  const factor = (i: 0 | 1 | 2) => {
    const ofBands = BANDS.reduce((sum, band, at) => sum + band[i] * (radiance[at] ?? 0), 0);
    return (wanted[i] * luminanceCdM2) / ofBands;
  };
  const tint: Tint = [factor(0), factor(1), factor(2)];
  return tint.every((part) => Number.isFinite(part) && part > 0) ? tint : NO_TINT;
}

/** Tone mapping at one exposure. */
export class ToneMap {
  private readonly referenceLuminanceCdM2: number;
  private readonly bands: readonly [Three, Three, Three];

  constructor(exposureEv: number, tint: Tint = NO_TINT) {
    const tinted = (band: 0 | 1 | 2) => srgbFromXyz([tint[0] * BANDS[band][0], tint[1] * BANDS[band][1], tint[2] * BANDS[band][2]]);
    this.bands = [tinted(0), tinted(1), tinted(2)];
    // 1 − exp(−x) is 0.18 at x = 0.198.
    this.referenceLuminanceCdM2 = MIDDLE_GREY_LUMINANCE_CD_M2 / -Math.log(1 - 0.18) / 2 ** exposureEv;
  }

  /**
   * Writes the sRGB bytes of a radiance in R, G, B [W m⁻² sr⁻¹] and of the natural sky before it to `bytes[at..at + 3]`.
   *
   * Colours outside sRGB move towards grey of their own luminance until they fit. The film curve 1 − exp(−x) is that of the
   * brightest channel; the others keep their ratio to it and come up to it nears white.
   */
  write(bytes: Uint8ClampedArray, at: number, red: number, green: number, blue: number, naturalCdM2 = 0): void {
    const [ofRed, ofGreen, ofBlue] = this.bands;
    const channel = (i: 0 | 1 | 2) =>
      (ofRed[i] * red + ofGreen[i] * green + ofBlue[i] * blue + NATURAL[i] * naturalCdM2) / this.referenceLuminanceCdM2;
    const linear: Three = [channel(0), channel(1), channel(2)];
    const grey = LUMINANCE_WEIGHTS[0] * linear[0] + LUMINANCE_WEIGHTS[1] * linear[1] + LUMINANCE_WEIGHTS[2] * linear[2];
    const lowest = Math.min(...linear);
    const saturation = lowest < 0 && grey > lowest ? grey / (grey - lowest) : 1;
    for (let i = 0; i < 3; i++) linear[i as 0 | 1 | 2] = Math.max(grey + saturation * (linear[i as 0 | 1 | 2] - grey), 0);
    const brightest = Math.max(...linear);
    const shown = 1 - Math.exp(-brightest);
    const whiteness = shown ** 4;
    for (let i = 0; i < 3; i++) {
      const ratio = brightest === 0 ? 0 : linear[i as 0 | 1 | 2] / brightest;
      bytes[at + i] = ENCODED[Math.round(shown * (ratio + (1 - ratio) * whiteness) * ENCODED_STEPS)] ?? 255;
    }
  }

  /** The grey that a luminance is shown as, a byte. */
  grey(luminanceCdM2: number): number {
    return ENCODED[Math.round((1 - Math.exp(-luminanceCdM2 / this.referenceLuminanceCdM2)) * ENCODED_STEPS)] ?? 255;
  }
}
