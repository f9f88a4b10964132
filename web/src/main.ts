// Puts the viewer together: state in the URL, controls, map, and the sky of the picked place.

import { api, type InfluenceQuery, type LayerQuery, type SkyParameters } from "./api/client.ts";
import type { Atmosphere, NamedPlace, Scene, Site, SkyAnswer } from "./api/types.ts";
import { chooseLanguage, words } from "./language/words.ts";
import { Lights } from "./lights.ts";
import type { SkyMap } from "./map/sky-map.ts";
import { brightnessMagArcsec2 } from "./photometry.ts";
import { SkySession } from "./session.ts";
import type { SkySample } from "./sky/grid.ts";
import { Legend } from "./sky/legend.ts";
import { type Region, textFromRegion } from "./sky/region.ts";
import { SkyView } from "./sky/sky-view.ts";
import { fragmentFromState, LAYERS, type LayerName, type Place, stateFromFragment, type ViewState } from "./state.ts";
import { cloudBases, packsUnder } from "./ui/clouds.ts";
import { Controls, DEFAULT_TURBIDITY } from "./ui/controls.ts";
import { byId, debounced } from "./ui/dom.ts";
import { showDownloads, showInfluenceDownloads } from "./ui/downloads.ts";
import { coordinates } from "./ui/format.ts";
import { showLayerState } from "./ui/layers.ts";
import { wireLocate } from "./ui/locate.ts";
import { Marking } from "./ui/marking.ts";
import { placeName } from "./ui/nearby.ts";
import { Notice } from "./ui/notice.ts";
import { showNumbers, showSite } from "./ui/numbers.ts";
import { showReadout } from "./ui/readout.ts";
import { clampTurbidity, residentScatterings, scatteringTitle, turbidityRange } from "./ui/scattering.ts";
import { Search } from "./ui/search.ts";
import { wireShare } from "./ui/share.ts";
import { wireSwitches } from "./ui/switches.ts";

/** Opacity of the lights that cause a marked part of the sky. */
const SHOWN_INFLUENCE = 0.9;

/** What the sky of any place depends on. */
type Conditions = Omit<SkyParameters, "lat" | "lon">;

/** As requests have them. Five decimals are a metre; a link restores the very same request. */
function coordinatesOf({ latitude_deg, longitude_deg }: Place): { lat: number; lon: number } {
  return { lat: +latitude_deg.toFixed(5), lon: +longitude_deg.toFixed(5) };
}

class Viewer {
  private state: ViewState = stateFromFragment(location.hash);
  private scenes: readonly Scene[] = [];
  private atmospheres: readonly Atmosphere[] = [];
  private places: readonly NamedPlace[] = [];
  private answer: SkyAnswer | null = null;
  /** What is pointed at in the sky. */
  private pointed: SkySample | null = null;
  private map: SkyMap | null = null;
  private sceneRequests = new AbortController();

  private readonly notice = new Notice(byId("notice", HTMLElement));
  private readonly site = byId("site", HTMLElement);
  private readonly numbers = byId("numbers", HTMLElement);
  private readonly numbersCard = byId("numbers-card", HTMLElement);
  private readonly title = byId("place-title", HTMLElement);
  private readonly legend = new Legend(byId("legend", HTMLElement), byId("legend-title", HTMLElement));
  private readonly skyView = new SkyView(byId("sky-view", HTMLElement), this.state, {
    pointed: (sample) => {
      this.pointed = sample;
      this.showPointed();
    },
    gazed: (gaze) => {
      this.state = { ...this.state, gaze };
      this.writeUrl(false);
      this.showLinks();
    },
    drawn: (region) => {
      this.marking.ended();
      if (region !== null) this.mark(region);
    },
  });
  private readonly marking = new Marking({
    draw: (on) => this.skyView.setDrawing(on),
    unmark: () => this.mark(null),
  });
  private readonly search = new Search(byId("search", HTMLInputElement), byId("search-list", HTMLElement), (place) => {
    this.pick(place);
    this.map?.goTo(place);
  });
  private readonly controls = new Controls({
    scene: (scene) => this.change({ scene, place: null, scenario: null, view: null }, { push: true }),
    turbidity: (turbidity) => this.change({ turbidity }),
    scattering: (scattering) =>
      this.change({ scattering, turbidity: clampTurbidity(this.packs(), scattering, this.state.turbidity) }),
    clouds: (clouds) => this.chooseClouds(clouds),
    lamp: (lamp) => this.change({ lamp }),
    emission: (emission) => this.change({ emission }),
    terrain: (terrain) => this.change({ terrain }),
    lights: (lights) => this.change({ lights }),
    projection: (projection) => this.change({ projection }),
    sky: (sky) => this.change({ sky }),
    colours: (colours) => this.change({ colours }),
    exposure: (exposureEv) => this.change({ exposureEv }),
    unit: (unit) => this.change({ unit }),
    measure: (measure) => this.change({ measure }),
    layer: (layer, opacity) => this.change({ layers: { ...this.state.layers, [layer]: opacity } }),
  });
  private readonly session = new SkySession({
    started: () => this.setBusy(true),
    site: (site) => this.siteKnown(site),
    numbers: (answer) => {
      this.answer = answer;
      document.body.dataset.sky = "numbers";
      this.showNumbers();
    },
    picture: (grid, other) => {
      document.body.dataset.sky = "picture";
      this.skyView.show(grid, other);
      this.showLinks();
    },
    failed: (reason) => {
      this.forgetSky();
      this.notice.show(reason);
    },
    ended: () => this.setBusy(false),
  });

