// Links to the same sky as files, straight from the API.

import { url_of, type InfluenceQuery, type SkyParameters } from "../api/client.ts";
import { words } from "../language/words.ts";
import { luminance_from_brightness_cd_m2 } from "../photometry.ts";
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
export function show_influence_downloads(container: HTMLElement, scene: string, query: InfluenceQuery): void {
  const { influence_tif, influence_list } = words().downloads;
  // Of the list the thousand that do most; the raster has them all.
  const listed = { ...query, limit: 1000 };
  container.replaceChildren(
    link("GeoTIFF", url_of("/api/v1/scenes/{scene}/influence.tif", { scene }, query), influence_tif),
    link("GeoJSON", url_of("/api/v1/scenes/{scene}/influence.geojson", { scene }, listed), influence_list),
    link("CSV", url_of("/api/v1/scenes/{scene}/influence.csv", { scene }, listed), influence_list),
    link("JSON", url_of("/api/v1/scenes/{scene}/influence.json", { scene }, listed), influence_list),
  );
}

export function show_downloads(container: HTMLElement, scene: string, parameters: SkyParameters, state: ViewState, view: ViewedPart | null): void {
  const { projection, sky, colours, exposure_ev, unit } = state;
  const scale = unit === "luminance" ? { scale: "luminance", min: String(luminance_from_brightness_cd_m2(SCALE.faintest_mag_arcsec2)), max: String(luminance_from_brightness_cd_m2(SCALE.brightest_mag_arcsec2)) } as const : { scale: "magnitude" } as const;
  const style = colours === "realistic" ? { style: "realistic", exposure: exposure_ev } as const : { colormap: colours, ...scale };
  const picture = { ...parameters, projection, ...view, sky, ...style } as const;
  container.replaceChildren(
    link("PNG", url_of("/api/v1/scenes/{scene}/panorama.png", { scene }, picture), words().downloads.png),
    link("EXR", url_of("/api/v1/scenes/{scene}/panorama.exr", { scene }, parameters), words().downloads.exr),
    link("TIFF", url_of("/api/v1/scenes/{scene}/panorama.tif", { scene }, parameters), words().downloads.tiff),
    link("JSON", url_of("/api/v1/scenes/{scene}/panorama.json", { scene }, parameters), words().downloads.json),
    link("API", url_of("/api/docs", {}, {}), words().downloads.api),
  );
}
