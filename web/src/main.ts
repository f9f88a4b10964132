// Puts the viewer together: one store, and the components that follow it.

import { followConnection } from "./data/connection.ts";
import { followNight } from "./data/night-session.ts";
import { dropAbsentAir, followScene, loadScenes } from "./data/scenes.ts";
import { SkySession } from "./data/sky-session.ts";
import { chooseLanguage } from "./language/words.ts";
import { Lights } from "./lights/lights.ts";
import { MapPanel } from "./map/map-panel.ts";
import { Legend } from "./sky/legend.ts";
import { SkyView } from "./sky/sky-view.ts";
import { AppStore } from "./state/app-store.ts";
import type { Place } from "./state/view-state.ts";
import { AirControls } from "./ui/air-controls.ts";
import { mountColourNumbers } from "./ui/colour-numbers.ts";
import { byId } from "./ui/dom.ts";
import { mountDownloads } from "./ui/downloads.ts";
import { mountEmissionControls } from "./ui/emission-controls.ts";
import { mountGroundControls } from "./ui/ground-controls.ts";
import { mountLayerPanel } from "./ui/layer-panel.ts";
import { mountLightsControls } from "./ui/lights-controls.ts";
import { mountLocate } from "./ui/locate.ts";
import { mountNotice } from "./ui/notice.ts";
import { mountNumbers } from "./ui/numbers.ts";
import { mountPageStatus } from "./ui/page-status.ts";
import { PaintCard } from "./ui/paint-card.ts";
import { mountPictureControls } from "./ui/picture-controls.ts";
import { PlanCard } from "./ui/plan-card.ts";
import { mountReadout } from "./ui/readout.ts";
import { mountRegionButton } from "./ui/region-button.ts";
import { mountResponseControls } from "./ui/response-controls.ts";
import { mountSceneSelect } from "./ui/scene-select.ts";
import { Search } from "./ui/search.ts";
import { mountShare } from "./ui/share.ts";
import { mountSummary } from "./ui/summary.ts";
import { mountSwitches } from "./ui/switches.ts";
import { TimeLine } from "./ui/time-line.ts";

await chooseLanguage();
const store = new AppStore();

// What the state asks for is made sure of first, then fetched, then shown.
dropAbsentAir(store);
followScene(store);
followConnection(store);
new SkySession(store);
followNight(store);
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
mountNumbers(store);
mountColourNumbers(store);
new TimeLine(store);
mountReadout(store);
mountRegionButton(store);
new Legend(store);
new SkyView(byId("sky-view", HTMLElement), store);
mountDownloads(store);
new PlanCard(store, lights);
const paintCard = new PaintCard(store, lights);

const map = new MapPanel(store, (area) => lights.paint(area, paintCard.change()));
const goTo = (place: Place) => {
  store.pick(place);
  map.goTo(place);
};
new Search(store, goTo);
mountLocate(store, goTo);
mountShare(lights);
mountSwitches(store, () => map.resize());

await loadScenes(store, map.load());