  /** Once the line rests. */
  private readonly writeSplit = debounced(300, () => this.writeUrl(false));

  private readonly lights = new Lights({
    chosen: (scenario, how) => this.change({ scenario, lights: this.state.lights === "both" ? "both" : "changed" }, how),
    settled: () => {
      for (const layer of LAYERS) this.showLayer(layer);
    },
    failed: (reason) => this.notice.show(reason),
  });

  async start(): Promise<void> {
    wireShare(() => this.lights.lasting());
    wireSwitches(() => this.map?.resize());
    wireLocate(
      (place) => {
        this.pick(place);
        this.map?.goTo(place);
      },
      (reason) => this.notice.show(reason),
    );
    const split = byId("split", HTMLInputElement);
    split.addEventListener("input", () => this.setSplit(Number(split.value) / 100));
    this.setSplit(this.state.split);
    this.showLook();
    const { signal } = this.sceneRequests;
    const mapCode = import("./map/sky-map.ts");
    try {
      const [scenes, atmospheres] = await Promise.all([api.scenes(signal), api.atmospheres(signal)]);
      this.scenes = scenes;
      this.atmospheres = atmospheres;
      this.controls.setScenes(scenes);
      this.controls.setAtmospheres(atmospheres);
      if (scenes.length === 0) {
        this.notice.show(new Error(words().problems.noScenes));
      }
    } catch (reason) {
      this.notice.show(reason);
    }
    this.dropAbsentAir();
    this.controls.show(this.state, null);
    await this.startMap(mapCode);
    addEventListener("popstate", () => this.restore());
    if (this.scenes.length > 0) this.enterScene();
  }

  /** Without WebGL there is no map, but the search box still picks places. */
  private async startMap(mapCode: Promise<typeof import("./map/sky-map.ts")>): Promise<void> {
    try {
      const { SkyMap } = await mapCode;
      this.map = this.newMap(SkyMap);
      this.lights.setMap(this.map);
    } catch (reason) {
      this.notice.show(new Error(words().problems.noMap(reason instanceof Error ? reason.message : String(reason))));
    }
  }

  private newMap(SkyMapClass: typeof SkyMap): SkyMap {
    return new SkyMapClass(byId("map", HTMLElement), this.state.view, {
      picked: (place) => this.pick(place),
      painted: (area) => this.lights.painted(area),
      moved: (view) => {
        this.state = { ...this.state, view };
        this.writeUrl(false);
      },
      layer: showLayerState,
      split: (part) => this.setSplit(part),
      failed: (reason) => this.notice.show(reason),
    });
  }

  /** How far today's sky and map reach from the left, 0 to 1. */
  private setSplit(part: number): void {
    const slider = byId("split", HTMLInputElement);
    slider.value = String(Math.round(100 * part));
    slider.setAttribute("aria-valuetext", words().plan.percent(slider.value));
    this.skyView.setSplit(part);
    this.state = { ...this.state, split: part };
    this.compare();
    this.writeSplit();
  }

  private compare(): void {
    this.map?.compare(this.isCompared() ? this.state.split : null);
  }

  private scene(): Scene | null {
    return this.scenes.find(({ id }) => id === this.state.scene) ?? null;
  }

