// What is there for a picked place: what the picture reads, its night, numbers, plans, paint and files. The page loads it with the first place.

import type { NamedPlace } from "../api/types.ts";
import { DarkerSession } from "../data/darker-session.ts";
import { followInfluences } from "../data/influences-session.ts";
import { followLand } from "../data/land.ts";
import { followNight, followNightHours } from "../data/night-session.ts";
import { SharesSession } from "../data/shares-session.ts";
import type { Lights } from "../lights/lights.ts";
import { Legend } from "../sky/legend.ts";
import { SkyView } from "../sky/sky-view.ts";
import type { AppStore } from "../state/app-store.ts";
import type { Place } from "../state/view-state.ts";
import { mountAreas } from "./areas.ts";
import { BenchCard } from "./bench-card.ts";
import { mountBeside } from "./beside.ts";
import { mountColourNumbers } from "./colour-numbers.ts";
import { Compare } from "./compare.ts";
import { mountDarker } from "./darker.ts";
import { byId } from "./dom.ts";
import { mountDownloads } from "./downloads.ts";
import { mountEmbedCode } from "./embed-code.ts";
import { mountLightsControls } from "./lights-controls.ts";
import { mountMeter } from "./meter.ts";
import { mountNumbers } from "./numbers.ts";
import { PaintCard } from "./paint-card.ts";
import { mountPictureControls } from "./picture-controls.ts";
import { PlanCard } from "./plan-card.ts";
import { mountReadout } from "./readout.ts";
import { mountRegionButton } from "./region-button.ts";
import { mountReportButton } from "./report-button.ts";
import { mountShare } from "./share.ts";
import { mountShares } from "./shares.ts";
import { mountSummary } from "./summary.ts";
import { TimeLine } from "./time-line.ts";

/** What they move the map to. */
export interface MapMoves {
  showTown: (town: NamedPlace) => void;
  goTo: (place: Place) => void;
}

export function mountPlaceCards(store: AppStore, lights: Lights, map: MapMoves): PaintCard {
  mountPictureControls(store);
  mountLightsControls(store);
  mountBeside(store);
  mountSummary(store);
  new Legend(store);
  new SkyView(byId("sky-view", HTMLElement), store);
  followLand(store);
  followInfluences(store);
  mountReadout(store);
  mountRegionButton(store);
  followNight(store);
  followNightHours(store);
  new SharesSession(store);
  mountShares(store, (town) => map.showTown(town));
  mountAreas(store);
  new TimeLine(store);
  new DarkerSession(store);
  const goTo = (place: Place) => {
    if (store.pick({ latitude_deg: place.latitude_deg, longitude_deg: place.longitude_deg })) map.goTo(place);
  };
  mountDarker(store, goTo);
  new Compare(store, goTo);
  mountNumbers(store);
  mountColourNumbers(store);
  mountMeter(store);
  mountDownloads(store);
  new PlanCard(store, lights);
  mountShare(store, lights);
  mountReportButton(store, lights);
  mountEmbedCode(store, lights);
  new BenchCard(store, lights);
  return new PaintCard(store, lights);
}
