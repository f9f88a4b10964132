// A measure for towns and areas: other lamps, shielding and less light in one edit.

import type { EditBody } from "../api/schema.ts";
import type { Place } from "../state/view-state.ts";

/** A ring of longitude and latitude, degrees. */
type Ring = [number, number][];

/** Where a measure holds: around towns, and in areas of a file. */
export interface MeasureArea {
  towns: readonly Place[];
  /** Around each town. */
  radiusM: number;
  /** Features of a GeoJSON file. */
  features: readonly unknown[];
}

/** What it does to the lights there. */
export interface MeasureChange {
  /** Preset of the lamps that are replaced; null: all. */
  lampFrom: string | null;
  /** Preset of the new ones; null: they stay. */
  lampTo: string | null;
  /** Preset of how they send their light; null: as before. */
  emission: string | null;
  /** Part of the light that is left, 0 to 1. */
  lightLeft: number;
  /** Part of the night for which that is so, 0 to 1; before, no lamp is dimmed. */
  nightPart: number;
}

const EARTH_RADIUS_M = 6_371_000;
const CORNERS = 48;
const DEGREES = 180 / Math.PI;

/** A circle on the ground, as a closed ring. */
export function circleAround({ latitude_deg, longitude_deg }: Place, radiusM: number): Ring {
  const northDeg = (radiusM / EARTH_RADIUS_M) * DEGREES;
  // At the poles a circle goes around them: towns are elsewhere.
  const eastDeg = northDeg / Math.max(Math.cos(latitude_deg / DEGREES), 0.01);
  const ring = Array.from({ length: CORNERS }, (_, i): [number, number] => {
    const angleRad = (2 * Math.PI * i) / CORNERS;
    const latitudeDeg = Math.min(Math.max(latitude_deg + northDeg * Math.sin(angleRad), -90), 90);
    return [+(longitude_deg + eastDeg * Math.cos(angleRad)).toFixed(5), +latitudeDeg.toFixed(5)];
  });
  return [...ring, ring[0] ?? [longitude_deg, latitude_deg]];
}

/** The polygons of a feature, or of a bare outline. */
function polygonsOf(feature: unknown): unknown[] {
  const { geometry } = feature as { geometry?: { type?: string; coordinates?: unknown } | null };
  if (geometry?.type === "Polygon") return [geometry.coordinates];
  if (geometry?.type === "MultiPolygon" && Array.isArray(geometry.coordinates)) return geometry.coordinates;
  return [];
}

/** The edit of a measure; null where it changes nothing, or nowhere. Polygons that overlap are united by the server. */
export function measureEdit(area: MeasureArea, change: MeasureChange): EditBody | null {
  const circles = area.towns.map((town) => [circleAround(town, area.radiusM)]);
  const coordinates = [...circles, ...area.features.flatMap(polygonsOf)];
  const { lampFrom, lampTo, emission, lightLeft } = change;
  const isNothing = lampTo === null && emission === null && lightLeft === 1;
  if (coordinates.length === 0 || isNothing) return null;
  return {
    polygon: { type: "MultiPolygon", coordinates },
    ...(lightLeft === 1 ? {} : { factor: lightLeft }),
    ...(lampTo === null ? {} : { lamp: { to: lampTo, ...(lampFrom === null ? {} : { from: lampFrom }) } }),
    ...(emission === null ? {} : { emission }),
  };
}

/** Luminous efficacies of lamps with all that drives them, lm/W; null where nobody gave one. */
export interface Efficacies {
  before: number | null;
  after: number | null;
}

/** Energy after a measure over that before: new lamps give the streets the light of the old ones, less what is dimmed. */
export function energyRatio({ lampTo, lightLeft, nightPart }: MeasureChange, { before, after }: Efficacies): number | null {
  const ofTheNight = 1 - (1 - lightLeft) * nightPart;
  if (lampTo === null) return ofTheNight;
  return before === null || after === null ? null : (ofTheNight * before) / after;
}

/** The part of a night from sunset to sunrise, hours by the Sun, that lies after an hour: 23 is an hour before midnight, 25 one after. */
export function nightAfter(hour: number, [setH, riseH]: readonly [number, number]): number {
  const afterNoon = (at: number) => (((at - 12) % 24) + 24) % 24;
  const [set, rise, from] = [afterNoon(setH), afterNoon(riseH), afterNoon(hour)];
  if (rise <= set) return 0;
  return Math.min(Math.max((rise - from) / (rise - set), 0), 1);
}
