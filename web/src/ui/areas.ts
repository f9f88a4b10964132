// Whose light it is by the areas of a file that somebody chose: a table, and a file of it.

import { api } from "../api/client.ts";
import type { AreaShares } from "../api/types.ts";
import { areasFromText } from "../data/areas.ts";
import { placeWords } from "../language/words.ts";
import { areaSharesQuery, sceneOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, make, saveFile } from "./dom.ts";
import { percent } from "./format.ts";
import { fillSelect } from "./select.ts";

export function mountAreas(store: AppStore): void {
  const file = byId("areas-file", HTMLInputElement);
  const answer = byId("areas-answer", HTMLElement);
  const nameField = byId("areas-name", HTMLSelectElement);
  file.addEventListener("change", () => void choose(store, file).catch((reason: unknown) => store.report(reason)));
  nameField.addEventListener("change", () => {
    const { areas } = store.state;
    if (areas !== null) store.set({ areas: { ...areas, nameField: nameField.value === "" ? null : nameField.value } });
  });
  store.watch(["areas"], ({ areas }) => {
    byId("areas-name-field", HTMLElement).hidden = areas === null || areas.fields.length < 2;
    // One that is forgotten can be chosen again.
    if (areas === null) file.value = "";
    if (areas === null) return;
    const usual = ["", placeWords().shares.usualName] as const;
    fillSelect(nameField, [usual, ...areas.fields.map((name) => [name, name] as const)], areas.nameField ?? "");
  });
  store.watch(["areaShares"], ({ areaShares }) => {
    answer.replaceChildren(...(areaShares === null ? [] : areaTable(store, areaShares, file)));
  });
}

async function choose(store: AppStore, input: HTMLInputElement): Promise<void> {
  const [file] = input.files ?? [];
  if (file === undefined) return;
  const areas = areasFromText(file.name, await file.text());
  if (areas === null) store.report(new Error(placeWords().shares.noGeojson(file.name)));
  else store.set({ areas, problem: null });
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
  const blob = await api.areaSharesFile(
    scene.id,
    areaSharesQuery(store.state, place, areas),
    areas.body,
    new AbortController().signal,
  );
  saveFile(blob, `${areas.fileName.replace(/\.[^.]*$/, "")}-shares.csv`);
}
