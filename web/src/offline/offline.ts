// Without a network: the worker that keeps what was seen, and the page that says so.

import { words } from "../language/words.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, make } from "../ui/dom.ts";
import { placeName } from "../ui/nearby.ts";
import { loadSetting, saveSetting } from "../ui/storage.ts";

const PLACES_KEY = "skyglow.last-places";
const MAX_PLACES = 5;

interface LastPlace {
  name: string;
  /** The fragment of its link. */
  link: string;
}

function lastPlaces(): LastPlace[] {
  try {
    const read: unknown = JSON.parse(loadSetting(PLACES_KEY) ?? "[]");
    if (!Array.isArray(read)) return [];
    return read.filter((place): place is LastPlace => typeof place?.name === "string" && /^#/.test(place?.link));
  } catch {
    return [];
  }
}

/** Registers the worker, and names it the files that came before it. Without HTTPS there is none. */
export async function startWorker(): Promise<void> {
  if (!("serviceWorker" in navigator)) return;
  await navigator.serviceWorker.register("./offline.js");
  const { active } = await navigator.serviceWorker.ready;
  active?.postMessage({ urls: performance.getEntriesByType("resource").map(({ name }) => name) });
}

/** Says that answers are kept ones and of when, and leads to the places that are kept. */
export function mountOffline(store: AppStore): void {
  const container = byId("stored", HTMLElement);
  store.watch(["skyStage", "place", "places"], ({ skyStage, place, places, storedAtMs }) => {
    if (skyStage !== "picture" || place === null || storedAtMs !== null) return;
    const name = placeName(place, places);
    const others = lastPlaces().filter((other) => other.name !== name);
    saveSetting(PLACES_KEY, JSON.stringify([{ name, link: location.hash }, ...others].slice(0, MAX_PLACES)));
  });
  store.watch(["storedAtMs", "place"], ({ storedAtMs, place }) => {
    container.hidden = storedAtMs === null;
    if (storedAtMs === null) return;
    const say = words().offline;
    const when = new Date(storedAtMs).toLocaleString(words().locale, { dateStyle: "medium", timeStyle: "short" });
    const again = make("button", "quiet", say.again) as HTMLButtonElement;
    again.type = "button";
    again.addEventListener("click", () => location.reload());
    const links = lastPlaces().map(({ name, link }) => {
      const anchor = make("a", "", name) as HTMLAnchorElement;
      anchor.href = link;
      // The page as it is waits for the server; one that begins anew asks the worker.
      anchor.addEventListener("click", (event) => {
        event.preventDefault();
        // Without a change of the hash, which this page would take up: a link without a time would become one of tonight.
        history.pushState(null, "", link);
        location.reload();
      });
      return make("li", "", anchor);
    });
    const known = place !== null || links.length === 0 ? [] : [make("p", "", say.places), make("ul", "", ...links)];
    container.replaceChildren(make("p", "", say.stored(when)), ...known, again);
  });
}
