// Attributes that the page's styles depend on, and the title of the picked place.

import { words } from "../language/words.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, make } from "./dom.ts";
import { coordinates, percent } from "./format.ts";
import { placeName } from "./nearby.ts";

const TITLE = "Skyglow";

export function mountPageStatus(store: AppStore): void {
  const { body } = document;
  const numbers = byId("numbers-card", HTMLElement);
  const title = byId("place-title", HTMLElement);
  store.watch(["place"], ({ place }) => {
    body.dataset.place = place === null ? "none" : "picked";
  });
  store.watch(["projection"], ({ projection }) => {
    body.dataset.projection = projection;
  });
  store.watch(["skyStage"], ({ skyStage }) => {
    body.dataset.sky = skyStage;
  });
  store.watch(["isBusy", "isLandBusy"], ({ isBusy, isLandBusy }) => {
    body.classList.toggle("busy", isBusy || isLandBusy);
    numbers.setAttribute("aria-busy", String(isBusy));
  });
  // Until the sky of a link's place is there, or it is clear that none comes, what lies below it is not shown: it would jump.
  body.classList.toggle("opening", store.state.place !== null);
  const parts = ["place", "skyStage", "problem", "isAway"] as const;
  store.watch(parts, ({ place, skyStage, problem, isAway }) => {
    if (place === null || skyStage !== "none" || problem !== null || isAway) body.classList.remove("opening");
  });
  const finding = byId("finding", HTMLElement);
  store.watch(["foundPart"], ({ foundPart }) => {
    finding.hidden = foundPart === null;
    finding.textContent = foundPart === null ? "" : words().finding(percent(foundPart));
  });
  store.watch(["place", "places"], ({ place, places }) => {
    if (place === null) {
      title.replaceChildren();
      document.title = TITLE;
      return;
    }
    const name = placeName(place, places);
    document.title = `${name} – ${TITLE}`;
    const at = coordinates(place.latitude_deg, place.longitude_deg);
    title.replaceChildren(name, ...(name === at ? [] : [make("small", "", at)]));
  });
}
