// The towns behind the glow along the horizon, ranked by Walker's law (Walker 1977).

import type { NamedPlace } from "../api/types.ts";
import type { Place } from "../state/view-state.ts";
import { distanceAndBearing } from "../ui/nearby.ts";

export interface TownOnHorizon {
  name: string;
  azimuthDeg: number;
  distanceKm: number;
}

/** Nearer than this, a town is all around and has no direction. */
const MIN_DISTANCE_KM = 3;
/** Towns of less than this part of the brightest one's glow are not named. */
const MIN_RELATIVE_GLOW = 0.01;
const MAX_TOWNS = 9;

/** A town's glow relative to others': population times distance to the power -2.5 (Walker 1977). */
function walkerGlow(population: number, distanceKm: number): number {
  return population * distanceKm ** -2.5;
}

/** The towns whose glow is strongest, the strongest first, none within `apartDeg` of a stronger one. */
export function townsOnHorizon(place: Place, places: readonly NamedPlace[], minSeparationDeg: number): TownOnHorizon[] {
  const all = places
    .map((town) => ({ town, ...distanceAndBearing(place, town) }))
    .filter(({ town, distanceKm }) => (town.population ?? 0) > 0 && distanceKm > MIN_DISTANCE_KM)
    .map(({ town, distanceKm, bearingDeg }) => ({
      name: town.name,
      azimuthDeg: bearingDeg,
      distanceKm,
      glow: walkerGlow(town.population ?? 0, distanceKm),
    }))
    .sort((a, b) => b.glow - a.glow);
  const minGlow = (all[0]?.glow ?? 0) * MIN_RELATIVE_GLOW;
  const named: TownOnHorizon[] = [];
  for (const { glow, ...town } of all) {
    if (glow < minGlow || named.length === MAX_TOWNS) break;
    const isFree = named.every(
      ({ azimuthDeg }) => Math.abs(((azimuthDeg - town.azimuthDeg + 540) % 360) - 180) >= minSeparationDeg,
    );
    if (isFree) named.push(town);
  }
  return named;
}
