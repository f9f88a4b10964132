// The map as a component: it follows the state, and what happens on it changes the state.

import type { Scene } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { PaintedArea } from "../lights/painting.ts";
import {
  type AppState,
  besideScene,
  CONDITIONS,
  type Conditions,
  conditionsOf,
  influenceQuery,
  isCompared,
  planOf,
  scenarioOf,
  sceneOf,
  todaysConditions,
} from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { LAYERS, type LayerName, type MapMeasure, mapMeasure, type Place } from "../state/view-state.ts";
import { sideTitles } from "../ui/beside.ts";
import { byId } from "../ui/dom.ts";
import type { LayerRequest } from "./raster-layers.ts";
import type { SkyMap } from "./sky-map.ts";

const NOTHING: readonly never[] = [];

export class MapPanel {
  private map: SkyMap | null = null;
  /** When the map's outlines are there in full. */
  readonly drawn: Promise<void>;
  private tellDrawn: () => void = () => {};

  constructor(
    private readonly store: AppStore,
    private readonly painted: (area: PaintedArea) => void,
  ) {
    this.drawn = new Promise((resolve) => {
      this.tellDrawn = resolve;
    });
  }

  /** Without WebGL there is no map, but the search box still picks places. */
  async load(): Promise<void> {
    try {
      const { SkyMap } = await import("./sky-map.ts");
      this.map = this.create(SkyMap);
      this.follow(this.map);
    } catch (reason) {
      byId("map", HTMLElement).dataset.failed = "";
      this.store.report(new Error(words().problems.noMap(reason instanceof Error ? reason.message : String(reason))));
    }
  }

  /** Moves so that a place is in view. */
  goTo(place: Place): void {
    this.map?.goTo(place);
  }

  /** Moves so that a town is in view beside the picked place. */
  showTown(town: Place): void {
    this.map?.showBeside(town);
  }

  resize(): void {
    this.map?.resize();
  }

  private create(Class: typeof SkyMap): SkyMap {
    const { store } = this;
    return new Class(byId("map", HTMLElement), store.state.view, {
      picked: (place) => store.pick(place),
      painted: this.painted,
      moved: (view) => store.set({ view }),
      layer: (name, state) => store.set({ layerStates: { ...store.state.layerStates, [name]: state } }),
      split: (split) => store.set({ split }),
      drawn: this.tellDrawn,
      failed: (reason) => store.report(reason),
    });
  }

  private follow(map: SkyMap): void {
    const { store } = this;
    addEventListener("popstate", () => {
      if (store.state.view !== null) map.jumpTo(store.state.view);
    });
    store.watch([sceneOf], (state) => {
      const scene = sceneOf(state);
      if (scene !== null) void map.showScene(scene, state.view === null);
    });
    store.watch(["places"], ({ places }) => void map.showPlaces(places));
    // A link and the browser's history say what the map shows.
    let isPicked = store.state.view === null;
    store.watch(["place"], ({ place }) => {
      map.mark(place, isPicked);
      isPicked = true;
    });
    store.watch(["shownTown"], ({ shownTown }) => map.showTown(shownTown));
    store.watch(["darker"], ({ darker }) => map.showDarker(darker?.places ?? NOTHING));
    store.watch(["areaShares"], ({ areas, areaShares }) => {
      const features = (areas?.body as { features?: readonly unknown[] } | undefined)?.features ?? NOTHING;
      void map.showAreas(areaShares === null ? null : { features, shares: areaShares.areas });
    });
    store.watch(["influences"], ({ influences }) => map.showLights(influences));
    store.watch(["brush"], ({ brush }) => map.setBrush(brush));
    store.watch([isCompared, "split", sceneOf, besideScene, scenarioOf], (state) => {
      map.compare(isCompared(state) ? { part: state.split, titles: sideTitles(state) } : null);
    });
    store.watch([planOf, "lights"], (state) => {
      void map.showDimmed((state.lights === "today" ? null : planOf(state)?.pixels) ?? NOTHING);
    });
    store.watch(["painting", "lights"], ({ painting, lights }) => {
      void map.showPainted(lights === "today" ? NOTHING : painting.done);
    });
    store.watch(["isAway"], ({ isAway }) => {
      if (!isAway) map.refreshTiles();
    });
    store.watch(
      [sceneOf, besideScene, "place", ...CONDITIONS, "layers", "measure", "surface", "region", "isTrying", "isAway"],
      (state) => {
        if (state.isAway) return;
        for (const layer of LAYERS) showLayer(map, layer, state);
      },
    );
  }
}

function showLayer(map: SkyMap, layer: LayerName, state: Readonly<AppState>): void {
  // It takes seconds to compute: plans that are only tried leave the last one in place.
  if (layer === "brightness" && state.layers.brightness > 0 && state.isTrying) return;
  const today = isCompared(state) ? layerRequest(layer, state, todaysConditions(state), besideScene(state)) : null;
  map.showLayer(layer, layerRequest(layer, state, conditionsOf(state)), today);
}

/** What says what of the sky a map shows; nothing for the zenith, which is what maps show unasked. */
function ofMeasure(measure: MapMeasure): { measure?: MapMeasure } {
  return measure === "zenith" ? {} : { measure };
}

/** The request for a layer under these conditions; null where there is nothing to show. */
function layerRequest(
  layer: LayerName,
  state: Readonly<AppState>,
  conditions: Conditions,
  beside: Scene | null = null,
): LayerRequest | null {
  const { place, clouds, cloudCover, layers } = state;
  const { scenario } = conditions;
  const scene = beside ?? sceneOf(state);
  const query = {
    elevation: scene?.terrain === true ? {} : null,
    // Maps know closed clouds, no broken ones.
    brightness: clouds === null || cloudCover >= 100 ? { ...conditions, ...ofMeasure(mapMeasure(state)) } : null,
    radiance: scenario === undefined ? {} : { scenario },
    influence: place === null ? null : influenceQuery(state, place, conditions),
  }[layer];
  return scene === null || query === null ? null : { scene: scene.id, query, opacity: layers[layer] };
}
