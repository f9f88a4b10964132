// Pinned places side by side: their skies as pictures of one scale, and their numbers in a table.

import { api } from "../api/client.ts";
import type { SkyAnswer } from "../api/types.ts";
import { isSamePlace } from "../data/darker-session.ts";
import { placeWords, words } from "../language/words.ts";
import { adaptationOf } from "../sky/shading.ts";
import { type AppState, CONDITIONS, coordinatesOf, landCdM2Of, sceneFor, skyConditions } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { MAX_PINS, type Place } from "../state/view-state.ts";
import { directionWords } from "./darker.ts";
import { byId, make } from "./dom.ts";
import { fixed, magnitude, ratio } from "./format.ts";
import { placeName } from "./nearby.ts";
import { pictureUrl } from "./picture-url.ts";

const PICTURE_WIDTH_PX = 512;

/** The request for a pinned place's sky: under the air, lamps and time that are shown; changed lights are those of one scene. */
function requestOf(state: Readonly<AppState>, pin: Place) {
  const scene = sceneFor(state, pin);
  if (scene === null) return null;
  const { scenario, ...today } = skyConditions(state);
  const lights = scenario === undefined || scene.id !== state.scene ? {} : { scenario };
  return { scene: scene.id, parameters: { ...coordinatesOf(pin), ...today, ...lights } };
}

/** Nothing is looked for as near as this: it is asked what the place itself is like. */
const AT_THE_PLACE = { within_km: 2, limit: 1 } as const;

/** The request for a pinned place's low sky, which is told under a clear sky alone. */
function lowSkyRequestOf(state: Readonly<AppState>, pin: Place) {
  const request = requestOf(state, pin);
  if (request === null || state.clouds !== null) return null;
  const { time: _, ...query } = request.parameters;
  return { scene: request.scene, query: { ...query, ...AT_THE_PLACE } };
}

export class Compare {
  private readonly button = byId("pin", HTMLButtonElement);
  private readonly table = byId("compare", HTMLElement);
  private requests = new AbortController();
  private readonly answers = new Map<string, SkyAnswer | null>();
  /** Clean directions of their low skies; null where terrain hides all of it, or nobody knows. */
  private readonly clean = new Map<string, readonly (readonly number[])[] | null>();
  /** By place; each stays until a picture of another look is known, so that none is asked for twice. */
  private readonly pictures = new Map<string, HTMLImageElement>();

  /** `goTo` shows the sky of a place. */
  constructor(
    private readonly store: AppStore,
    private readonly goTo: (place: Place) => void,
  ) {
    this.button.addEventListener("click", () => {
      const { place, pins } = store.state;
      if (place === null) return;
      const others = pins.filter((pin) => !isSamePlace(pin, place));
      store.set({ pins: others.length < pins.length ? others : [...pins, place] });
    });
    store.watch(["pins", "place"], ({ pins, place }) => {
      const isPinned = place !== null && pins.some((pin) => isSamePlace(pin, place));
      this.button.setAttribute("aria-pressed", String(isPinned));
      this.button.disabled = !isPinned && pins.length >= MAX_PINS;
      this.button.textContent = isPinned ? placeWords().compare.unpin : placeWords().compare.pin;
    });
    const look = ["panorama", "sky", "colours", "exposureEv", "adaptationCdM2", "land", "unit", "projection", "places"] as const;
    store.watch(["pins", "place", "scenes", "time", "skyStage", "isBusy", "isAway", ...CONDITIONS, ...look], (state) => {
      this.show(state);
      if (state.pins.length > 0 && state.skyStage === "picture" && !state.isBusy && !state.isAway) void this.load(state);
    });
  }

  /** Asks for the skies that are not known yet, one after the other. */
  private async load(state: Readonly<AppState>): Promise<void> {
    this.requests.abort();
    this.requests = new AbortController();
    const { signal } = this.requests;
    for (const pin of state.pins) {
      const request = requestOf(state, pin);
      const key = JSON.stringify(request);
      if (request === null || this.answers.has(key)) continue;
      try {
        this.answers.set(key, await api.sky(request.scene, request.parameters, signal));
      } catch {
        if (signal.aborted) return;
        this.answers.set(key, null);
      }
      if (signal.aborted) return;
      this.show(this.store.state);
    }
    for (const pin of state.pins) await this.loadLowSky(lowSkyRequestOf(state, pin), signal);
  }