  /** Shows the state's scene, or the first where the state names none that exists. */
  private enterScene(): void {
    if (this.state.scene !== null && this.scene() === null) {
      this.notice.show(new Error(words().problems.noSuchScene(this.state.scene, this.scenes[0]?.title ?? "")));
      this.state = { ...this.state, scene: null, place: null, scenario: null, view: null };
    }
    const scene = this.scene() ?? this.scenes[0];
    if (scene === undefined) return;
    this.state = { ...this.state, scene: scene.id };
    this.sceneRequests.abort();
    this.sceneRequests = new AbortController();
    this.places = [];
    this.search.setPlaces([]);
    void this.map?.showScene(scene, this.state.view === null);
    void this.map?.showPlaces([]);
    const { signal } = this.sceneRequests;
    api
      .places(scene.id, signal)
      .then((places) => {
        this.places = places;
        this.search.setPlaces(places);
        this.lights.setPlaces(places);
        this.showTitle();
        return this.map?.showPlaces(places);
      })
      .catch((reason: unknown) => {
        if (!signal.aborted) this.notice.show(reason);
      });
    this.showState();
    this.writeUrl(false);
  }

  /** The packs under the clouds of the state. */
  private packs(): Atmosphere[] {
    return packsUnder(this.atmospheres, this.state.clouds);
  }

  /** Scattering and turbidity stay where the packs under these clouds serve them. */
  private chooseClouds(clouds: number | null): void {
    const packs = packsUnder(this.atmospheres, clouds);
    const scattering = residentScatterings(packs).find((name) => name === this.state.scattering) ?? null;
    const ends = turbidityRange(packs, scattering);
    const wanted = this.state.turbidity ?? DEFAULT_TURBIDITY;
    const reached = ends !== null && wanted >= ends[0] && wanted <= ends[1];
    this.change({ clouds, scattering, turbidity: reached ? this.state.turbidity : clampTurbidity(packs, scattering, wanted) });
  }

  /** A link may come from a server with other tables. */
  private dropAbsentAir(): void {
    const { clouds } = this.state;
    if (clouds !== null && this.atmospheres.length > 0 && !cloudBases(this.atmospheres).includes(clouds)) {
      this.notice.show(new Error(words().problems.noClouds(clouds)));
      this.state = { ...this.state, clouds: null };
      this.writeUrl(false);
    }
    const { scattering } = this.state;
    const resident = residentScatterings(this.packs());
    const best = resident[0];
    if (scattering === null || best === undefined || resident.includes(scattering)) return;
    this.notice.show(new Error(words().problems.noScattering(scatteringTitle(scattering), scatteringTitle(best))));
    this.state = { ...this.state, scattering: null };
    this.writeUrl(false);
  }

  private pick(place: Place): void {
    this.notice.clear();
    this.change({ place }, { push: true });
  }

  private change(part: Partial<ViewState>, { push = false } = {}): void {
    const sceneBefore = this.state.scene;
    this.state = { ...this.state, ...part };
    this.writeUrl(push);
    if (this.state.scene !== sceneBefore) this.enterScene();
    else this.showState();
  }

  /** Back and forward, and fragments typed by hand. */
  private restore(): void {
    const sceneBefore = this.state.scene;
    this.state = stateFromFragment(location.hash);
    this.setSplit(this.state.split);
    this.dropAbsentAir();
    if (this.state.view !== null) this.map?.jumpTo(this.state.view);
    if (this.state.scene !== sceneBefore) this.enterScene();
    else this.showState();
  }

  private showState(): void {
    this.controls.show(this.state, this.scene());
    this.showLook();
    this.compare();
    for (const layer of LAYERS) this.showLayer(layer);
    this.map?.mark(this.state.place);
    this.showTitle();
    const { scene, place, scenario, lights, region } = this.state;
    document.body.dataset.place = place === null ? "none" : "picked";
    const { scenario: _, ...conditions } = this.conditions();
    this.lights.show({ scene, place, scenario, lights, region, conditions });
    if (scene === null || place === null) {
      this.session.cancel();
      this.setBusy(false);
      this.forgetSky();
      return;
    }
    this.showNumbers();
    const parameters = this.parameters(place);
    this.showLinks();
    const { scenario: changed, ...today } = parameters;
    void this.session.show(scene, parameters, lights === "both" && changed !== undefined ? today : null);
  }

  /** Marks a part of the sky, and shows which lights cause it. */
  private mark(region: Region | null): void {
    const { layers, measure } = this.state;
    const shown = layers.influence === 0 ? SHOWN_INFLUENCE : layers.influence;
    if (region !== null) this.change({ region, measure: "region", layers: { ...layers, influence: shown } }, { push: true });
    else this.change({ region, measure: measure === "region" ? "zenith" : measure }, { push: true });
  }

  /** Whether the lights of today are shown beside the changed ones. */
  private isCompared(): boolean {
    return this.state.scenario !== null && this.state.lights === "both";
  }

