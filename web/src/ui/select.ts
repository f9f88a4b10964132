// Choices in a list.

import { words } from "../language/words.ts";

/** Offers these, and the chosen one though it is none of them. */
export function fillSelect(select: HTMLSelectElement, options: readonly (readonly [string, string])[], value: string): void {
  const isKnown = options.some(([name]) => name === value);
  const all = isKnown || value === "" ? options : [...options, [value, words().assumptions.own(value)] as const];
  select.replaceChildren(...all.map(([name, title]) => new Option(title, name, false, name === value)));
}

/** A choice that is there only where a part of the sky is marked. */
export function setRegionOption(select: HTMLSelectElement, isMarked: boolean): void {
  const option = [...select.options].find(({ value }) => value === "region");
  if (option === undefined) return;
  option.disabled = !isMarked;
  option.hidden = !isMarked;
  if (!isMarked && select.value === "region") select.selectedIndex = 0;
}
