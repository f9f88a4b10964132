// The pictures of the land in light below the skies that are shown: asked for once a sky is there, with the exposure and the eye of that
// sky, so that both belong together. Until other pictures of the same place are there, the last ones stay.

import { api, type SkyParameters } from "../api/client.ts";
import { isWithoutAnswer } from "../api/problem.ts";
import { faceGazes, faceSidePx } from "../sky/land-faces.ts";
import { Landscape } from "../sky/landscape.ts";
import fragmentShader from "../sky/shaders/land.frag?raw";
import { adaptationOf } from "../sky/shading.ts";
import {
  type AppState,
  besideScene,
  CONDITIONS,
  coordinatesOf,
  landCdM2Of,
  landOf,
  sceneOf,
  skyConditions,
} from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { debounced } from "../ui/dom.ts";
import { pictureUrl } from "../ui/picture-url.ts";

/** A slider that rests so long has been set. */
const WAIT_MS = 80;
/** What the server takes. */
const DARKEST_CD_M2 = 1e-4;
/** Digits of the luminance that the eye is adapted to: far finer than a step of the display. */
const DIGITS = 4;

/** Addresses of the pictures of a landscape, in the order of `faceGazes`. */
type Addresses = readonly string[];
interface LandRequest {
  shown: Addresses;
  today: Addresses | null;
}

export class LandSession {
  private controller = new AbortController();
  private requested = "";

  constructor(private readonly store: AppStore) {
    const loadSoon = debounced(WAIT_MS, () => void this.load());
    const parts = [landOf, "panorama", "panoramaToday", "sky", "exposureEv", "adaptationCdM2", "colours"] as const;
    store.watch([...parts, sceneOf, "place", "time", "isBusy", "isAway", ...CONDITIONS], (state) => {
      if (landOf(state) === "dark" || state.panorama === null) this.forget();
      else loadSoon();
    });
  }

  private async load(): Promise<void> {
    const { state } = this.store;
    if (landOf(state) === "dark" || state.isBusy || state.isAway) return;
    const request = requestOf(state);
    const requested = JSON.stringify(request);
    if (request === null || requested === this.requested) return;
    this.controller.abort();
    this.controller = new AbortController();
    const { signal } = this.controller;
    this.requested = requested;
    this.store.set({ isLandBusy: true });
    try {
      const both = request.today === null ? [request.shown] : [request.shown, request.today];
      const [landscape = null, landscapeToday = null] = await Promise.all(both.map((each) => loadLandscape(each, signal)));
      if (signal.aborted) return;
      this.show(landscape, landscapeToday);
    } catch (reason) {
      if (signal.aborted) return;
      this.show(null, null);
      // Once the server is back it is asked again.
      if (isWithoutAnswer(reason)) this.requested = "";
      this.store.report(reason);
    }
  }

  /** Ends what is under way: the ground is dark. */
  private forget(): void {
    this.controller.abort();
    this.requested = "";
    const { landscape, isLandBusy } = this.store.state;
    if (landscape !== null || isLandBusy) this.show(null, null);
  }

  private show(landscape: Landscape | null, landscapeToday: Landscape | null): void {
    const before = this.store.state;
    this.store.set({ landscape, landscapeToday, isLandBusy: false });
    before.landscape?.close();
    before.landscapeToday?.close();
  }
}

async function loadLandscape(addresses: Addresses, signal: AbortSignal): Promise<Landscape> {
  const faces = addresses.map(async (address) =>
    createImageBitmap(await api.picture(address, signal), { premultiplyAlpha: "none", colorSpaceConversion: "none" }),
  );
  return new Landscape(await Promise.all(faces), fragmentShader);
}

/** Of the skies that are shown; null where there is none. */
function requestOf(state: Readonly<AppState>): LandRequest | null {
  const { place, panorama, panoramaToday } = state;
  const scene = sceneOf(state);
  if (scene === null || place === null || panorama === null) return null;
  const sidePx = faceSidePx(innerWidth * devicePixelRatio, innerHeight * devicePixelRatio);
  // The eye is adapted to the sky that is shown, and so it looks at the land.
  const adaptation = Math.max(+adaptationOf(panorama, state, landCdM2Of(state)).toPrecision(DIGITS), DARKEST_CD_M2);
  const more = {
    width: sidePx,
    height_px: sidePx,
    legend: "off" as const,
    ...(state.colours === "eye" ? { adaptation } : {}),
  };
  const facing = (parameters: SkyParameters, from = scene.id): Addresses =>
    faceGazes().map((gaze) =>
      pictureUrl(from, parameters, { ...state, projection: "perspective", gaze, skyAspect: 1 }, more, "webp"),
    );
  const shown = { ...coordinatesOf(place), ...skyConditions(state) };
  const { scenario: _, ...today } = shown;
  return { shown: facing(shown), today: panoramaToday === null ? null : facing(today, besideScene(state)?.id) };
}
