// The sky as the eye sees it: mesopic brightness (CIE 191:2010, MES-2), the response of photoreceptors (Naka and Rushton 1966) adapted to
// the sky, though never wholly (equivalent background, Crawford 1947), and shown before a dark surround (Bartleson and Breneman 1967),
// colour that fades to blue-grey where cones see nothing (Jensen et al. 2000). The server's `eye` is the authority, and
// `shaders/light.glsl` has the same for points and discs.

import type { FourValues } from "./compact.ts";
import { encodeSrgb, SRGB_FROM_XYZ, type Three } from "./srgb.ts";

const RESPONSE_EXPONENT = 0.73;
/** Half of the brightest response is at the luminance adapted to, cd m⁻², to this power: by eye, so that a dark sky is near-black, a
 * city's a dark grey and dusk a middle tone. */
const ADAPTATION_EXPONENT = 0.8;
/** What an eye saw before acts like a background of this luminance: it is never wholly adapted to the dark, and a darker sky looks darker. */
const EQUIVALENT_BACKGROUND_CD_M2 = 0.0025;
/** No eye adapts to less. */
const DARKEST_CD_M2 = 1e-4;
/** Of contrast: 1.5 is what a picture in the dark needs, and the rest is by eye, so that the Milky Way stands out as it does outside. */
const CONTRAST_EXPONENT = 2;
/** What rods alone see, which turns white as cones see more. */
const ROD_CHROMATICITY = [0.271, 0.276] as const;
const WHITE_CHROMATICITY = [0.3127, 0.329] as const;
/** V′(555 nm). */
const SCOTOPIC_AT_555_NM = 683 / 1699;
const ITERATIONS = 60;

const [RODS, WHITE] = [ROD_CHROMATICITY, WHITE_CHROMATICITY].map(([x, y]): Three => [x / y, 1, (1 - x - y) / y]) as [Three, Three];

/** What both kinds of receptors see together: luminance, and the part of the cones, 0 to 1. */
export function mesopic(photopicCdM2: number, scotopicCdM2: number): { luminanceCdM2: number; coneShare: number } {
  let coneShare = 0.5;
  let luminanceCdM2 = 0;
  for (let i = 0; i < ITERATIONS; i++) {
    const rods = (1 - coneShare) * SCOTOPIC_AT_555_NM;
    luminanceCdM2 = (coneShare * photopicCdM2 + rods * scotopicCdM2) / (coneShare + rods);
    const next = luminanceCdM2 > 0 ? Math.min(Math.max(0.767 + 0.3334 * Math.log10(luminanceCdM2), 0), 1) : 0;
    const change = Math.abs(next - coneShare);
    coneShare = next;
    if (change < 1e-6) break;
  }
  return { luminanceCdM2, coneShare };
}

/** The part of the cones by photopic luminance and by scotopic over photopic, as the shaders look it up. */
export const CONE_TABLE = { width: 256, height: 64, fromLog10: -3.5, toLog10: 1.5, ratioLog2: 3 } as const;

/** Row by row, the lowest ratio first. */
export function coneTable(): Float32Array {
  const { width, height, fromLog10, toLog10, ratioLog2 } = CONE_TABLE;
  return Float32Array.from({ length: width * height }, (_, i) => {
    const photopic = 10 ** (fromLog10 + ((i % width) / (width - 1)) * (toLog10 - fromLog10));
    return mesopic(photopic, 2 ** (ratioLog2 * ((2 * Math.floor(i / width)) / (height - 1) - 1)) * photopic).coneShare;
  });
}

/** Less than this is darkness behind a veil, cd m⁻². */
const DARK_CD_M2 = 1e-5;

/** How much more an eye is adapted to where a veil lies over a luminance, both together: by as much as the veil brightens it. */
export function dazzle(luminanceCdM2: number, veilCdM2: number): number {
  return 1 + veilCdM2 / Math.max(luminanceCdM2 - veilCdM2, DARK_CD_M2);
}

/** What an exposure makes of half of the brightest response, to the power of the response: a factor. */
export function exposedScale(exposureEv: number): number {
  return 2 ** (-exposureEv * RESPONSE_EXPONENT);
}

/** What an eye adapted to a luminance has as half of the brightest response, to the power of its response. */
export function halfPower(exposureEv: number, adaptationCdM2: number): number {
  const background = Math.max(adaptationCdM2, DARKEST_CD_M2) + EQUIVALENT_BACKGROUND_CD_M2;
  return exposedScale(exposureEv) * background ** (ADAPTATION_EXPONENT * RESPONSE_EXPONENT);
}

/** Linear sRGB, 0 to 1, of X, Y, Z and scotopic luminance, cd m⁻². */
export function seenByEye([x, y, z, scotopic]: FourValues, half: number): Three {
  const { luminanceCdM2, coneShare } = mesopic(y, scotopic);
  const power = Math.max(luminanceCdM2, 0) ** RESPONSE_EXPONENT;
  const shown = (power / (power + half)) ** CONTRAST_EXPONENT;
  if (!(shown > 0)) return [0, 0, 0];
  const rods = RODS.map((rod, i) => coneShare * (WHITE[i] ?? 0) + (1 - coneShare) * rod) as Three;
  const cones: Three = y > 0 ? [x / y, 1, z / y] : rods;
  const light = (i: 0 | 1 | 2) => shown * (coneShare * cones[i] + (1 - coneShare) * rods[i]);
  const linear = SRGB_FROM_XYZ.map((row) => row[0] * light(0) + row[1] * light(1) + row[2] * light(2)) as Three;
  return withinDisplay(linear, shown);
}

/** A colour moved towards grey of its own luminance until every channel is 0 to 1. */
function withinDisplay(linear: Three, grey: number): Three {
  let saturation = 1;
  for (const channel of linear) {
    const room = channel > grey ? 1 - grey : grey;
    const away = Math.abs(channel - grey);
    if (away > room) saturation = Math.min(saturation, room / away);
  }
  return linear.map((channel) => Math.min(Math.max(grey + saturation * (channel - grey), 0), 1)) as Three;
}

/** The bytes of a luminance of white light of the night, for legends. */
export function eyeBytes(seen: FourValues, exposureEv: number, adaptationCdM2: number): Three {
  return seenByEye(seen, halfPower(exposureEv, adaptationCdM2)).map((channel) => Math.round(255 * encodeSrgb(channel))) as Three;
}
