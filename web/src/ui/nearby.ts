// "12 km NE of Nairobi": where a place is, in people's terms.

import type { NamedPlace } from "../api/types.ts";
import { words } from "../language/words.ts";
import { compass_name } from "../sky/projection.ts";
import type { Place } from "../state.ts";
import { coordinates } from "./format.ts";

const EARTH_RADIUS_KM = 6371;
const FARTHEST_KM = 150;
const RADIANS = Math.PI / 180;

/** Great-circle distance [km] and initial bearing [degrees clockwise from north]. */
export function distance_and_bearing(from: Place, to: Place): { distance_km: number; bearing_deg: number } {
  const [from_lat, to_lat] = [from.latitude_deg * RADIANS, to.latitude_deg * RADIANS];
  const east = (to.longitude_deg - from.longitude_deg) * RADIANS;
  const half = Math.sin((to_lat - from_lat) / 2) ** 2 + Math.cos(from_lat) * Math.cos(to_lat) * Math.sin(east / 2) ** 2;
  const bearing_rad = Math.atan2(
    Math.sin(east) * Math.cos(to_lat),
    Math.cos(from_lat) * Math.sin(to_lat) - Math.sin(from_lat) * Math.cos(to_lat) * Math.cos(east),
  );
  return {
    distance_km: 2 * EARTH_RADIUS_KM * Math.asin(Math.min(Math.sqrt(half), 1)),
    bearing_deg: (bearing_rad / RADIANS + 360) % 360,
  };
}

/** The nearest named place, and the way from there; null where none is near. */
export function nearest_place(place: Place, places: readonly NamedPlace[]): { name: string; distance_km: number; bearing_deg: number } | null {
  let nearest = { distance_km: FARTHEST_KM, bearing_deg: 0, name: "" };
  for (const named of places) {
    const way = distance_and_bearing(named, place);
    if (way.distance_km < nearest.distance_km) nearest = { ...way, name: named.name };
  }
  return nearest.name === "" ? null : nearest;
}

export function place_name(place: Place, places: readonly NamedPlace[]): string {
  const nearest = nearest_place(place, places);
  if (nearest === null) return coordinates(place.latitude_deg, place.longitude_deg);
  if (nearest.distance_km < 1.5) return nearest.name;
  return words().places.beside(Math.round(nearest.distance_km), compass_name(nearest.bearing_deg), nearest.name);
}
