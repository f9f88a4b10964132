// Links to the same sky as files, straight from the API.

import { api, type SkyParameters } from "../api/client.ts";
import type { ViewState } from "../state.ts";
import { make } from "./dom.ts";

export function show_downloads(container: HTMLElement, scene: string, parameters: SkyParameters, state: ViewState): void {
  const picture = `&projection=${state.projection}&sky=${state.sky}&colormap=${state.colours}&scale=magnitude`;
  const link = (title: string, href: string, description: string) => {
    const anchor = make("a", "", title) as HTMLAnchorElement;
    anchor.href = href;
    anchor.title = description;
    anchor.target = "_blank";
    anchor.rel = "noopener";
    return anchor;
  };
  container.replaceChildren(
    link("PNG", api.panorama_url(scene, parameters, "png", picture), "The picture with its legend"),
    link("EXR", api.panorama_url(scene, parameters, "exr"), "Raw radiance, OpenEXR"),
    link("TIFF", api.panorama_url(scene, parameters, "tif"), "Raw radiance, 32-bit TIFF"),
    link("JSON", api.panorama_url(scene, parameters, "json"), "Raw radiance and all numbers"),
    link("API", api.docs_url(), "Try the programming interface"),
  );
}
