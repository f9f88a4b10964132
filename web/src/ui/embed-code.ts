// Code that shows this sky in other people's pages, to be copied.

import { embedCode } from "../embed/embedded.ts";
import { placeWords } from "../language/words.ts";
import type { Lights } from "../lights/lights.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId } from "./dom.ts";
import { placeName } from "./nearby.ts";

export function mountEmbedCode(store: AppStore, lights: Lights): void {
  const status = byId("embed-told", HTMLElement);
  const field = byId("embed-code", HTMLTextAreaElement);
  byId("embed-copy", HTMLButtonElement).addEventListener("click", () => {
    const { place, places } = store.state;
    if (place === null) return;
    const say = placeWords();
    // A link to a plan that is only tried would be dead within minutes.
    void lights.lasting().then(async () => {
      const code = embedCode(location.href, say.compare.skyOver(placeName(place, places)));
      // It is shown too: who pastes it may want another size.
      field.value = code;
      field.hidden = false;
      try {
        await navigator.clipboard.writeText(code);
        status.textContent = say.downloads.embedCopied;
      } catch {
        status.textContent = say.downloads.copyByHand;
        field.focus();
        field.select();
      }
    });
  });
  // It is the code of that place.
  store.watch(["place", "scenario", "time"], () => {
    field.hidden = true;
    status.textContent = "";
  });
}
