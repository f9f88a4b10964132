// Whose light the sky is: towns by their shares.

import type { NamedPlace, PlaceShare, Shares } from "../api/types.ts";
import { placeWords } from "../language/words.ts";
import { compassName } from "../sky/projection.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, make } from "./dom.ts";
import { percent, whole } from "./format.ts";
import { wireGroup } from "./group.ts";

const MAX_ROWS = 5;
/** Towns with less are among the others. */
const MIN_SHARE = 0.005;
/** Nearer than this, a town is all around. */
const HERE_M = 1500;

/** The towns that are named, and what the others have together. */
export function listedTowns(
  { places, other_places, other_places_count, elsewhere }: Shares,
  maxRows = MAX_ROWS,
): {
  named: PlaceShare[];
  others: { count: number; share: number };
  elsewhere: number;
} {
  const named = places.filter(({ share }, i) => i < maxRows && share >= MIN_SHARE);
  const unnamed = places.slice(named.length);
  const share = unnamed.reduce((sum, town) => sum + town.share, other_places.share);
  return { named, others: { count: unnamed.length + other_places_count, share }, elsewhere: elsewhere.share };
}

/** What the towns that are not named are called, which are others only below named ones. */
export function othersTitle(count: number, isBelowNamed: boolean): string {
  const { others, other, towns, town } = placeWords().shares;
  if (count === 1) return isBelowNamed ? other : town;
  return isBelowNamed ? others(whole(count)) : towns(whole(count));
}

/** `goTo` moves the map so that a town is in view. */
export function mountShares(store: AppStore, goTo: (town: NamedPlace) => void): void {
  const section = byId("shares", HTMLElement);
  const title = byId("shares-title", HTMLElement);
  const waiting = byId("shares-waiting", HTMLElement);
  const list = byId("shares-list", HTMLElement);
  const of = byId("shares-of", HTMLElement);
  const press = wireGroup<"zenith" | "ground">("shares-of", (chosen) => store.set({ isOnGround: chosen === "ground" }));
  store.watch(["isOnGround"], ({ isOnGround }) => press(isOnGround ? "ground" : "zenith"));
  store.watch(["shares", "isSharing", "skyStage", "region"], ({ shares, isSharing, region, skyStage }) => {
    section.hidden = shares === null && !isSharing && skyStage !== "picture";
    of.hidden = region !== null;
    title.textContent = region === null ? placeWords().shares.title : placeWords().shares.inMarked;
    waiting.textContent = isSharing && shares === null ? placeWords().shares.waiting : "";
    section.setAttribute("aria-busy", String(isSharing));
  });
  store.watch(["shares"], ({ shares }) => list.replaceChildren(...(shares === null ? [] : townRows(store, shares, goTo))));
}

/** Where a town is, from the place. */
export function whereabouts({ distance_m, azimuth_deg }: PlaceShare): string {
  const say = placeWords().shares;
  if (distance_m < HERE_M) return say.here;
  return say.away(whole(Math.round(distance_m / 1000)), compassName(azimuth_deg));
}

function bar(share: number): HTMLElement {
  const shown = make("i", "");
  shown.style.width = `${100 * Math.min(share, 1)}%`;
  return shown;
}

function townRows(store: AppStore, shares: Shares, goTo: (town: NamedPlace) => void): HTMLElement[] {
  const say = placeWords().shares;
  if (!(shares.total > 0)) return [make("li", "", say.none)];
  const { named, others, elsewhere } = listedTowns(shares);
  const rows = named.map((town) => {
    const name = make("span", "", town.name, make("small", "", whereabouts(town)));
    const button = make("button", "", name, make("b", "", percent(town.share)), bar(town.share)) as HTMLButtonElement;
    button.type = "button";
    button.title = say.show;
    const show = (isShown: boolean) => () => store.set({ shownTown: isShown ? town : null });
    for (const event of ["pointerenter", "focus"]) button.addEventListener(event, show(true));
    for (const event of ["pointerleave", "blur"]) button.addEventListener(event, show(false));
    button.addEventListener("click", () => goTo(town));
    return make("li", "", button);
  });
  const rest: [string, number][] = [
    [othersTitle(others.count, named.length > 0), others.share],
    [placeWords().plan.far, elsewhere],
  ];
  const restRows = rest
    .filter(([, share]) => share > 0)
    .map(([name, share]) => make("li", "rest", make("span", "", name), make("b", "", percent(share)), bar(share)));
  return [...rows, ...restRows];
}
