// A line of a list of numbers.

import { make } from "./dom.ts";

/** `key` is for scripts and tests. */
export function row(name: string, value: string, unit: string, key: string, note = ""): HTMLElement {
  const shown = make("dd", "", make("b", "", value), unit === "" ? "" : ` ${unit}`);
  shown.dataset.value = key;
  if (note !== "") shown.append(make("small", "", note));
  return make("div", "number-row", make("dt", "", name), shown);
}
