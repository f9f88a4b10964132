// Which towns stand behind the glow along the horizon.

import type { NamedPlace } from "../api/types.ts";
import type { Place } from "../state.ts";
import { distanceAndBearing } from "../ui/nearby.ts";

export interface TownOnHorizon {
  name: string;
  azimuthDeg: number;
  distanceKm: number;
}

/** Nearer than this, a town is all around and has no direction. */
const NEAREST_KM = 3;
/** Towns of less than this part of the brightest one's glow are not named. */
const LEAST_PART = 0.01;
const MOST_TOWNS = 9;

/** A town's glow relative to others': population times distance to the power -2.5 (Walker 1977). */
function walkerGlow(population: number, distanceKm: number): number {
  return population * distanceKm ** -2.5;
}

/** The towns whose glow is strongest, the strongest first, none within `apartDeg` of a stronger one. */
export function townsOnHorizon(place: Place, places: readonly NamedPlace[], apartDeg: number): TownOnHorizon[] {
  const all = places
    .map((town) => ({ town, ...distanceAndBearing(place, town) }))
    .filter(({ town, distanceKm }) => (town.population ?? 0) > 0 && distanceKm > NEAREST_KM)
    .map(({ town, distanceKm, bearingDeg }) => ({
      name: town.name,
      azimuthDeg: bearingDeg,
      distanceKm,
      glow: walkerGlow(town.population ?? 0, distanceKm),
    }))
    .sort((a, b) => b.glow - a.glow);
  const least = (all[0]?.glow ?? 0) * LEAST_PART;
  const named: TownOnHorizon[] = [];
  for (const { glow, ...town } of all) {
    if (glow < least || named.length === MOST_TOWNS) break;
    const isFree = named.every(({ azimuthDeg }) => Math.abs(((azimuthDeg - town.azimuthDeg + 540) % 360) - 180) >= apartDeg);
    if (isFree) named.push(town);
  }
  return named;
}
