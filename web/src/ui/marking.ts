// The button that marks a part of the sky by a curve around it.

import { words } from "../language/words.ts";
import { byId } from "./dom.ts";

export interface MarkingEvents {
  /** Drawing begins or ends. */
  draw: (on: boolean) => void;
  unmark: () => void;
}

/** A choice that is there only where a part of the sky is marked. */
export function setRegionOption(select: HTMLSelectElement, marked: boolean): void {
  const option = [...select.options].find(({ value }) => value === "region");
  if (option === undefined) return;
  option.disabled = !marked;
  option.hidden = !marked;
  if (!marked && select.value === "region") select.selectedIndex = 0;
}

export class Marking {
  private readonly button = byId("mark", HTMLButtonElement);
  private readonly hint = byId("mark-hint", HTMLElement);
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
    const { mark, stopMarking, unmark, markHint } = words().sky;
    this.button.textContent = this.drawing ? stopMarking : this.marked ? unmark : mark;
    this.hint.textContent = this.drawing ? markHint : "";
  }
}
