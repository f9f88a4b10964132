// Darker places nearby: what each gains, and where its low sky is clean.

import type { DarkerPlace } from "../api/types.ts";
import { isSamePlace, WITHIN_KM } from "../data/darker-session.ts";
import { placeWords, words } from "../language/words.ts";
import { compassName } from "../sky/projection.ts";
import type { AppStore } from "../state/app-store.ts";
import type { Place } from "../state/view-state.ts";
import { byId, make } from "./dom.ts";
import { coordinates, fixed, whole } from "./format.ts";

/** A range this wide goes all around. */
const ALL_AROUND_DEG = 350;
/** Nearer than this to a town, a place is told by its name alone. */
const AT_TOWN_M = 1500;

/** Ranges of azimuth by the names of their ends, such as "NW to E". */
export function directionWords(ranges: readonly (readonly number[])[]): string {
  const say = placeWords().darker;
  const names = ranges.map(([firstDeg = 0, lastDeg = 0]) => {
    if ((lastDeg - firstDeg + 360) % 360 >= ALL_AROUND_DEG || lastDeg - firstDeg >= 360) return say.allAround;
    const [first, last] = [compassName(firstDeg), compassName(lastDeg)];
    return first === last ? first : say.fromTo(first, last);
  });
  return names.join(", ");
}

/** What a darker place is called: by its nearest town. */
export function darkerName({ nearest_place: town, latitude_deg, longitude_deg }: DarkerPlace): string {
  if (town == null) return coordinates(latitude_deg, longitude_deg);
  if (town.distance_m < AT_TOWN_M) return town.name;
  return words().places.beside(Math.round(town.distance_m / 1000), compassName(town.azimuth_deg), town.name);
}

/** `goTo` shows the sky of a place. */
export function mountDarker(store: AppStore, goTo: (place: Place) => void): void {
  const fold = byId("darker", HTMLDetailsElement);
  const list = byId("darker-list", HTMLElement);
  const status = byId("darker-status", HTMLElement);
  const title = byId("darker-title", HTMLElement);
  title.textContent = placeWords().darker.title(whole(WITHIN_KM));
  fold.addEventListener("toggle", () => store.set({ isDarkerOpen: fold.open }));
  store.watch(["isDarkerOpen"], ({ isDarkerOpen }) => {
    fold.open = isDarkerOpen;
  });
  store.watch(["darker", "isDarkerOpen"], ({ darker, isDarkerOpen }) => {
    const say = placeWords().darker;
    fold.setAttribute("aria-busy", String(isDarkerOpen && darker === null));
    if (darker === null) status.textContent = isDarkerOpen ? say.waiting : "";
    else status.textContent = darker.places.length === 0 ? say.none(whole(WITHIN_KM)) : say.lead;
    list.replaceChildren(...(darker?.places ?? []).map((place) => darkerRow(place, goTo)));
  });
  store.watch(["place", "darker"], ({ place, darker }) => {
    [...list.querySelectorAll("button")].forEach((button, i) => {
      const listed = darker?.places[i];
      const isHere = place !== null && listed !== undefined && isSamePlace(place, listed);
      button.setAttribute("aria-current", isHere ? "location" : "false");
    });
  });
}

function darkerRow(place: DarkerPlace, goTo: (place: Place) => void): HTMLElement {
  const say = placeWords().darker;
  const clean = place.low_sky?.clean_directions_deg ?? [];
  const facts = [
    say.away(whole(Math.round(place.distance_m / 1000)), compassName(place.azimuth_deg)),
    clean.length === 0 ? say.notClean : say.clean(directionWords(clean)),
    ...(place.ground === "level" ? [say.level] : []),
  ];
  const gain = place.gain_mag == null ? [] : [make("b", "", say.gain(fixed(place.gain_mag, 1)))];
  const name = make("span", "", darkerName(place), make("small", "", facts.join(" · ")));
  const button = make("button", "", make("i", "darker-mark", whole(place.rank)), name, ...gain) as HTMLButtonElement;
  button.type = "button";
  button.addEventListener("click", () => goTo(place));
  return make("li", "", button);
}
