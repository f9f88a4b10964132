// The button that marks a part of the sky by a curve around it.

import { by_id } from "./dom.ts";

export interface MarkingEvents {
  /** Drawing begins or ends. */
  draw: (on: boolean) => void;
  unmark: () => void;
}

const HINT =
  "Draw around a part of the sky, and the map shows the lights that cause it. By keyboard: arrows move the cross, Enter sets a corner, Enter twice closes the curve, Escape ends.";

/** A choice that is there only where a part of the sky is marked. */
export function set_region_option(select: HTMLSelectElement, marked: boolean): void {
  const option = [...select.options].find(({ value }) => value === "region");
  if (option === undefined) return;
  option.disabled = !marked;
  option.hidden = !marked;
  if (!marked && select.value === "region") select.selectedIndex = 0;
}

export class Marking {
  private readonly button = by_id("mark", HTMLButtonElement);
  private readonly hint = by_id("mark-hint", HTMLElement);
  private drawing = false;
  private marked = false;

  constructor(events: MarkingEvents) {
    this.button.addEventListener("click", () => {
      if (this.marked && !this.drawing) {
        events.unmark();
        return;
      }
      this.drawing = !this.drawing;
      this.update();
      events.draw(this.drawing);
    });
    this.update();
  }

  show(marked: boolean): void {
    this.marked = marked;
    this.update();
  }

  /** Drawing has ended. */
  ended(): void {
    this.drawing = false;
    this.update();
  }

  private update(): void {
    this.button.setAttribute("aria-pressed", String(this.drawing));
    this.button.textContent = this.drawing ? "Stop marking" : this.marked ? "Unmark" : "Mark a part";
    this.hint.textContent = this.drawing ? HINT : "";
  }
}
