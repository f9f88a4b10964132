// The link to what is shown: handed to the phone's own list of ways to share, or copied.

import { placeWords } from "../language/words.ts";
import type { Lights } from "../lights/lights.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId } from "./dom.ts";
import { sharedLink } from "./shared-link.ts";

/** How long the page shows that the link is copied. */
const STATUS_MS = 6000;

export function mountShare(store: AppStore, lights: Lights): void {
  const link = () => sharedLink(location.href, store.state.answer?.sky.brightest_azimuth_deg ?? null);
  const status = byId("share-told", HTMLElement);
  const field = byId("share-link", HTMLInputElement);
  byId("share", HTMLButtonElement).addEventListener("click", () => {
    // A link to a plan that is only tried would be dead within minutes.
    lights
      .lasting()
      .then(() => share(link()))
      .then((how) => {
        status.textContent = how === "copied" ? placeWords().downloads.copied : "";
        setTimeout(() => (status.textContent = ""), STATUS_MS);
      })
      .catch(() => {
        // Where neither is allowed, the link is there to be copied by hand.
        status.textContent = placeWords().downloads.copyByHand;
        field.value = link();
        field.hidden = false;
        field.focus();
        field.select();
      });
  });
  // It is the link of that moment.
  field.addEventListener("blur", () => {
    status.textContent = "";
    field.hidden = true;
  });
}

async function share(url: string): Promise<"shared" | "copied"> {
  const byTouch = matchMedia("(pointer: coarse)").matches;
  if (byTouch && navigator.share !== undefined) {
    try {
      await navigator.share({ url, title: document.title });
    } catch (reason) {
      // Who closes the list has decided.
      if (!(reason instanceof DOMException && reason.name === "AbortError")) throw reason;
    }
    return "shared";
  }
  await navigator.clipboard.writeText(url);
  return "copied";
}
