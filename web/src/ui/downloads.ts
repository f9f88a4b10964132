// Links to the same sky as files, straight from the API.

import { api, type InfluenceQuery, type SkyParameters, urlOf } from "../api/client.ts";
import { placeWords } from "../language/words.ts";
import {
  type AppState,
  CONDITIONS,
  conditionsOf,
  coordinatesOf,
  influenceQuery,
  landOf,
  sceneOf,
  skyConditions,
} from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { captionLines, withCaption } from "./captioned.ts";
import { byId, make, saveFile } from "./dom.ts";
import { placeName } from "./nearby.ts";
import { pictureUrl } from "./picture-url.ts";

/** Twice as fine as the picture of the link. */
const SAVED_WIDTH_PX = { equirectangular: 2048, fisheye: 1536, perspective: 2048 } as const;

/** Follows what is shown, so that the files are of the same sky. */
export function mountDownloads(store: AppStore): void {
  const pictures = byId("download-links", HTMLElement);
  const influences = byId("influence-links", HTMLElement);
  const save = byId("save-picture", HTMLButtonElement);
  save.addEventListener("click", () => {
    save.disabled = true;
    savePicture(store.state)
      .catch((reason: unknown) => store.report(reason))
      .finally(() => {
        save.disabled = false;
      });
  });
  const look = [
    "projection",
    "sky",
    "colours",
    "exposureEv",
    "adaptationCdM2",
    landOf,
    "unit",
    "gaze",
    "skyAspect",
    "panorama",
  ] as const;
  store.watch([sceneOf, "place", "time", ...CONDITIONS, ...look], (state) => {
    const { place } = state;
    const scene = sceneOf(state);
    if (scene === null || place === null) return;
    showDownloads(pictures, scene.id, { ...coordinatesOf(place), ...skyConditions(state) }, state);
  });
  store.watch([sceneOf, "place", ...CONDITIONS, "measure", "region"], (state) => {
    const scene = sceneOf(state);
    if (scene === null || state.place === null) return;
    showInfluenceDownloads(influences, scene.id, influenceQuery(state, state.place, conditionsOf(state)));
  });
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
function showInfluenceDownloads(container: HTMLElement, scene: string, query: InfluenceQuery): void {
  const { influenceTif, influenceList } = placeWords().downloads;
  // The list has the thousand of most influence; the raster has them all.
  const listed = { ...query, limit: 1000 };
  container.replaceChildren(
    link("GeoTIFF", urlOf("/api/v1/scenes/{scene}/influence.tif", { scene }, query), influenceTif),
    link("GeoJSON", urlOf("/api/v1/scenes/{scene}/influence.geojson", { scene }, listed), influenceList),
    link("CSV", urlOf("/api/v1/scenes/{scene}/influence.csv", { scene }, listed), influenceList),
    link("JSON", urlOf("/api/v1/scenes/{scene}/influence.json", { scene }, listed), influenceList),
  );
}

/** That picture with its caption. */
async function savePicture(state: Readonly<AppState>): Promise<void> {
  const { place, places, answer, shares } = state;
  const scene = sceneOf(state);
  if (scene === null || place === null || answer === null) return;
  const url = pictureUrl(scene.id, { ...coordinatesOf(place), ...skyConditions(state) }, state, {
    width: SAVED_WIDTH_PX[state.projection],
  });
  const name = placeName(place, places);
  const lines = captionLines({ place, name, scene, answer, shares }, state);
  const picture = await withCaption(await api.picture(url, new AbortController().signal), lines);
  saveFile(picture, `skyglow ${name.replaceAll(/[\\/:*?"<>|]/g, " ")}.png`);
}

function showDownloads(container: HTMLElement, scene: string, parameters: SkyParameters, state: AppState): void {
  // Rasters hold the radiance in bands, whatever sees it.
  const { response: _, ...raster } = parameters;
  container.replaceChildren(
    link("PNG", pictureUrl(scene, parameters, state), placeWords().downloads.png),
    link("EXR", urlOf("/api/v1/scenes/{scene}/panorama.exr", { scene }, raster), placeWords().downloads.exr),
    link("TIFF", urlOf("/api/v1/scenes/{scene}/panorama.tif", { scene }, raster), placeWords().downloads.tiff),
    link("JSON", urlOf("/api/v1/scenes/{scene}/panorama.json", { scene }, parameters), placeWords().downloads.json),
    link("API", urlOf("/api/docs", {}, {}), placeWords().downloads.api),
  );
}
