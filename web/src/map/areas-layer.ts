// Areas of somebody's file on the map, each with its share: as a label where there is room, and where one points or taps.

import type { Feature, FeatureCollection } from "geojson";
import type { GeoJSONSource, LayerSpecification, Map as MapLibreMap, MapMouseEvent, SourceSpecification } from "maplibre-gl";
import type { AreaShare } from "../api/types.ts";
import { make } from "../ui/dom.ts";
import { percent } from "../ui/format.ts";

/** Ids of their layers, the fill first. */
const LAYERS = ["areas", "areas-line", "areas-pointed", "areas-names"] as const;
const FONT = ["Inter", "system-ui", "sans-serif"];
const EMPTY: SourceSpecification = { type: "geojson", data: { type: "FeatureCollection", features: [] } };
const NOTHING = -1;
/** Towns and countries stay readable above them. */
const BELOW = "country-names";

const STYLE: readonly LayerSpecification[] = [
  {
    id: "areas",
    type: "fill",
    source: "areas",
    // The root tells small shares apart.
    paint: { "fill-color": "#8db4ff", "fill-opacity": ["interpolate", ["linear"], ["^", ["get", "share"], 0.5], 0, 0.06, 1, 0.5] },
  },
  {
    id: "areas-line",
    type: "line",
    source: "areas",
    paint: { "line-color": "#b9d0ff", "line-opacity": 0.8, "line-width": 1.2 },
  },
  {
    id: "areas-pointed",
    type: "line",
    source: "areas",
    filter: ["==", ["get", "number"], NOTHING],
    paint: { "line-color": "#ffffff", "line-width": 2.6 },
  },
  {
    id: "areas-names",
    type: "symbol",
    source: "areas",
    layout: {
      "text-field": ["get", "label"],
      "text-font": FONT,
      "text-size": 12,
      "text-max-width": 9,
      "text-padding": 4,
      "symbol-sort-key": ["-", 0, ["get", "share"]],
    },
    paint: { "text-color": "#ffffff", "text-halo-color": "rgba(5, 8, 16, 0.9)", "text-halo-width": 1.4 },
  },
];

/** Outlines with their names and shares. */
export interface SharedAreas {
  features: readonly unknown[];
  shares: readonly Pick<AreaShare, "feature" | "name" | "share">[];
}

/** The outlines of a file, each with what the map says of it. */
export function areaFeatures({ features, shares }: SharedAreas): FeatureCollection {
  const named = shares.flatMap(({ feature, name, share }): Feature[] => {
    const outline = features[feature - 1] as Feature | undefined;
    if (outline?.geometry == null) return [];
    const label = `${name}\n${percent(share)}`;
    return [{ type: "Feature", properties: { number: feature, share, label }, geometry: outline.geometry }];
  });
  return { type: "FeatureCollection", features: named };
}

/** Fingers tap: the mouse that browsers make of them is none. */
const canHover = () => matchMedia("(hover: hover)").matches;

export class AreasLayer {
  private readonly tip = make("div", "area-tip");
  private isShown = false;
  private pointed = NOTHING;

  constructor(
    private readonly map: MapLibreMap,
    private readonly styled: Promise<unknown>,
  ) {
    this.tip.hidden = true;
    // The table beside the map says the same.
    this.tip.setAttribute("aria-hidden", "true");
    map.getContainer().append(this.tip);
    map.on("mousemove", (event) => this.point(event));
    map.on("mouseout", () => {
      if (canHover()) this.forget();
    });
    map.on("movestart", () => this.forget());
  }

  async show(areas: SharedAreas | null): Promise<void> {
    await this.styled;
    this.forget();
    this.isShown = areas !== null;
    if (areas !== null && this.map.getSource("areas") === undefined) {
      this.map.addSource("areas", EMPTY);
      for (const layer of STYLE) this.map.addLayer(layer, layer.type === "symbol" ? undefined : BELOW);
    }
    const data = areas === null ? areaFeatures({ features: [], shares: [] }) : areaFeatures(areas);
    this.map.getSource<GeoJSONSource>("areas")?.setData(data);
  }

  /** Whether a tap is about an area: the first on one shows its share, and the next picks the place as everywhere. */
  takesTap({ originalEvent, point }: MapMouseEvent): boolean {
    const isTouch = "pointerType" in originalEvent && originalEvent.pointerType === "touch";
    if (!this.isShown || !isTouch) return false;
    const before = this.pointed;
    this.pointAt(point);
    return this.pointed !== NOTHING && this.pointed !== before;
  }

  private point({ point, originalEvent }: MapMouseEvent): void {
    const isMouse = originalEvent.buttons === 0 && canHover();
    if (this.isShown && isMouse) this.pointAt(point);
  }

  private pointAt({ x, y }: { x: number; y: number }): void {
    const [area] = this.map.queryRenderedFeatures([x, y], { layers: [LAYERS[0]] });
    if (area === undefined) {
      this.forget();
      return;
    }
    const { number, label } = area.properties as { number: number; label: string };
    const [name = "", share = ""] = label.split("\n");
    this.tip.replaceChildren(make("b", "", share), ` ${name}`);
    this.tip.hidden = false;
    // On the side where there is room.
    const { clientWidth } = this.map.getContainer();
    this.tip.style.left = x > clientWidth / 2 ? "" : `${x + 14}px`;
    this.tip.style.right = x > clientWidth / 2 ? `${clientWidth - x + 14}px` : "";
    this.tip.style.top = `${y + 10}px`;
    if (number === this.pointed) return;
    this.pointed = number;
    this.map.setFilter(LAYERS[2], ["==", ["get", "number"], number]);
  }

  private forget(): void {
    if (this.pointed === NOTHING) return;
    this.tip.hidden = true;
    this.pointed = NOTHING;
    this.map.setFilter(LAYERS[2], ["==", ["get", "number"], NOTHING]);
  }
}
