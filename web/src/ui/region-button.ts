// The button that marks a part of the sky by a curve around it.

import { words } from "../language/words.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId } from "./dom.ts";

export function mountRegionButton(store: AppStore): void {
  const button = byId("mark", HTMLButtonElement);
  const hint = byId("mark-hint", HTMLElement);
  button.addEventListener("click", () => {
    const { region, isDrawing } = store.state;
    if (region !== null && !isDrawing) store.markRegion(null);
    else store.set({ isDrawing: !isDrawing });
  });
  store.watch(["isDrawing", "region"], ({ isDrawing, region }) => {
    const { mark, stopMarking, unmark, markHint } = words().sky;
    button.setAttribute("aria-pressed", String(isDrawing));
    button.textContent = isDrawing ? stopMarking : region !== null ? unmark : mark;
    hint.textContent = isDrawing ? markHint : "";
  });
}
