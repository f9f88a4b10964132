// What sees the sky in false colour and the map's layers, for experts.

import { words } from "../language/words.ts";
import { isOfLight } from "../sky/colour-maps.ts";
import type { AppStore } from "../state/app-store.ts";
import { RESPONSES } from "../state/view-state.ts";
import { byId } from "./dom.ts";
import { fillSelect } from "./select.ts";

export function mountResponseControls(store: AppStore): void {
  const select = byId("response", HTMLSelectElement);
  const note = byId("response-note", HTMLElement);
  select.addEventListener("change", () => {
    store.set({ response: RESPONSES.find((name) => name === select.value) ?? "photopic" });
  });
  store.watch(["response", "colours"], ({ response, colours }) => {
    const choices = RESPONSES.map((name) => [name, words().responses[name]] as const);
    fillSelect(select, choices, response);
    const { ofFalseColour, notAsACamera } = words().seen;
    note.textContent = response !== "photopic" && isOfLight(colours) ? notAsACamera : ofFalseColour;
  });
}
