// Switches that are no part of a link: red light and the enlarged sky.

import { by_id } from "./dom.ts";

const RED_LIGHT_KEY = "skyglow.red-light";

function stored(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null; // Storage may be forbidden; the switch then lasts as long as the page.
  }
}

function store(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    // As above.
  }
}

function wire_toggle(id: string, on: boolean, changed: (on: boolean) => void): void {
  const button = by_id(id, HTMLButtonElement);
  const set = (value: boolean) => {
    button.setAttribute("aria-pressed", String(value));
    changed(value);
  };
  button.addEventListener("click", () => set(button.getAttribute("aria-pressed") !== "true"));
  if (on) set(true);
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
    by_id("enlarge", HTMLButtonElement).textContent = on ? "Show the map" : "Enlarge";
    resized();
  });
}
