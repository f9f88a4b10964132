// Puts the viewer together: one store, and the components that follow it.

import { noAnswer } from "./api/problem.ts";
import { followConnection } from "./data/connection.ts";
import { dropAbsentAir, followScene, loadScenes } from "./data/scenes.ts";
import { SkySession } from "./data/sky-session.ts";
import { chooseLanguage } from "./language/words.ts";
import { Lights } from "./lights/lights.ts";
import { MapPanel } from "./map/map-panel.ts";
import { AppStore } from "./state/app-store.ts";
import type { Place } from "./state/view-state.ts";
import { AirControls } from "./ui/air-controls.ts";
import { byId } from "./ui/dom.ts";
import { mountEmissionControls } from "./ui/emission-controls.ts";
import { mountGroundControls } from "./ui/ground-controls.ts";
import { mountLayerPanel } from "./ui/layer-panel.ts";
import { mountLightsControls } from "./ui/lights-controls.ts";
import { mountLocate } from "./ui/locate.ts";
import { mountNotice } from "./ui/notice.ts";
import { mountPageStatus } from "./ui/page-status.ts";
import type { PaintCard } from "./ui/paint-card.ts";
import { mountPictureControls } from "./ui/picture-controls.ts";
import { mountResponseControls } from "./ui/response-controls.ts";
import { mountSceneSelect } from "./ui/scene-select.ts";
import { Search } from "./ui/search.ts";
import { mountSummary } from "./ui/summary.ts";
import { mountSwitches } from "./ui/switches.ts";

await chooseLanguage();
const store = new AppStore();

// What the state asks for is made sure of first, then fetched, then shown.
dropAbsentAir(store);
followScene(store);
followConnection(store);
new SkySession(store);
const lights = new Lights(store);

mountNotice(store);
mountPageStatus(store);
mountSceneSelect(store);
new AirControls(store);
mountGroundControls(store);
mountEmissionControls(store);
mountResponseControls(store);
mountPictureControls(store);
mountLightsControls(store);
mountLayerPanel(store);
mountSummary(store);

let paintCard: PaintCard | null = null;
let isAsked = false;
const map = new MapPanel(store, (area) => {
  if (paintCard !== null) lights.paint(area, paintCard.change());
});
store.watch(["place", "isAway"], ({ place, isAway }) => {
  if (place === null || isAway || isAsked) return;
  isAsked = true;
  Promise.all([import("./sky/sky-view.ts"), import("./sky/legend.ts"), import("./ui/place-cards.ts")])
    .then(([{ SkyView }, { Legend }, { mountPlaceCards }]) => {
      new Legend(store);
      new SkyView(byId("sky-view", HTMLElement), store);
      paintCard = mountPlaceCards(store, lights, map);
    })
    .catch(() => {
      isAsked = false;
      store.report(noAnswer());
    });
});

const goTo = (place: Place) => {
  store.pick(place);
  map.goTo(place);
};
new Search(store, goTo);
mountLocate(store, goTo);
mountSwitches(store, () => map.resize());

await loadScenes(store, map.load());
