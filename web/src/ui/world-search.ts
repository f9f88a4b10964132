// Places of the whole world by name: asked for when typing rests, and added below what the scenes have.

import { api } from "../api/client.ts";
import type { FoundPlace, NamedPlace, Scene } from "../api/types.ts";
import { words } from "../language/words.ts";
import { sceneFor } from "../state/app-state.ts";
import { debounced } from "./dom.ts";

const WAIT_MS = 180;
const MIN_LETTERS = 2;
const MAX_LETTERS = 100;
/** Places that no scene has stand below those that one has, and are few. */
const MAX_UNCOVERED = 3;
/** Two finds nearer than this, degrees, are one place under two names. */
const SAME_PLACE_DEG = 0.05;

/** A find in the list. */
export interface SearchResult {
  title: string;
  detail: string;
  place: NamedPlace;
  /** Whether a scene of this server has it. */
  isCovered: boolean;
}

/** The name of a country in the language of the page. */
function countryName(code: string): string {
  try {
    return new Intl.DisplayNames(words().locale, { type: "region" }).of(code) ?? code;
  } catch {
    return code;
  }
}

/** What of the world's places is not listed yet, and which scene each lies in. */
export function worldResults(
  found: readonly FoundPlace[],
  listed: readonly NamedPlace[],
  scenes: readonly Scene[],
  shown: string | null,
): SearchResult[] {
  const isNear = (a: NamedPlace, b: NamedPlace) =>
    Math.abs(a.latitude_deg - b.latitude_deg) < SAME_PLACE_DEG && Math.abs(a.longitude_deg - b.longitude_deg) < SAME_PLACE_DEG;
  const results = found
    .filter((place) => !listed.some((other) => isNear(place, other)))
    .map((place) => {
      // The page goes to the newest of several scenes that have it.
      const scene = scenes.some(({ id }) => id === place.scene) ? sceneFor({ scenes, scene: shown }, place) : null;
      const where = scene === null ? words().top.notCovered : scene.id === shown ? "" : scene.title;
      const detail = [countryName(place.country), where].filter((part) => part !== "").join(" · ");
      return { title: place.name, detail, place, isCovered: scene !== null };
    });
  const covered = results.filter(({ isCovered }) => isCovered);
  return [...covered, ...results.filter(({ isCovered }) => !isCovered).slice(0, MAX_UNCOVERED)];
}

export class WorldSearch {
  private request = new AbortController();
  /** The text that is waited for; a list that is drawn again does not ask again. */
  private awaited: string | null = null;
  private found: { text: string; places: FoundPlace[] } = { text: "", places: [] };
  private readonly askSoon = debounced(WAIT_MS, (text: string) => void this.ask(text));

  /** `changed` is called when an answer is there. */
  constructor(private readonly changed: () => void) {}

  /** What is known of a text; null while it is asked for. */
  places(text: string): readonly FoundPlace[] | null {
    const name = text.trim();
    if (name.length < MIN_LETTERS || name.length > MAX_LETTERS) {
      this.stop();
      return [];
    }
    if (this.found.text === name) return this.found.places;
    if (this.awaited === name) return null;
    this.request.abort();
    this.awaited = name;
    this.askSoon(name);
    return null;
  }

  stop(): void {
    this.awaited = null;
    this.askSoon.cancel();
    this.request.abort();
  }

  private async ask(text: string): Promise<void> {
    this.request = new AbortController();
    const { signal } = this.request;
    // Without an answer the scenes' own places are there all the same.
    const places = await api.worldPlaces(text, signal).catch((): FoundPlace[] => []);
    if (signal.aborted) return;
    this.awaited = null;
    this.found = { text, places };
    this.changed();
  }
}
