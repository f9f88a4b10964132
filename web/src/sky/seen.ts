// What sees the sky: the unit of its values, and what they are told by.

import type { PanoramaAnswer } from "../api/types.ts";
import { typeset } from "../api/units.ts";
import { luminanceFromBrightnessCdM2 } from "../photometry.ts";

export interface Seen {
  /** The server's name of it. */
  response: string;
  /** Of its values, as people write it. */
  unit: string;
  /** Its value of the natural sky; null where that is not known. */
  natural: number | null;
  /** Whether its values are luminances that have magnitudes. */
  hasMagnitude: boolean;
}

/** The eye before the dark reference through clear air, to a hundredth of a magnitude, as long as no answer says what it is. */
export const PHOTOPIC: Readonly<Seen> = {
  response: "photopic",
  unit: "cd/m²",
  natural: luminanceFromBrightnessCdM2(21.8),
  hasMagnitude: true,
};

/** The eye before the dark reference of an answer. */
export function eyeBefore({ luminance_cd_m2: natural }: Pick<PanoramaAnswer["dark_reference"], "luminance_cd_m2">): Seen {
  return { ...PHOTOPIC, natural };
}

const WITH_MAGNITUDE: readonly string[] = ["johnson_b", "johnson_v", "johnson_r", "sqm"];

/** What sees a panorama, and its value of the natural sky; 0 where that is not known. */
export function seenFrom({ name, unit }: PanoramaAnswer["response"], natural: number): Seen {
  return {
    response: name,
    unit: typeset(unit),
    natural: natural > 0 ? natural : null,
    hasMagnitude: name === PHOTOPIC.response || WITH_MAGNITUDE.includes(name),
  };
}
