// A button group of which exactly one is pressed; arrow keys move as in radio groups.

import { byId } from "./dom.ts";

/** Returns what presses a button without telling that it was chosen. */
export function wireGroup<T extends string>(id: string, chosen: (value: T) => void): (value: T) => void {
  const group = byId(id, HTMLElement);
  const buttons = [...group.querySelectorAll("button")];
  const press = (value: string) => {
    for (const button of buttons) {
      const on = button.value === value;
      button.setAttribute("aria-checked", String(on));
      button.tabIndex = on ? 0 : -1;
    }
  };
  buttons.forEach((button, i) => {
    button.addEventListener("click", () => {
      press(button.value);
      chosen(button.value as T);
    });
    button.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      const next = step === undefined ? undefined : buttons[(i + step + buttons.length) % buttons.length];
      if (next === undefined) return;
      event.preventDefault();
      next.focus();
      next.click();
    });
  });
  return press;
}
