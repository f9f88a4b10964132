// What sees the sky: the unit of its values, and what they are told by.

import type { PanoramaAnswer } from "../api/types.ts";
import { typeset } from "../api/units.ts";
import { NATURAL_SKY_CD_M2 } from "../photometry.ts";

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

export const PHOTOPIC: Readonly<Seen> = {
  response: "photopic",
  unit: "cd/m²",
  natural: NATURAL_SKY_CD_M2,
  hasMagnitude: true,
};

const WITH_MAGNITUDE: readonly string[] = ["johnson_b", "johnson_v", "johnson_r", "sqm"];

/** What sees a panorama. Behind clouds only the eye's natural sky is known: `natural` is then 0. */
export function seenFrom(response: PanoramaAnswer["response"], natural: number): Seen {
  if (response.name === PHOTOPIC.response) return PHOTOPIC;
  return {
    response: response.name,
    unit: typeset(response.unit),
    natural: natural > 0 ? natural : null,
    hasMagnitude: WITH_MAGNITUDE.includes(response.name),
  };
}
