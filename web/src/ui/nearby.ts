// "12 km NE of Nairobi": the nearest town, by great-circle distance (haversine formula, Sinnott 1984).

import type { NamedPlace } from "../api/types.ts";
import { words } from "../language/words.ts";
import { compassName } from "../sky/projection.ts";
import type { Place } from "../state/view-state.ts";
import { coordinates } from "./format.ts";

const EARTH_RADIUS_KM = 6371;
const MAX_DISTANCE_KM = 150;
const RADIANS = Math.PI / 180;

/** Great-circle distance [km] and initial bearing [degrees clockwise from north]. */
export function distanceAndBearing(from: Place, to: Place): { distanceKm: number; bearingDeg: number } {
  const [fromLat, toLat] = [from.latitude_deg * RADIANS, to.latitude_deg * RADIANS];
  const east = (to.longitude_deg - from.longitude_deg) * RADIANS;
  const half = Math.sin((toLat - fromLat) / 2) ** 2 + Math.cos(fromLat) * Math.cos(toLat) * Math.sin(east / 2) ** 2;
  const bearingRad = Math.atan2(
    Math.sin(east) * Math.cos(toLat),
    Math.cos(fromLat) * Math.sin(toLat) - Math.sin(fromLat) * Math.cos(toLat) * Math.cos(east),
  );
  return {
    distanceKm: 2 * EARTH_RADIUS_KM * Math.asin(Math.min(Math.sqrt(half), 1)),
    bearingDeg: (bearingRad / RADIANS + 360) % 360,
  };
}

/** The nearest named place, and the way from there; null where none is near. */
export function nearestPlace(
  place: Place,
  places: readonly NamedPlace[],
): { name: string; distanceKm: number; bearingDeg: number } | null {
  let nearest = { distanceKm: MAX_DISTANCE_KM, bearingDeg: 0, name: "" };
  for (const named of places) {
    const way = distanceAndBearing(named, place);
    if (way.distanceKm < nearest.distanceKm) nearest = { ...way, name: named.name };
  }
  return nearest.name === "" ? null : nearest;
}

export function placeName(place: Place, places: readonly NamedPlace[]): string {
  const nearest = nearestPlace(place, places);
  if (nearest === null) return coordinates(place.latitude_deg, place.longitude_deg);
  if (nearest.distanceKm < 1.5) return nearest.name;
  return words().places.beside(Math.round(nearest.distanceKm), compassName(nearest.bearingDeg), nearest.name);
}
