// What is there for a picked place: its night, numbers, plans, paint and files. The page loads it with the first place.

import type { NamedPlace } from "../api/types.ts";
import { followNight } from "../data/night-session.ts";
import { SharesSession } from "../data/shares-session.ts";
import type { Lights } from "../lights/lights.ts";
import type { AppStore } from "../state/app-store.ts";
import { mountColourNumbers } from "./colour-numbers.ts";
import { mountDownloads } from "./downloads.ts";
import { mountNumbers } from "./numbers.ts";
import { PaintCard } from "./paint-card.ts";
import { PlanCard } from "./plan-card.ts";
import { mountShare } from "./share.ts";
import { mountShares } from "./shares.ts";
import { TimeLine } from "./time-line.ts";

/** What they move the map to. */
export interface MapMoves {
  showTown: (town: NamedPlace) => void;
}

export function mountPlaceCards(store: AppStore, lights: Lights, map: MapMoves): PaintCard {
  followNight(store);
  new SharesSession(store);
  mountShares(store, (town) => map.showTown(town));
  new TimeLine(store);
  mountNumbers(store);
  mountColourNumbers(store);
  mountDownloads(store);
  new PlanCard(store, lights);
  mountShare(lights);
  return new PaintCard(store, lights);
}
