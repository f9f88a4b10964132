// Puts the viewer together: one store, and the components that follow it.

import { noAnswer } from "./api/problem.ts";
import { followConnection } from "./data/connection.ts";
import { dropAbsentAir, followScene, loadScenes } from "./data/scenes.ts";
import { SkySession } from "./data/sky-session.ts";
import { followTonight } from "./data/tonight.ts";
import { chooseLanguage, loadWords } from "./language/words.ts";
import { Lights } from "./lights/lights.ts";
import { MapPanel } from "./map/map-panel.ts";
import { mountOffline, startWorker } from "./offline/offline.ts";
import { AppStore } from "./state/app-store.ts";
import type { Place } from "./state/view-state.ts";
import { AirControls } from "./ui/air-controls.ts";
import { mountEmissionControls } from "./ui/emission-controls.ts";
import { mountGroundControls } from "./ui/ground-controls.ts";
import { mountLayerPanel } from "./ui/layer-panel.ts";
import { mountLocate } from "./ui/locate.ts";
import { mountNotice } from "./ui/notice.ts";
import { mountPageStatus } from "./ui/page-status.ts";
import type { PaintCard } from "./ui/paint-card.ts";
import { mountResponseControls } from "./ui/response-controls.ts";
import { mountSceneSelect } from "./ui/scene-select.ts";
import { Search } from "./ui/search.ts";
import { mountSwitches } from "./ui/switches.ts";

await chooseLanguage();
const store = new AppStore();

// What the state asks for is made sure of first, then fetched, then shown.
dropAbsentAir(store);
followScene(store);
followConnection(store);
followTonight(store);
new SkySession(store);
const lights = new Lights(store);

mountNotice(store);
mountPageStatus(store);
mountSceneSelect(store);
new AirControls(store);
mountGroundControls(store);
mountEmissionControls(store);
mountResponseControls(store);
mountLayerPanel(store);

/** What is there for a picked place: it comes with the first one, or once the map is there and nothing else is under way. */
const loadPlaceCards = () => Promise.all([import("./ui/place-cards.ts"), loadWords("place")]);

let paintCard: PaintCard | null = null;
let isAsked = false;
const map = new MapPanel(store, (area) => {
  if (paintCard !== null) lights.paint(area, paintCard.change());
});
void map.drawn.then(loadPlaceCards).catch(() => {
  // The first place asks again.
});
mountOffline(store);
if (import.meta.env.PROD)
  void map.drawn.then(startWorker).catch(() => {
    // Without it nothing is kept, and all else works.
  });
store.watch(["place", "isAway"], ({ place, isAway }) => {
  if (place === null || isAway || isAsked) return;
  isAsked = true;
  loadPlaceCards()
    .then(([{ mountPlaceCards }]) => {
      paintCard = mountPlaceCards(store, lights, map);
    })
    .catch(() => {
      isAsked = false;
      store.report(noAnswer());
    });
});

const goTo = (place: Place) => {
  if (store.pick(place)) map.goTo(place);
};
new Search(store, goTo);
mountLocate(store, goTo);
mountSwitches(store, () => map.resize());

await loadScenes(store, map.load());