  /** Where artificial light leaves the horizon dark: what the search for darker places says of its own place. */
  private async loadLowSky(request: ReturnType<typeof lowSkyRequestOf>, signal: AbortSignal): Promise<void> {
    const key = JSON.stringify(request);
    if (signal.aborted || request === null || this.clean.has(key)) return;
    try {
      const { here } = await api.darker(request.scene, request.query, signal);
      this.clean.set(key, here.low_sky?.clean_directions_deg ?? null);
    } catch {
      if (signal.aborted) return;
      this.clean.set(key, null);
    }
    if (!signal.aborted) this.show(this.store.state);
  }

  private show(state: Readonly<AppState>): void {
    this.table.hidden = state.pins.length === 0;
    if (state.pins.length === 0) return;
    const focused = document.activeElement;
    const focus = focused instanceof HTMLElement && this.table.contains(focused) ? focused.dataset.key : undefined;
    this.table.replaceChildren(...state.pins.map((pin, i) => this.card(state, pin, i)));
    if (focus !== undefined) this.table.querySelector<HTMLElement>(`[data-key="${focus}"]`)?.focus();
  }

  private card(state: Readonly<AppState>, pin: Place, i: number): HTMLElement {
    const say = placeWords().compare;
    const request = requestOf(state, pin);
    const answer = this.answers.get(JSON.stringify(request)) ?? null;
    const name = placeName(pin, state.places);
    const go = make("button", "compare-name", name) as HTMLButtonElement;
    const drop = make("button", "compare-drop", "×") as HTMLButtonElement;
    for (const button of [go, drop]) button.type = "button";
    go.dataset.key = `go-${i}`;
    drop.dataset.key = `drop-${i}`;
    go.addEventListener("click", () => this.goTo(pin));
    if (state.place !== null && isSamePlace(pin, state.place)) go.setAttribute("aria-current", "location");
    drop.setAttribute("aria-label", say.drop(name));
    drop.addEventListener("click", () => {
      this.button.focus();
      this.store.set({ pins: this.store.state.pins.filter((other) => other !== pin) });
    });
    const head = make("div", "compare-head", go, drop);
    if (request === null) return make("li", "", head, make("p", "", words().top.notCovered));
    return make("li", "", head, this.picture(state, pin, request, name), ...this.below(state, pin, answer));
  }

  /** Numbers and the low sky. */
  private below(state: Readonly<AppState>, pin: Place, answer: SkyAnswer | null): HTMLElement[] {
    const clean = this.clean.get(JSON.stringify(lowSkyRequestOf(state, pin))) ?? null;
    return [numbersOf(answer), ...(clean === null ? [] : [lowSky(clean)])];
  }

  /** The picture of a pinned place; without a source until it is known what the eye is adapted to. */
  private picture(
    state: Readonly<AppState>,
    pin: Place,
    request: NonNullable<ReturnType<typeof requestOf>>,
    name: string,
  ): HTMLImageElement {
    const key = JSON.stringify(coordinatesOf(pin));
    const image = this.pictures.get(key) ?? document.createElement("img");
    this.pictures.set(key, image);
    image.alt = placeWords().compare.skyOver(name);
    image.width = PICTURE_WIDTH_PX;
    image.height = PICTURE_WIDTH_PX / 2;
    const { panorama } = state;
    if (panorama === null || state.isBusy) return image;
    // All in one projection: skies are compared by their directions.
    const look: AppState = { ...state, projection: "equirectangular" };
    // And by one eye: it is adapted to the sky that is shown, unless it is kept as it was.
    const eye = state.colours === "eye" ? { adaptation: +adaptationOf(panorama, state, landCdM2Of(state)).toPrecision(3) } : {};
    const url = pictureUrl(request.scene, request.parameters, look, { width: PICTURE_WIDTH_PX, legend: "off", ...eye });
    // Setting the same source again would ask for it again.
    if (image.src !== url) image.src = url;
    return image;
  }
}

function lowSky(clean: readonly (readonly number[])[]): HTMLElement {
  const say = placeWords().darker;
  return make("p", "compare-horizon", clean.length === 0 ? say.notClean : say.clean(directionWords(clean)));
}

function numbersOf(answer: SkyAnswer | null): HTMLElement {
  const say = placeWords();
  const { sky } = answer ?? {};
  const number = (title: string, value: string | null) =>
    make("div", "", make("dt", "", title), make("dd", "", sky === undefined ? "…" : (value ?? "–")));
  const limit = sky?.naked_eye_limit_mag;
  return make(
    "dl",
    "compare-numbers",
    number("mag/arcsec²", magnitude(sky?.zenith_total_brightness_mag_arcsec2 ?? null)),
    number(say.compare.bortle, sky?.bortle_class == null ? null : String(sky.bortle_class)),
    number(say.numbers.faintestStars, limit == null ? null : fixed(limit, 1)),
    number(say.compare.artificial, sky === undefined ? null : `${ratio(sky.ratio_to_natural)} ×`),
  );
}
