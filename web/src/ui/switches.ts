// Switches that are no part of a link: red light, the enlarged sky and the language.

import { LANGUAGES, switchLanguage, words } from "../language/words.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId } from "./dom.ts";
import { loadSetting, saveSetting } from "./storage.ts";

const RED_LIGHT_KEY = "skyglow.red-light";

function wireToggle(id: string, on: boolean, changed: (on: boolean) => void): void {
  const button = byId(id, HTMLButtonElement);
  const set = (value: boolean) => {
    button.setAttribute("aria-pressed", String(value));
    changed(value);
  };
  button.addEventListener("click", () => set(button.getAttribute("aria-pressed") !== "true"));
  if (on) set(true);
}

function wireLanguage(): void {
  const select = byId("language", HTMLSelectElement);
  const options = Object.entries(LANGUAGES).map(([code, { name }]) => Object.assign(new Option(name, code), { lang: code }));
  select.replaceChildren(...options);
  select.value = words().locale;
  select.addEventListener("change", () => switchLanguage(select.value));
}

/** Narrower than this, the panel of layers would hide the map. */
const NARROW = "(max-width: 1099px)";

export function mountSwitches(store: AppStore, resized: () => void): void {
  byId("layers", HTMLDetailsElement).open = !matchMedia(NARROW).matches;
  wireToggle("red-light", loadSetting(RED_LIGHT_KEY) === "on", (on) => {
    document.documentElement.classList.toggle("red-light", on);
    saveSetting(RED_LIGHT_KEY, on ? "on" : "off");
  });
  wireToggle("enlarge", false, (on) => {
    document.body.classList.toggle("enlarged", on);
    byId("enlarge", HTMLButtonElement).textContent = on ? words().sky.showMap : words().sky.enlarge;
    resized();
  });
  const leaveByEscape = ({ key }: KeyboardEvent) => {
    const { isDrawing, pointed } = store.state;
    // Escape first ends what is under way in the sky or in the search box.
    const isNeeded = isDrawing || pointed !== null || document.activeElement?.getAttribute("aria-expanded") === "true";
    const isEnlarged = document.body.classList.contains("enlarged");
    if (key === "Escape" && isEnlarged && !isNeeded) byId("enlarge", HTMLButtonElement).click();
  };
  addEventListener("keydown", leaveByEscape, { capture: true });
  wireLanguage();
}
