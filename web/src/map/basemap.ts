// Natural Earth outlines (public domain, by world-atlas), served with the viewer: no request goes to another host.

import type { Feature, FeatureCollection, MultiLineString, Point, Polygon, Position } from "geojson";
import { feature, mesh } from "topojson-client";
import type { GeometryCollection, Topology } from "topojson-specification";
import fineUrl from "world-atlas/countries-50m.json?url";
import coarseUrl from "world-atlas/countries-110m.json?url";
import { noAnswer } from "../api/problem.ts";
import { words } from "../language/words.ts";
import { unwrapped, unwrappedLines } from "./antimeridian.ts";

type Atlas = Topology<{ countries: GeometryCollection<{ name: string }> }>;

export interface Basemap {
  land: FeatureCollection;
  coasts: MultiLineString;
  borders: MultiLineString;
  /** One label point for each country, with `name` and `rank` (0 for the largest). */
  names: FeatureCollection<Point>;
  /** Every tenth meridian and parallel. */
  graticule: Feature<MultiLineString>;
}

/** Twice the signed area and the centroid of a ring, in degrees: good enough to place a label. */
function ringCentroid(ring: Position[]): { area: number; centre: [number, number] } {
  let area = 0;
  let x = 0;
  let y = 0;
  for (let i = 0; i + 1 < ring.length; i++) {
    const [x0 = 0, y0 = 0] = ring[i] ?? [];
    const [x1 = 0, y1 = 0] = ring[i + 1] ?? [];
    const cross = x0 * y1 - x1 * y0;
    area += cross;
    x += (x0 + x1) * cross;
    y += (y0 + y1) * cross;
  }
  return area === 0 ? { area, centre: [0, 0] } : { area: Math.abs(area), centre: [x / (3 * area), y / (3 * area)] };
}

/** The atlas names countries in English, and numbers most of them by ISO 3166; the browser knows their names in other languages. */
function countryNamer(): (country: Feature) => string {
  const { locale } = words();
  const names = locale === "en" ? null : new Intl.DisplayNames(locale, { type: "region", fallback: "none" });
  return ({ id, properties }) => {
    const code = names === null || id === undefined ? undefined : new Intl.Locale(`und-${id}`).region;
    return (code === undefined ? undefined : names?.of(code)) ?? String(properties?.name ?? "");
  };
}

function labelPoints(land: FeatureCollection): FeatureCollection<Point> {
  const labels: { name: string; area: number; centre: [number, number] }[] = [];
  const nameOf = countryNamer();
  for (const country of land.features) {
    const { geometry } = country;
    const polygons: Polygon["coordinates"][] =
      geometry.type === "Polygon" ? [geometry.coordinates] : geometry.type === "MultiPolygon" ? geometry.coordinates : [];
    const largest = polygons.map((rings) => ringCentroid(rings[0] ?? [])).sort((a, b) => b.area - a.area)[0];
    if (largest !== undefined && largest.area > 0) labels.push({ name: nameOf(country), ...largest });
  }
  labels.sort((a, b) => b.area - a.area);
  return {
    type: "FeatureCollection",
    features: labels.map(({ name, centre }, rank) => ({
      type: "Feature",
      properties: { name, rank },
      geometry: { type: "Point", coordinates: centre },
    })),
  };
}

function graticule(): Feature<MultiLineString> {
  const lines: Position[][] = [];
  for (let longitude = -180; longitude < 180; longitude += 10)
    lines.push([
      [longitude, -80],
      [longitude, 80],
    ]);
  for (let latitude = -80; latitude <= 80; latitude += 10) {
    lines.push(Array.from({ length: 37 }, (_, i) => [-180 + 10 * i, latitude]));
  }
  return { type: "Feature", properties: {}, geometry: { type: "MultiLineString", coordinates: lines } };
}

/** Coarse outlines come soon, fine ones are six times as long. */
export async function loadBasemap(detail: "coarse" | "fine"): Promise<Basemap> {
  const response = await fetch(detail === "coarse" ? coarseUrl : fineUrl).catch(() => {
    throw noAnswer();
  });
  if (!response.ok) throw new Error(words().map.noOutlines(response.status));
  const atlas = (await response.json()) as Atlas;
  const { countries } = atlas.objects;
  const land = unwrapped(feature(atlas, countries));
  return {
    land,
    coasts: unwrappedLines(mesh(atlas, countries, (a, b) => a === b)),
    borders: unwrappedLines(mesh(atlas, countries, (a, b) => a !== b)),
    names: labelPoints(land),
    graticule: graticule(),
  };
}
