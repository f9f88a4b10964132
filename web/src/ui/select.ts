// Choices in a list.

import { words } from "../language/words.ts";

export type Choice = readonly [name: string, title: string];

/** Choices below a title of their own; an empty title is none. */
export interface ChoiceGroup {
  title: string;
  choices: readonly Choice[];
}

function optionElement([name, title]: Choice, value: string): HTMLOptionElement {
  return new Option(title, name, false, name === value);
}

/** Offers these, and the chosen one though it is none of them. */
export function fillSelect(select: HTMLSelectElement, options: readonly Choice[], value: string): void {
  fillGroups(select, [{ title: "", choices: options }], value, words().assumptions.own);
}

/** The same of choices in groups; `own` is the title of what is none of them. */
export function fillGroups(
  select: HTMLSelectElement,
  groups: readonly ChoiceGroup[],
  value: string,
  own: (value: string) => string,
): void {
  const isKnown = value === "" || groups.some(({ choices }) => choices.some(([name]) => name === value));
  const all = isKnown ? groups : [...groups, { title: "", choices: [[value, own(value)] as const] }];
  const elements = all.flatMap(({ title, choices }): HTMLElement[] => {
    const options = choices.map((choice) => optionElement(choice, value));
    if (title === "") return options;
    const group = document.createElement("optgroup");
    group.label = title;
    group.append(...options);
    return [group];
  });
  select.replaceChildren(...elements);
}

/** A choice that is there only where a part of the sky is marked. */
export function setRegionOption(select: HTMLSelectElement, isMarked: boolean): void {
  const option = [...select.options].find(({ value }) => value === "region");
  if (option === undefined) return;
  option.disabled = !isMarked;
  option.hidden = !isMarked;
  if (!isMarked && select.value === "region") select.selectedIndex = 0;
}
