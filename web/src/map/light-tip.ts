// Whose light a sky is, light by light: what one points at on the map says its share, while the layer of influences is shown.

import type { Map as MapLibreMap, MapMouseEvent } from "maplibre-gl";
import type { InfluentialPixel } from "../api/types.ts";
import type { Place } from "../state/view-state.ts";
import { make } from "../ui/dom.ts";
import { percent } from "../ui/format.ts";

export type Light = Pick<InfluentialPixel, "latitude_deg" | "longitude_deg" | "row" | "column" | "share" | "distance_m">;

/** Finds a light by where it is: pixels of a raster lie in rows and columns, nearly along parallels and meridians. */
export class LightFinder {
  private readonly latStep: number;
  private readonly lonStep: number;
  /** By cells as large as pixels. */
  private readonly cells = new Map<string, Light>();

  constructor(private readonly lights: readonly Light[]) {
    this.latStep = step(lights, "row", "latitude_deg");
    this.lonStep = step(lights, "column", "longitude_deg");
    for (const light of lights) this.cells.set(this.cell(light.latitude_deg, light.longitude_deg), light);
  }

  /** Middles of pixels are middles of cells. */
  private cell(lat: number, lon: number): string {
    const { latitude_deg = 0, longitude_deg = 0 } = this.lights[0] ?? {};
    return `${Math.round((lat - latitude_deg) / this.latStep)}/${Math.round((lon - longitude_deg) / this.lonStep)}`;
  }

  /** The light of the pixel that a place lies in; null where it has none that counts. */
  at({ latitude_deg: lat, longitude_deg: lon }: Place): Light | null {
    if (this.lights.length === 0) return null;
    for (const up of [0, -1, 1])
      for (const right of [0, -1, 1]) {
        const light = this.cells.get(this.cell(lat + up * this.latStep, lon + right * this.lonStep));
        if (light === undefined) continue;
        const isInside =
          Math.abs(light.latitude_deg - lat) <= 0.5 * this.latStep && Math.abs(light.longitude_deg - lon) <= 0.5 * this.lonStep;
        if (isInside) return light;
      }
    return null;
  }
}

/** Degrees from one row or column to the next; what two lights far apart tell best. */
function step(lights: readonly Light[], count: "row" | "column", degrees: "latitude_deg" | "longitude_deg"): number {
  const sorted = lights.toSorted((a, b) => a[count] - b[count]);
  const [first, last] = [sorted[0], sorted.at(-1)];
  const apart = (last?.[count] ?? 0) - (first?.[count] ?? 0);
  // A light alone is as wide as a satellite sees: 15 arc seconds.
  return apart === 0 ? 15 / 3600 : Math.abs(((last?.[degrees] ?? 0) - (first?.[degrees] ?? 0)) / apart);
}

export class LightTip {
  private readonly tip = make("div", "area-tip light-tip");
  private finder = new LightFinder([]);

  constructor(private readonly map: MapLibreMap) {
    this.tip.hidden = true;
    this.tip.setAttribute("aria-hidden", "true");
    map.getContainer().append(this.tip);
    map.on("mousemove", (event) => this.point(event));
    map.on("mouseout", () => this.hide());
    map.on("movestart", () => this.hide());
  }

  show(lights: readonly Light[]): void {
    this.finder = new LightFinder(lights);
    this.hide();
  }

  private hide(): void {
    this.tip.hidden = true;
  }

  private point({ point: { x, y }, lngLat, originalEvent }: MapMouseEvent): void {
    const isMouse = originalEvent.buttons === 0 && matchMedia("(hover: hover)").matches;
    const { lng, lat } = lngLat.wrap();
    const light = isMouse ? this.finder.at({ latitude_deg: lat, longitude_deg: lng }) : null;
    if (light === null) {
      this.hide();
      return;
    }
    this.tip.replaceChildren(make("b", "", percent(light.share)), ` ${Math.round(light.distance_m / 1000)} km`);
    this.tip.hidden = false;
    const { clientWidth } = this.map.getContainer();
    this.tip.style.left = x > clientWidth / 2 ? "" : `${x + 14}px`;
    this.tip.style.right = x > clientWidth / 2 ? `${clientWidth - x + 14}px` : "";
    // Above the tip of an area, which may be there too.
    this.tip.style.top = `${y - 34}px`;
  }
}
