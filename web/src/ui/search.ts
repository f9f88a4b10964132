// The search box: places of all scenes by name, or coordinates. A combobox with a list, by the ARIA pattern.

import { api } from "../api/client.ts";
import type { NamedPlace } from "../api/types.ts";
import { words } from "../language/words.ts";
import { type AppState, sceneFor } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import type { Place } from "../state/view-state.ts";
import { placeFromText } from "./coordinates.ts";
import { byId, make } from "./dom.ts";
import { coordinates, whole } from "./format.ts";
import { type SearchResult, WorldSearch, worldResults } from "./world-search.ts";

const MAX_RESULTS = 8;
/** With those of the world below them. */
const MAX_OWN_RESULTS = 6;
const MAX_ALL_RESULTS = 10;

function folded(text: string): string {
  return text
    .normalize("NFD")
    .replace(/\p{Diacritic}/gu, "")
    .toLowerCase();
}

/** Scenes whose places are asked for besides those of the scene that is shown. */
const MAX_SCENES = 30;
/** Two places of one name nearer than this, degrees, are one, which two scenes have. */
const SAME_PLACE_DEG = 0.05;

/** A place, and the scene that has it where that is not the one that is shown. */
export interface SearchedPlace extends NamedPlace {
  sceneTitle?: string;
}

/** Places whose name has the text in it; names that begin with it first, then the larger ones. */
export function matchingPlaces<P extends NamedPlace>(places: readonly P[], text: string): P[] {
  const query = folded(text.trim());
  if (query === "") return [];
  return places
    .map((place) => ({ place, at: folded(place.name).indexOf(query) }))
    .filter(({ at }) => at >= 0)
    .sort((a, b) => Number(a.at > 0) - Number(b.at > 0) || (b.place.population ?? 0) - (a.place.population ?? 0))
    .slice(0, MAX_RESULTS)
    .map(({ place }) => place);
}

/** Places of other scenes, each once, under the scene that it is shown in: several may have it. */
export function searchedPlaces(places: readonly NamedPlace[], state: Pick<AppState, "scenes" | "scene">): SearchedPlace[] {
  const once = new Map(
    places.map((place) => [`${place.name} ${place.latitude_deg.toFixed(2)} ${place.longitude_deg.toFixed(2)}`, place]),
  );
  return [...once.values()].map((place) => {
    const scene = sceneFor(state, place);
    return scene === null || scene.id === state.scene ? place : { ...place, sceneTitle: scene.title };
  });
}

export class Search {
  private readonly input = byId("search", HTMLInputElement);
  private readonly list = byId("search-list", HTMLElement);
  private results: { title: string; detail: string; place: Place; isCovered: boolean }[] = [];
  /** Whether more may come. */
  private isPending = false;
  private active = -1;
  /** Places of other scenes, asked for once someone searches. */
  private others: SearchedPlace[] = [];
  private asked = "";
  private readonly world = new WorldSearch(() => {
    if (document.activeElement === this.input) this.lookUp(this.active);
  });

  constructor(
    private readonly store: AppStore,
    private readonly chosen: (place: Place) => void,
  ) {
    const { input } = this;
    input.addEventListener("input", () => this.lookUp());
    input.addEventListener("focus", () => {
      this.lookUp();
      void this.loadOthers();
    });
    input.addEventListener("blur", () => this.close());
    input.addEventListener("keydown", (event) => this.keyPressed(event));
  }

  private lookUp(active = 0): void {
    const at = placeFromText(this.input.value);
    if (at !== null) this.world.stop();
    this.isPending = false;
    this.results =
      at !== null
        ? [{ title: coordinates(at.latitude_deg, at.longitude_deg), detail: words().top.coordinates, place: at, isCovered: true }]
        : this.namedResults(this.input.value);
    // What comes later is added below, and moves nobody's choice.
    this.active = Math.min(Math.max(active, 0), this.results.length - 1);
    this.render();
  }

  private namedResults(text: string): SearchResult[] {
    const { scenes, scene } = this.store.state;
    const own = matchingPlaces(this.allPlaces(), text).slice(0, MAX_OWN_RESULTS);
    const found = this.world.places(text);
    this.isPending = found === null;
    const results = own.map((place) => ({
      title: place.name,
      detail: place.sceneTitle ?? (place.population ? whole(place.population) : ""),
      place,
      isCovered: true,
    }));
    return [...results, ...worldResults(found ?? [], own, scenes, scene)].slice(0, MAX_ALL_RESULTS);
  }

  private allPlaces(): SearchedPlace[] {
    const { places } = this.store.state;
    const isThere = (other: SearchedPlace) =>
      places.some(
        ({ name, latitude_deg, longitude_deg }) =>
          name === other.name &&
          Math.abs(latitude_deg - other.latitude_deg) < SAME_PLACE_DEG &&
          Math.abs(longitude_deg - other.longitude_deg) < SAME_PLACE_DEG,
      );
    return [...places, ...this.others.filter((other) => !isThere(other))];
  }

  private async loadOthers(): Promise<void> {
    const { scenes, scene } = this.store.state;
    const others = scenes.filter(({ id }) => id !== scene).slice(0, MAX_SCENES);
    const asked = JSON.stringify(others.map(({ id, version }) => [id, version]));
    if (asked === this.asked) return;
    this.asked = asked;
    const { signal } = new AbortController();
    // A scene whose places do not come is not searched.
    const found = await Promise.all(others.map(({ id }) => api.places(id, signal).catch((): NamedPlace[] => [])));
    if (this.asked !== asked) return;
    this.others = searchedPlaces(found.flat(), this.store.state);
    if (document.activeElement === this.input) this.lookUp();
  }

  private render(): void {
    const isEmpty = this.results.length === 0 && !this.isPending && this.input.value.trim() !== "";
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
    this.world.stop();
    this.results = [];
    this.list.hidden = true;
    this.input.setAttribute("aria-expanded", "false");
  }

  private choose(i: number): void {
    const result = this.results[i];
    if (result === undefined) return;
    this.input.value = result.title;
    this.close();
    if (!result.isCovered) {
      this.store.report(new Error(words().top.noSceneCovers(result.title)));
      return;
    }
    // On a phone the keyboard goes away; elsewhere who types goes on from here.
    if (matchMedia("(pointer: coarse)").matches) this.input.blur();
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
