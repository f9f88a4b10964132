// The night style of the map. There is no `glyphs` URL: MapLibre then draws text with the machine's own fonts.

import type {
  ExpressionSpecification,
  GeoJSONSourceSpecification,
  LayerSpecification,
  LineLayerSpecification,
  StyleSpecification,
} from "maplibre-gl";

const FONT = ["Inter", "system-ui", "sans-serif"];
const EMPTY: GeoJSONSourceSpecification = { type: "geojson", data: { type: "FeatureCollection", features: [] } };

/** Scene rasters are put below this layer, so that borders and names stay readable. */
export const FIRST_LAYER_ABOVE_TILES = "borders";

/** Where names stand at their towns, the best first. */
export const NAME_ANCHORS = ["left", "right", "top", "bottom"] as const;

const halo = { "text-halo-color": "rgba(5, 8, 16, 0.9)", "text-halo-width": 1.4 };

/** A stroke as wide as the brush on the ground, or a thin line around an area that is being drawn. */
function brush(opacity: number): Pick<LineLayerSpecification, "layout" | "paint"> {
  const widthPx: ExpressionSpecification = ["coalesce", ["get", "widthPx"], 0];
  const at = (zoom: number): ExpressionSpecification => ["max", 2, ["*", widthPx, 2 ** zoom]];
  return {
    layout: { "line-cap": "round", "line-join": "round" },
    paint: {
      "line-color": "#f08fd0",
      "line-opacity": opacity,
      "line-width": ["interpolate", ["exponential", 2], ["zoom"], 0, at(0), 14, at(14)],
    },
  };
}

const layers: LayerSpecification[] = [
  { id: "sea", type: "background", paint: { "background-color": "#060912" } },
  { id: "graticule", type: "line", source: "graticule", paint: { "line-color": "#8fa8e0", "line-opacity": 0.07, "line-width": 1 } },
  { id: "land", type: "fill", source: "land", paint: { "fill-color": "#10172a", "fill-antialias": false } },
  {
    id: "coast-glow",
    type: "line",
    source: "coasts",
    paint: { "line-color": "#5d86d6", "line-opacity": 0.12, "line-width": 7, "line-blur": 6 },
  },
  {
    id: "borders",
    type: "line",
    source: "borders",
    paint: { "line-color": "#7d92c4", "line-opacity": 0.45, "line-width": 0.8, "line-dasharray": [4, 3] },
  },
  { id: "coasts", type: "line", source: "coasts", paint: { "line-color": "#8aa6e6", "line-opacity": 0.6, "line-width": 0.9 } },
  {
    id: "scene-outline",
    type: "line",
    source: "scene",
    paint: { "line-color": "#f3bd73", "line-opacity": 0.55, "line-width": 1.2, "line-dasharray": [2, 3] },
  },
  {
    id: "painted-areas",
    type: "fill",
    source: "painted",
    filter: ["==", ["geometry-type"], "Polygon"],
    paint: { "fill-color": "#f08fd0", "fill-opacity": 0.16, "fill-outline-color": "#f08fd0" },
  },
  { id: "painted-strokes", type: "line", source: "painted", filter: ["==", ["geometry-type"], "LineString"], ...brush(0.2) },
  { id: "stroke", type: "line", source: "stroke", ...brush(0.45) },
  {
    id: "dimmed",
    type: "circle",
    source: "dimmed",
    paint: {
      "circle-radius": ["interpolate", ["exponential", 1.7], ["zoom"], 4, 1.2, 8, 4, 12, 24],
      "circle-color": ["interpolate", ["linear"], ["get", "cut"], 0, "#1d5f74", 1, "#6ff0dc"],
      "circle-opacity": 0.75,
    },
  },
  {
    id: "country-names",
    type: "symbol",
    source: "names",
    maxzoom: 7,
    layout: {
      "text-field": ["upcase", ["get", "name"]],
      "text-font": FONT,
      "text-size": ["interpolate", ["linear"], ["zoom"], 2, 9, 6, 13],
      "text-letter-spacing": 0.18,
      "text-max-width": 8,
      "symbol-sort-key": ["get", "rank"],
    },
    paint: { "text-color": "#8fa0c6", "text-opacity": 0.75, ...halo },
  },
  {
    id: "places",
    type: "symbol",
    source: "places",
    layout: {
      "text-field": ["get", "name"],
      "text-font": FONT,
      "text-size": ["interpolate", ["linear"], ["coalesce", ["get", "population"], 0], 0, 11, 100000, 12, 3000000, 15],
      "text-variable-anchor": [...NAME_ANCHORS],
      "text-radial-offset": 0.6,
      "text-justify": "auto",
      "text-padding": 6,
      "symbol-sort-key": ["-", 0, ["coalesce", ["get", "population"], 0]],
    },
    paint: { "text-color": "#dfe6f7", ...halo },
  },
];

export function nightStyle(): StyleSpecification {
  return {
    version: 8,
    sources: {
      graticule: EMPTY,
      land: EMPTY,
      coasts: EMPTY,
      borders: EMPTY,
      names: EMPTY,
      scene: EMPTY,
      dimmed: EMPTY,
      painted: EMPTY,
      stroke: EMPTY,
      places: EMPTY,
    },
    layers,
  };
}
