// The search box: the scene's places by name, or coordinates. A combobox with a list, by the ARIA pattern.

import type { NamedPlace } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { AppStore } from "../state/app-store.ts";
import type { Place } from "../state/view-state.ts";
import { byId, make } from "./dom.ts";
import { cardinalNames, coordinates, whole } from "./format.ts";

const MAX_RESULTS = 8;

function folded(text: string): string {
  return text
    .normalize("NFD")
    .replace(/\p{Diacritic}/gu, "")
    .toLowerCase();
}

/** `-1.29, 36.82` (latitude first) as a place, or null. Letters are those of the page's language, or English. */
export function placeFromText(text: string): Place | null {
  const [north, east, south, west] = cardinalNames();
  const latitude = `(-?\\d{1,2}(?:\\.\\d+)?)\\s*°?\\s*(${north}|${south}|N|S)?`;
  const longitude = `(-?\\d{1,3}(?:\\.\\d+)?)\\s*°?\\s*(${east}|${west}|E|W)?`;
  const match = new RegExp(`^\\s*${latitude}\\s*[,;\\s]\\s*${longitude}\\s*$`, "i").exec(text);
  if (match === null) return null;
  const latitudeDeg = Number(match[1]) * sign(match[2], [south, "S"]);
  const longitudeDeg = Number(match[3]) * sign(match[4], [west, "W"]);
  return Math.abs(latitudeDeg) <= 90 && Math.abs(longitudeDeg) <= 180
    ? { latitude_deg: latitudeDeg, longitude_deg: longitudeDeg }
    : null;
}

function sign(letter: string | undefined, negative: readonly string[]): number {
  return letter !== undefined && negative.includes(letter.toUpperCase()) ? -1 : 1;
}

/** Places whose name has the text in it; names that begin with it first, then the larger ones. */
export function matchingPlaces(places: readonly NamedPlace[], text: string): NamedPlace[] {
  const query = folded(text.trim());
  if (query === "") return [];
  return places
    .map((place) => ({ place, at: folded(place.name).indexOf(query) }))
    .filter(({ at }) => at >= 0)
    .sort((a, b) => Number(a.at > 0) - Number(b.at > 0) || (b.place.population ?? 0) - (a.place.population ?? 0))
    .slice(0, MAX_RESULTS)
    .map(({ place }) => place);
}

export class Search {
  private readonly input = byId("search", HTMLInputElement);
  private readonly list = byId("search-list", HTMLElement);
  private results: { title: string; detail: string; place: Place }[] = [];
  private active = -1;

  constructor(
    private readonly store: AppStore,
    private readonly chosen: (place: Place) => void,
  ) {
    const { input } = this;
    input.addEventListener("input", () => this.lookUp());
    input.addEventListener("focus", () => this.lookUp());
    input.addEventListener("blur", () => this.close());
    input.addEventListener("keydown", (event) => this.keyPressed(event));
  }

  private lookUp(): void {
    const at = placeFromText(this.input.value);
    this.results =
      at !== null
        ? [{ title: coordinates(at.latitude_deg, at.longitude_deg), detail: words().top.coordinates, place: at }]
        : matchingPlaces(this.store.state.places, this.input.value).map((place) => ({
            title: place.name,
            detail: place.population ? whole(place.population) : "",
            place,
          }));
    this.active = this.results.length > 0 ? 0 : -1;
    this.render();
  }

  private render(): void {
    const isEmpty = this.results.length === 0 && this.input.value.trim() !== "";
    this.list.replaceChildren(
      ...this.results.map(({ title, detail }, i) => {
        const option = make("li", i === this.active ? "active" : "", make("span", "", title), make("small", "", detail));
        option.id = `search-option-${i}`;
        option.setAttribute("role", "option");
        option.setAttribute("aria-selected", String(i === this.active));
        // The press would take the focus from the input, and its blur closes the list before the click.
        option.addEventListener("pointerdown", (event) => event.preventDefault());
        option.addEventListener("click", () => this.choose(i));
        return option;
      }),
      ...(isEmpty ? [make("li", "nothing", words().top.nothingFound)] : []),
    );
    this.list.hidden = this.results.length === 0 && !isEmpty;
    this.input.setAttribute("aria-expanded", String(!this.list.hidden));
    if (this.active >= 0) this.input.setAttribute("aria-activedescendant", `search-option-${this.active}`);
    else this.input.removeAttribute("aria-activedescendant");
  }

  private close(): void {
    this.results = [];
    this.list.hidden = true;
    this.input.setAttribute("aria-expanded", "false");
  }

  private choose(i: number): void {
    const result = this.results[i];
    if (result === undefined) return;
    this.input.value = result.title;
    this.close();
    this.input.blur();
    this.chosen({ latitude_deg: result.place.latitude_deg, longitude_deg: result.place.longitude_deg });
  }

  private keyPressed(event: KeyboardEvent): void {
    if (event.key === "Escape") this.close();
    else if (event.key === "Enter") this.choose(this.active);
    else if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      const step = event.key === "ArrowDown" ? 1 : -1;
      if (this.results.length > 0) this.active = (this.active + step + this.results.length) % this.results.length;
      this.render();
    } else return;
    event.preventDefault();
  }
}
