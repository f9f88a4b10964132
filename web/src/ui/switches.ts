// Switches that are no part of a link: red light, the enlarged sky and the language.

import { LANGUAGES, switch_language, words } from "../language/words.ts";
import { by_id } from "./dom.ts";
import { store, stored } from "./storage.ts";

const RED_LIGHT_KEY = "skyglow.red-light";

function wire_toggle(id: string, on: boolean, changed: (on: boolean) => void): void {
  const button = by_id(id, HTMLButtonElement);
  const set = (value: boolean) => {
    button.setAttribute("aria-pressed", String(value));
    changed(value);
  };
  button.addEventListener("click", () => set(button.getAttribute("aria-pressed") !== "true"));
  if (on) set(true);
}

function wire_language(): void {
  const select = by_id("language", HTMLSelectElement);
  const options = Object.entries(LANGUAGES).map(([code, { name }]) => Object.assign(new Option(name, code), { lang: code }));
  select.replaceChildren(...options);
  select.value = words().locale;
  select.addEventListener("change", () => switch_language(select.value));
}

/** Narrower than this, the panel of layers would hide the map. */
const NARROW = "(max-width: 860px)";

export function wire_switches(resized: () => void): void {
  by_id("layers", HTMLDetailsElement).open = !matchMedia(NARROW).matches;
  wire_toggle("red-light", stored(RED_LIGHT_KEY) === "on", (on) => {
    document.documentElement.classList.toggle("red-light", on);
    store(RED_LIGHT_KEY, on ? "on" : "off");
  });
  wire_toggle("enlarge", false, (on) => {
    document.body.classList.toggle("enlarged", on);
    by_id("enlarge", HTMLButtonElement).textContent = on ? words().sky.show_map : words().sky.enlarge;
    resized();
  });
  wire_language();
}
