// Whose light the sky is: towns by their shares, and the areas of a file that somebody chose.

import { api } from "../api/client.ts";
import type { AreaShares, NamedPlace, PlaceShare, Shares } from "../api/types.ts";
import { placeWords } from "../language/words.ts";
import { compassName } from "../sky/projection.ts";
import { sceneOf, sharesQuery } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, make, saveFile } from "./dom.ts";
import { percent, whole } from "./format.ts";

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

/** `goTo` moves the map so that a town is in view. */
export function mountShares(store: AppStore, goTo: (town: NamedPlace) => void): void {
  const section = byId("shares", HTMLElement);
  const title = byId("shares-title", HTMLElement);
  const waiting = byId("shares-waiting", HTMLElement);
  const list = byId("shares-list", HTMLElement);
  store.watch(["shares", "isSharing", "skyStage"], ({ shares, isSharing, region, skyStage }) => {
    section.hidden = shares === null && !isSharing && skyStage !== "picture";
    title.textContent = region === null ? placeWords().shares.overhead : placeWords().shares.inMarked;
    waiting.textContent = isSharing && shares === null ? placeWords().shares.waiting : "";
    section.setAttribute("aria-busy", String(isSharing));
  });
  store.watch(["shares"], ({ shares }) => list.replaceChildren(...(shares === null ? [] : townRows(store, shares, goTo))));
  mountAreas(store);
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
    [say.others(whole(others.count)), others.share],
    [placeWords().plan.far, elsewhere],
  ];
  const restRows = rest
    .filter(([, share]) => share > 0)
    .map(([name, share]) => make("li", "rest", make("span", "", name), make("b", "", percent(share)), bar(share)));
  return [...rows, ...restRows];
}

function mountAreas(store: AppStore): void {
  const file = byId("areas-file", HTMLInputElement);
  const answer = byId("areas-answer", HTMLElement);
  file.addEventListener("change", () => void choose(store, file));
  store.watch(["areaShares"], ({ areaShares }) => {
    answer.replaceChildren(...(areaShares === null ? [] : areaTable(store, areaShares, file)));
  });
}

async function choose(store: AppStore, input: HTMLInputElement): Promise<void> {
  const [file] = input.files ?? [];
  if (file === undefined) return;
  try {
    const body = JSON.parse(await file.text()) as Record<string, unknown>;
    // The server takes a collection; a file may hold one feature or a bare outline.
    const feature = body.type === "Feature" ? body : { type: "Feature", properties: {}, geometry: body };
    const areas = body.type === "FeatureCollection" ? body : { type: "FeatureCollection", features: [feature] };
    store.set({ areas: { fileName: file.name, body: areas }, problem: null });
  } catch {
    store.report(new Error(placeWords().shares.noGeojson(file.name)));
  }
}

function areaTable(store: AppStore, { areas, outside }: AreaShares, file: HTMLInputElement): HTMLElement[] {
  const say = placeWords().shares;
  const line = (name: string, share: number) => {
    const header = make("th", "", name);
    header.setAttribute("scope", "row");
    return make("tr", "", header, make("td", "", percent(share)));
  };
  const caption = make("caption", "", say.areasOf(store.state.areas?.fileName ?? ""));
  const body = make("tbody", "", ...areas.map(({ name, share }) => line(name, share)));
  const frame = make("div", "area-table", make("table", "", caption, body, make("tfoot", "", line(say.outside, outside.share))));
  // Long tables scroll, by keyboard too.
  frame.tabIndex = 0;
  frame.setAttribute("role", "region");
  frame.setAttribute("aria-label", caption.textContent ?? "");
  const save = make("button", "quiet", say.save) as HTMLButtonElement;
  const forget = make("button", "quiet", say.forget) as HTMLButtonElement;
  for (const button of [save, forget]) button.type = "button";
  save.addEventListener("click", () => void saveAreas(store).catch((reason: unknown) => store.report(reason)));
  forget.addEventListener("click", () => {
    file.value = "";
    store.set({ areas: null, areaShares: null });
    file.focus();
  });
  return [frame, make("div", "buttons", save, forget)];
}

async function saveAreas(store: AppStore): Promise<void> {
  const { areas, place } = store.state;
  const scene = sceneOf(store.state);
  if (areas === null || place === null || scene === null) return;
  const blob = await api.areaSharesFile(scene.id, sharesQuery(store.state, place), areas.body, new AbortController().signal);
  saveFile(blob, `${areas.fileName.replace(/\.[^.]*$/, "")}-shares.csv`);
}
