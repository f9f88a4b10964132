// The operator's basemap of vector tiles, where there is one: water and parks below the lights, roads and borders above them. Its
// layers are those of Protomaps (version 4).

import type { LayerSpecification, Map as MapLibreMap } from "maplibre-gl";
import type { BasemapAnswer } from "../api/schema.ts";

const SOURCE = "basemap";
/** Land, and what of it the lights lie on, is below the first; borders of countries are below the second. */
const [ABOVE_LAND, ABOVE_LIGHTS] = ["coast-glow", "coasts"] as const;

const KINDS_OF_PARKS = ["park", "national_park", "nature_reserve", "protected_area", "forest", "wood"];

const BELOW: readonly LayerSpecification[] = [
  {
    id: "basemap-parks",
    type: "fill",
    source: SOURCE,
    "source-layer": "landuse",
    filter: ["in", ["get", "kind"], ["literal", KINDS_OF_PARKS]],
    paint: { "fill-color": "#11242a", "fill-opacity": 0.7 },
  },
  {
    id: "basemap-water",
    type: "fill",
    source: SOURCE,
    "source-layer": "water",
    filter: ["==", ["geometry-type"], "Polygon"],
    paint: { "fill-color": "#070d1f" },
  },
];

/** Wider roads first, each from the zoom on at which a map has room for them. */
const ROADS = [
  ["highway", 5, 0.4, 3.2],
  ["major_road", 7, 0.3, 2.2],
  ["minor_road", 11, 0.2, 1.2],
] as const;

const ABOVE: readonly LayerSpecification[] = [
  ...ROADS.map(
    ([kind, minzoom, thin, thick]): LayerSpecification => ({
      id: `basemap-${kind}`,
      type: "line",
      source: SOURCE,
      "source-layer": "roads",
      minzoom,
      filter: ["==", ["get", "kind"], kind],
      paint: {
        "line-color": "#8fa0c6",
        "line-opacity": 0.35,
        "line-width": ["interpolate", ["exponential", 1.6], ["zoom"], minzoom, thin, 14, thick],
      },
    }),
  ),
  {
    id: "basemap-regions",
    type: "line",
    source: SOURCE,
    "source-layer": "boundaries",
    filter: ["==", ["get", "kind"], "region"],
    paint: { "line-color": "#7d92c4", "line-opacity": 0.3, "line-width": 0.7, "line-dasharray": [2, 3] },
  },
];

/** Adds the basemap's layers as far as its file has them. */
export function addBasemap(map: MapLibreMap, { tiles, minzoom, maxzoom, bounds, attribution, layers }: BasemapAnswer): void {
  if (tiles.length === 0 || map.getSource(SOURCE) !== undefined) return;
  const box = bounds as [number, number, number, number];
  map.addSource(SOURCE, { type: "vector", tiles: [...tiles], minzoom, maxzoom, bounds: box, attribution });
  const has = (layer: LayerSpecification) => "source-layer" in layer && layers.includes(String(layer["source-layer"]));
  for (const layer of BELOW.filter(has)) map.addLayer(layer, ABOVE_LAND);
  for (const layer of ABOVE.filter(has)) map.addLayer(layer, ABOVE_LIGHTS);
}
