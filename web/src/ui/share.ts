// The link to what is shown: handed to the phone's own list of ways to share, or copied.

import { words } from "../language/words.ts";
import { by_id } from "./dom.ts";

/** How long it is said that the link is copied. */
const TOLD_MS = 6000;

/** `lasting`: when a link to what is shown will last. */
export function wire_share(lasting: () => Promise<boolean>): void {
  const told = by_id("share-told", HTMLElement);
  const field = by_id("share-link", HTMLInputElement);
  by_id("share", HTMLButtonElement).addEventListener("click", () => {
    lasting()
      .then(() => share(location.href))
      .then((how) => {
        told.textContent = how === "copied" ? words().downloads.copied : "";
        setTimeout(() => (told.textContent = ""), TOLD_MS);
      })
      .catch(() => {
        // Where neither is allowed, the link is there to be copied by hand.
        told.textContent = words().downloads.copy_by_hand;
        field.value = location.href;
        field.hidden = false;
        field.focus();
        field.select();
      });
  });
  // It is the link of that moment.
  field.addEventListener("blur", () => {
    told.textContent = "";
    field.hidden = true;
  });
}

async function share(url: string): Promise<"shared" | "copied"> {
  const by_touch = matchMedia("(pointer: coarse)").matches;
  if (by_touch && navigator.share !== undefined) {
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
