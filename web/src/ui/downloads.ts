// Links to the same sky as files, straight from the API.

import { type InfluenceQuery, type SkyParameters, urlOf } from "../api/client.ts";
import { words } from "../language/words.ts";
import { luminanceFromBrightnessCdM2 } from "../photometry.ts";
import { SCALE } from "../sky/scale.ts";
import type { ViewState } from "../state.ts";
import { make } from "./dom.ts";

/** What a perspective shows, as the API takes it: `fov` from the left to the right edge. */
export interface ViewedPart {
  azimuth: number;
  elevation: number;
  fov: number;
}

function link(title: string, href: string, description: string): HTMLElement {
  const anchor = make("a", "", title) as HTMLAnchorElement;
  anchor.href = href;
  anchor.title = description;
  anchor.target = "_blank";
  anchor.rel = "noopener";
  return anchor;
}

/** Whose light it is: every lit pixel's part in the measure of the map's layer. */
export function showInfluenceDownloads(container: HTMLElement, scene: string, query: InfluenceQuery): void {
  const { influenceTif, influenceList } = words().downloads;
  // Of the list the thousand that do most; the raster has them all.
  const listed = { ...query, limit: 1000 };
  container.replaceChildren(
    link("GeoTIFF", urlOf("/api/v1/scenes/{scene}/influence.tif", { scene }, query), influenceTif),
    link("GeoJSON", urlOf("/api/v1/scenes/{scene}/influence.geojson", { scene }, listed), influenceList),
    link("CSV", urlOf("/api/v1/scenes/{scene}/influence.csv", { scene }, listed), influenceList),
    link("JSON", urlOf("/api/v1/scenes/{scene}/influence.json", { scene }, listed), influenceList),
  );
}

export function showDownloads(
  container: HTMLElement,
  scene: string,
  parameters: SkyParameters,
  state: ViewState,
  view: ViewedPart | null,
): void {
  const { projection, sky, colours, exposureEv, unit } = state;
  const scale =
    unit === "luminance"
      ? ({
          scale: "luminance",
          min: String(luminanceFromBrightnessCdM2(SCALE.faintestMagArcsec2)),
          max: String(luminanceFromBrightnessCdM2(SCALE.brightestMagArcsec2)),
        } as const)
      : ({ scale: "magnitude" } as const);
  const style = colours === "realistic" ? ({ style: "realistic", exposure: exposureEv } as const) : { colormap: colours, ...scale };
  const picture = { ...parameters, projection, ...view, sky, ...style } as const;
  container.replaceChildren(
    link("PNG", urlOf("/api/v1/scenes/{scene}/panorama.png", { scene }, picture), words().downloads.png),
    link("EXR", urlOf("/api/v1/scenes/{scene}/panorama.exr", { scene }, parameters), words().downloads.exr),
    link("TIFF", urlOf("/api/v1/scenes/{scene}/panorama.tif", { scene }, parameters), words().downloads.tiff),
    link("JSON", urlOf("/api/v1/scenes/{scene}/panorama.json", { scene }, parameters), words().downloads.json),
    link("API", urlOf("/api/docs", {}, {}), words().downloads.api),
  );
}
