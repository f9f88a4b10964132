// Which towns stand behind the glow along the horizon.

import type { NamedPlace } from "../api/types.ts";
import { distance_and_bearing } from "../ui/nearby.ts";
import type { Place } from "../state.ts";

export interface TownOnHorizon {
  name: string;
  azimuth_deg: number;
  distance_km: number;
}

/** Nearer than this, a town is all around and has no direction. */
const NEAREST_KM = 3;
/** Towns of less than this part of the brightest one's glow are not named. */
const LEAST_PART = 0.01;
const MOST_TOWNS = 9;

/** A town's glow relative to others': population times distance to the power -2.5 (Walker 1977). */
function walker_glow(population: number, distance_km: number): number {
  return population * distance_km ** -2.5;
}

/** The towns whose glow is strongest, the strongest first, none within `apart_deg` of a stronger one. */
export function towns_on_horizon(place: Place, places: readonly NamedPlace[], apart_deg: number): TownOnHorizon[] {
  const all = places
    .map((town) => ({ town, ...distance_and_bearing(place, town) }))
    .filter(({ town, distance_km }) => (town.population ?? 0) > 0 && distance_km > NEAREST_KM)
    .map(({ town, distance_km, bearing_deg }) => ({ name: town.name, azimuth_deg: bearing_deg, distance_km, glow: walker_glow(town.population ?? 0, distance_km) }))
    .sort((a, b) => b.glow - a.glow);
  const least = (all[0]?.glow ?? 0) * LEAST_PART;
  const named: TownOnHorizon[] = [];
  for (const { glow, ...town } of all) {
    if (glow < least || named.length === MOST_TOWNS) break;
    const is_free = named.every(({ azimuth_deg }) => Math.abs(((azimuth_deg - town.azimuth_deg + 540) % 360) - 180) >= apart_deg);
    if (is_free) named.push(town);
  }
  return named;
}
