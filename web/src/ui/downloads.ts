// Links to the same sky as files, straight from the API.

import { type InfluenceQuery, type SkyParameters, urlOf } from "../api/client.ts";
import { placeWords } from "../language/words.ts";
import { isOfLight } from "../sky/colour-maps.ts";
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
import { byId, make } from "./dom.ts";
import { pictureUrl } from "./picture-url.ts";
import { savedSizePx } from "./saved-size.ts";

/** Follows what is shown, so that the files are of the same sky. */
export function mountDownloads(store: AppStore): void {
  const pictures = byId("download-links", HTMLElement);
  const influences = byId("influence-links", HTMLElement);
  const horizon = byId("horizon-links", HTMLElement);
  const size = byId("save-size", HTMLSelectElement);
  onSave(store, byId("save-picture", HTMLButtonElement), async (state) => {
    const { savePicture } = await import("./saving.ts");
    await savePicture(state, size.value === "4k" ? "4k" : "screen");
  });
  const both = { png: byId("save-both", HTMLButtonElement), gif: byId("save-both-gif", HTMLButtonElement) };
  for (const format of ["png", "gif"] as const)
    onSave(store, both[format], async (state) => (await import("./saving.ts")).saveBeforeAfter(state, format));
  store.watch(["scenario"], ({ scenario }) => {
    byId("save-moving", HTMLElement).hidden = scenario === null;
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
    showHorizon(horizon, scene.id, coordinatesOf(place), state);
  });
  store.watch([sceneOf, "place", ...CONDITIONS, "measure", "region"], (state) => {
    const scene = sceneOf(state);
    if (scene === null || state.place === null) return;
    showInfluenceDownloads(influences, scene.id, influenceQuery(state, state.place, conditionsOf(state)));
  });
}

/** Saves a picture on a click; until it is there, no other is asked for. */
function onSave(store: AppStore, button: HTMLButtonElement, save: (state: Readonly<AppState>) => Promise<void>): void {
  button.addEventListener("click", () => {
    button.disabled = true;
    save(store.state)
      .catch((reason: unknown) => store.report(reason))
      .finally(() => {
        button.disabled = false;
      });
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

/** The skyline for programs of the night sky. */
function showHorizon(container: HTMLElement, scene: string, place: Pick<SkyParameters, "lat" | "lon">, state: AppState): void {
  const say = placeWords().downloads;
  const horizon = (format: "stellarium" | "nina") => urlOf("/api/v1/scenes/{scene}/horizon.txt", { scene }, { ...place, format });
  const { scenario } = skyConditions(state);
  const changed = scenario === undefined ? {} : { scenario };
  container.replaceChildren(
    link("Stellarium", horizon("stellarium"), say.horizonStellarium),
    link("N.I.N.A.", horizon("nina"), say.horizonNina),
    link("ZIP", urlOf("/api/v1/scenes/{scene}/landscape.zip", { scene }, { ...place, ...changed }), say.landscape),
  );
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

function showDownloads(container: HTMLElement, scene: string, parameters: SkyParameters, state: AppState): void {
  // Rasters hold the radiance in bands, whatever sees it.
  const { response: _, ...raster } = parameters;
  const { projection, skyAspect, colours } = state;
  // Screens that go above white show lights so; false colours have none.
  const bright = { ...savedSizePx(projection, skyAspect, "screen"), dynamic_range: "hdr" } as const;
  const hdr = isOfLight(colours) ? [link("HDR", pictureUrl(scene, parameters, state, bright), placeWords().downloads.hdr)] : [];
  container.replaceChildren(
    link("PNG", pictureUrl(scene, parameters, state), placeWords().downloads.png),
    ...hdr,
    link("EXR", urlOf("/api/v1/scenes/{scene}/panorama.exr", { scene }, raster), placeWords().downloads.exr),
    link("TIFF", urlOf("/api/v1/scenes/{scene}/panorama.tif", { scene }, raster), placeWords().downloads.tiff),
    link("JSON", urlOf("/api/v1/scenes/{scene}/panorama.json", { scene }, parameters), placeWords().downloads.json),
    link("API", urlOf("/api/docs", {}, {}), placeWords().downloads.api),
  );
}
