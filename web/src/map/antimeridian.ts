// Outlines over the antimeridian and around the poles, as MapLibre draws them.

import type { FeatureCollection, MultiLineString, Position } from "geojson";

/**
 * The atlas joins what reaches over the antimeridian, so that a line jumps there from 180° to −180°. MapLibre wants it to go on past
 * 180°. A ring around a pole then does not come back to its beginning: it is closed by way of the pole.
 */
export function unwrappedLine(line: Position[]): Position[] {
  let turns = 0;
  return line.map(([longitude = 0, latitude = 0], i) => {
    const before = line[i - 1]?.[0] ?? longitude;
    if (longitude - before > 180) turns--;
    if (longitude - before < -180) turns++;
    return [longitude + 360 * turns, latitude];
  });
}

export function unwrappedRing(ring: Position[]): Position[] {
  const open = unwrappedLine(ring);
  const [[first = 0] = [], [last = 0, latitude = 0] = []] = [open[0], open.at(-1)];
  if (Math.abs(last - first) < 180) return open;
  const pole = Math.sign(latitude) * 90;
  return [...open, [last, pole], [first, pole], open[0] ?? [first, latitude]];
}

export function unwrapped(land: FeatureCollection): FeatureCollection {
  for (const { geometry } of land.features) {
    if (geometry.type === "Polygon") geometry.coordinates = geometry.coordinates.map(unwrappedRing);
    if (geometry.type === "MultiPolygon") geometry.coordinates = geometry.coordinates.map((polygon) => polygon.map(unwrappedRing));
  }
  return land;
}

export function unwrappedLines(lines: MultiLineString): MultiLineString {
  return { ...lines, coordinates: lines.coordinates.map(unwrappedLine) };
}
