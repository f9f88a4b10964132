// Where the visitor is, asked of the browser, which asks the visitor.

import type { Place } from "../state.ts";
import { by_id } from "./dom.ts";

const LONGEST_WAIT_MS = 20_000;
const WHY_NOT: Record<number, string> = {
  1: "The browser may not tell where you are. Allow it beside the page's address, or search for the place.",
  2: "The browser does not know where you are. Search for the place instead.",
  3: "The browser did not find in time where you are. Try again, or search for the place.",
};

/** Shows the button where the browser can tell; it tells pages of secure addresses alone. */
export function wire_locate(found: (place: Place) => void, failed: (reason: Error) => void): void {
  const button = by_id("locate", HTMLButtonElement);
  if (!window.isSecureContext || !("geolocation" in navigator)) return;
  button.hidden = false;
  button.addEventListener("click", () => {
    button.disabled = true;
    navigator.geolocation.getCurrentPosition(
      ({ coords }) => {
        button.disabled = false;
        found({ latitude_deg: coords.latitude, longitude_deg: coords.longitude });
      },
      ({ code }) => {
        button.disabled = false;
        failed(new Error(WHY_NOT[code] ?? "The browser does not say where you are."));
      },
      { timeout: LONGEST_WAIT_MS, maximumAge: 60_000 },
    );
  });
}
