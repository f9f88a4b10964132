// Links to the same sky as files, straight from the API.

import { url_of, type SkyParameters } from "../api/client.ts";
import { words } from "../language/words.ts";
import type { ViewState } from "../state.ts";
import { make } from "./dom.ts";

/** What a perspective shows, as the API takes it: `fov` from the left to the right edge. */
export interface ViewedPart {
  azimuth: number;
  elevation: number;
  fov: number;
}

export function show_downloads(container: HTMLElement, scene: string, parameters: SkyParameters, state: ViewState, view: ViewedPart | null): void {
  const link = (title: string, href: string, description: string) => {
    const anchor = make("a", "", title) as HTMLAnchorElement;
    anchor.href = href;
    anchor.title = description;
    anchor.target = "_blank";
    anchor.rel = "noopener";
    return anchor;
  };
  const { projection, sky, colours } = state;
  const picture = { ...parameters, projection, ...view, sky, colormap: colours, scale: "magnitude" } as const;
  container.replaceChildren(
    link("PNG", url_of("/api/v1/scenes/{scene}/panorama.png", { scene }, picture), words().downloads.png),
    link("EXR", url_of("/api/v1/scenes/{scene}/panorama.exr", { scene }, parameters), words().downloads.exr),
    link("TIFF", url_of("/api/v1/scenes/{scene}/panorama.tif", { scene }, parameters), words().downloads.tiff),
    link("JSON", url_of("/api/v1/scenes/{scene}/panorama.json", { scene }, parameters), words().downloads.json),
    link("API", url_of("/api/docs", {}, {}), words().downloads.api),
  );
}
