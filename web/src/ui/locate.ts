// The visitor's own place, from the browser's geolocation.

import { words } from "../language/words.ts";
import type { AppStore } from "../state/app-store.ts";
import type { Place } from "../state/view-state.ts";
import { byId } from "./dom.ts";

const MAX_WAIT_MS = 20_000;

/** By the code of a GeolocationPositionError. */
function locationProblem(code: number): string {
  const { forbidden, unknown, late, silent } = words().locate;
  return { 1: forbidden, 2: unknown, 3: late }[code] ?? silent;
}

/** Shows the button where geolocation is available: on pages of secure addresses alone. */
export function mountLocate(store: AppStore, found: (place: Place) => void): void {
  const button = byId("locate", HTMLButtonElement);
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
        store.report(new Error(locationProblem(code)));
      },
      { timeout: MAX_WAIT_MS, maximumAge: 60_000 },
    );
  });
}