  private showLayer(layer: LayerName): void {
    const { scene, layers } = this.state;
    // Its sums take seconds: of plans that are only tried they are not asked for, and what is there stays.
    if (layer === "brightness" && layers.brightness > 0 && this.lights.isTrying()) return;
    const { scenario: _, ...today } = this.conditions();
    const wanted = (conditions: Conditions) => {
      const query = this.layerQuery(layer, conditions);
      return scene === null || query === null ? null : { scene, query, opacity: layers[layer] };
    };
    this.map?.showLayer(layer, wanted(this.conditions()), this.isCompared() ? wanted(today) : null);
  }

  /** What a layer is asked for under such conditions; null where there is nothing to show. */
  private layerQuery(layer: LayerName, conditions: Conditions): LayerQuery | null {
    const { place, clouds } = this.state;
    const { scenario } = conditions;
    return {
      elevation: this.scene()?.terrain === true ? {} : null,
      brightness: clouds === null ? conditions : null,
      radiance: scenario === undefined ? {} : { scenario },
      influence: place === null ? null : this.influenceQuery(place, conditions),
    }[layer];
  }

  private influenceQuery(place: Place, conditions: Conditions): InfluenceQuery {
    const { measure, region } = this.state;
    const marked = measure === "region" && region !== null ? { region: textFromRegion(region) } : {};
    return { ...coordinatesOf(place), ...conditions, measure, ...marked };
  }

  private parameters(place: Place): SkyParameters {
    return { ...coordinatesOf(place), ...this.conditions() };
  }

  private conditions(): Conditions {
    const { turbidity, scattering, clouds, lamp, emission, terrain, scenario, lights } = this.state;
    const air = {
      ...(turbidity === null ? {} : { turbidity }),
      ...(scattering === null ? {} : { scattering }),
      ...(clouds === null ? {} : { clouds: String(clouds) }),
    };
    const ground = terrain === "on" ? {} : { terrain };
    const changed = scenario === null || lights === "today" ? {} : { scenario };
    return { lamp, emission, ...ground, ...air, ...changed };
  }

  private showLinks(): void {
    const { scene, place } = this.state;
    if (scene === null || place === null) return;
    showDownloads(byId("download-links", HTMLElement), scene, this.parameters(place), this.state, this.skyView.view());
    showInfluenceDownloads(byId("influence-links", HTMLElement), scene, this.influenceQuery(place, this.conditions()));
  }

  private showLook(): void {
    document.body.dataset.projection = this.state.projection;
    this.legend.show(this.state);
    this.skyView.setLook(this.state);
    this.showPointed();
    this.marking.show(this.state.region !== null);
  }

  private showPointed(): void {
    const { pointed: sample } = this;
    showReadout(byId("sky-readout", HTMLElement), sample, this.state.sky, this.state.unit);
    const shown = this.state.sky === "total" ? sample?.totalCdM2 : sample?.artificialCdM2;
    this.legend.point(shown === undefined || sample?.isBelowHorizon === true ? null : brightnessMagArcsec2(shown));
  }

  private showTitle(): void {
    const { place } = this.state;
    this.skyView.setTowns(place, this.places);
    if (place === null) this.title.textContent = "";
    else {
      const name = placeName(place, this.places);
      const at = coordinates(place.latitude_deg, place.longitude_deg);
      this.title.replaceChildren(
        name,
        ...(name === at ? [] : [Object.assign(document.createElement("small"), { textContent: at })]),
      );
    }
  }

  private siteKnown(site: Site): void {
    this.answer = null;
    this.numbers.replaceChildren();
    this.skyView.show(null);
    document.body.dataset.sky = "site";
    showSite(this.site, site);
  }

  private showNumbers(): void {
    const scene = this.scene();
    if (this.answer !== null && scene !== null)
      showNumbers(this.numbers, this.answer, this.state.sky, this.state.unit, this.state.lamp, scene);
  }

  private forgetSky(): void {
    this.answer = null;
    document.body.dataset.sky = "none";
    this.site.replaceChildren();
    this.numbers.replaceChildren();
    this.skyView.show(null);
  }

  private setBusy(busy: boolean): void {
    document.body.classList.toggle("busy", busy);
    this.numbersCard.setAttribute("aria-busy", String(busy));
  }

  private writeUrl(push: boolean): void {
    const fragment = fragmentFromState(this.state);
    if (fragment === location.hash) return;
    const url = `${location.pathname}${location.search}${fragment}`;
    try {
      if (push) history.pushState(null, "", url);
      else history.replaceState(null, "", url);
    } catch {
      // Some browsers take no more than some changes of the address in a while; the next one has it all.
    }
  }
}

await chooseLanguage();
void new Viewer().start();
