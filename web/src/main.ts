// Puts the viewer together: state in the URL, controls, map, and the sky of the picked place.

import { api, type InfluenceQuery, type LayerQuery, type SkyParameters } from "./api/client.ts";
import type { Atmosphere, NamedPlace, Scene, Site, SkyAnswer } from "./api/types.ts";
import { choose_language, words } from "./language/words.ts";
import type { SkyMap } from "./map/sky_map.ts";
import { Lights } from "./lights.ts";
import { SkySession } from "./session.ts";
import { brightness_mag_arcsec2 } from "./photometry.ts";
import { Legend } from "./sky/legend.ts";
import { text_from_region, type Region } from "./sky/region.ts";
import type { SkySample } from "./sky/grid.ts";
import { SkyView } from "./sky/sky_view.ts";
import { LAYERS, fragment_from_state, state_from_fragment, type LayerName, type Place, type ViewState } from "./state.ts";
import { cloud_bases, packs_under } from "./ui/clouds.ts";
import { Controls, DEFAULT_TURBIDITY } from "./ui/controls.ts";
import { by_id, debounced } from "./ui/dom.ts";
import { show_downloads, show_influence_downloads } from "./ui/downloads.ts";
import { coordinates } from "./ui/format.ts";
import { show_layer_state } from "./ui/layers.ts";
import { wire_locate } from "./ui/locate.ts";
import { Marking } from "./ui/marking.ts";
import { place_name } from "./ui/nearby.ts";
import { Notice } from "./ui/notice.ts";
import { show_numbers, show_site } from "./ui/numbers.ts";
import { show_readout } from "./ui/readout.ts";
import { resident_scatterings, scattering_title, turbidity_ends, turbidity_within } from "./ui/scattering.ts";
import { Search } from "./ui/search.ts";
import { wire_share } from "./ui/share.ts";
import { wire_switches } from "./ui/switches.ts";

/** Opacity of the lights that cause a marked part of the sky. */
const SHOWN_INFLUENCE = 0.9;

/** What the sky of any place depends on. */
type Conditions = Omit<SkyParameters, "lat" | "lon">;

/** As requests have them. Five decimals are a metre; a link restores the very same request. */
function coordinates_of({ latitude_deg, longitude_deg }: Place): { lat: number; lon: number } {
  return { lat: +latitude_deg.toFixed(5), lon: +longitude_deg.toFixed(5) };
}

class Viewer {
  private state: ViewState = state_from_fragment(location.hash);
  private scenes: readonly Scene[] = [];
  private atmospheres: readonly Atmosphere[] = [];
  private places: readonly NamedPlace[] = [];
  private answer: SkyAnswer | null = null;
  /** What is pointed at in the sky. */
  private pointed: SkySample | null = null;
  private map: SkyMap | null = null;
  private scene_requests = new AbortController();

  private readonly notice = new Notice(by_id("notice", HTMLElement));
  private readonly site = by_id("site", HTMLElement);
  private readonly numbers = by_id("numbers", HTMLElement);
  private readonly numbers_card = by_id("numbers-card", HTMLElement);
  private readonly title = by_id("place-title", HTMLElement);
  private readonly legend = new Legend(by_id("legend", HTMLElement), by_id("legend-title", HTMLElement));
  private readonly sky_view = new SkyView(by_id("sky-view", HTMLElement), this.state, {
    pointed: (sample) => {
      this.pointed = sample;
      this.show_pointed();
    },
    gazed: (gaze) => {
      this.state = { ...this.state, gaze };
      this.write_url(false);
      this.show_links();
    },
    drawn: (region) => {
      this.marking.ended();
      if (region !== null) this.mark(region);
    },
  });
  private readonly marking = new Marking({
    draw: (on) => this.sky_view.set_drawing(on),
    unmark: () => this.mark(null),
  });
  private readonly search = new Search(by_id("search", HTMLInputElement), by_id("search-list", HTMLElement), (place) => {
    this.pick(place);
    this.map?.go_to(place);
  });
  private readonly controls = new Controls({
    scene: (scene) => this.change({ scene, place: null, scenario: null, view: null }, { push: true }),
    turbidity: (turbidity) => this.change({ turbidity }),
    scattering: (scattering) => this.change({ scattering, turbidity: turbidity_within(this.packs(), scattering, this.state.turbidity) }),
    clouds: (clouds) => this.choose_clouds(clouds),
    lamp: (lamp) => this.change({ lamp }),
    emission: (emission) => this.change({ emission }),
    terrain: (terrain) => this.change({ terrain }),
    lights: (lights) => this.change({ lights }),
    projection: (projection) => this.change({ projection }),
    sky: (sky) => this.change({ sky }),
    colours: (colours) => this.change({ colours }),
    exposure: (exposure_ev) => this.change({ exposure_ev }),
    unit: (unit) => this.change({ unit }),
    measure: (measure) => this.change({ measure }),
    layer: (layer, opacity) => this.change({ layers: { ...this.state.layers, [layer]: opacity } }),
  });
  private readonly session = new SkySession({
    started: () => this.set_busy(true),
    site: (site) => this.site_known(site),
    numbers: (answer) => {
      this.answer = answer;
      document.body.dataset["sky"] = "numbers";
      this.show_numbers();
    },
    picture: (grid, other) => {
      document.body.dataset["sky"] = "picture";
      this.sky_view.show(grid, other);
      this.show_links();
    },
    failed: (reason) => {
      this.forget_sky();
      this.notice.show(reason);
    },
    ended: () => this.set_busy(false),
  });

  /** Once the line rests. */
  private readonly write_split = debounced(300, () => this.write_url(false));

  private readonly lights = new Lights({
    chosen: (scenario, how) => this.change({ scenario, lights: this.state.lights === "both" ? "both" : "changed" }, how),
    settled: () => LAYERS.forEach((layer) => this.show_layer(layer)),
    failed: (reason) => this.notice.show(reason),
  });

  async start(): Promise<void> {
    wire_share(() => this.lights.lasting());
    wire_switches(() => this.map?.resize());
    wire_locate(
      (place) => {
        this.pick(place);
        this.map?.go_to(place);
      },
      (reason) => this.notice.show(reason),
    );
    const split = by_id("split", HTMLInputElement);
    split.addEventListener("input", () => this.set_split(Number(split.value) / 100));
    this.set_split(this.state.split);
    this.show_look();
    const { signal } = this.scene_requests;
    const map_code = import("./map/sky_map.ts");
    try {
      const [scenes, atmospheres] = await Promise.all([api.scenes(signal), api.atmospheres(signal)]);
      this.scenes = scenes;
      this.atmospheres = atmospheres;
      this.controls.set_scenes(scenes);
      this.controls.set_atmospheres(atmospheres);
      if (scenes.length === 0) {
        this.notice.show(new Error(words().problems.no_scenes));
      }
    } catch (reason) {
      this.notice.show(reason);
    }
    this.drop_absent_air();
    this.controls.show(this.state, null);
    await this.start_map(map_code);
    addEventListener("popstate", () => this.restore());
    if (this.scenes.length > 0) this.enter_scene();
  }

  /** Without WebGL there is no map, but the search box still picks places. */
  private async start_map(map_code: Promise<typeof import("./map/sky_map.ts")>): Promise<void> {
    try {
      const { SkyMap } = await map_code;
      this.map = this.new_map(SkyMap);
      this.lights.set_map(this.map);
    } catch (reason) {
      this.notice.show(new Error(words().problems.no_map(reason instanceof Error ? reason.message : String(reason))));
    }
  }

  private new_map(SkyMapClass: typeof SkyMap): SkyMap {
    return new SkyMapClass(by_id("map", HTMLElement), this.state.view, {
      picked: (place) => this.pick(place),
      painted: (area) => this.lights.painted(area),
      moved: (view) => {
        this.state = { ...this.state, view };
        this.write_url(false);
      },
      layer: show_layer_state,
      split: (part) => this.set_split(part),
      failed: (reason) => this.notice.show(reason),
    });
  }

  /** How far today's sky and map reach from the left, 0 to 1. */
  private set_split(part: number): void {
    const slider = by_id("split", HTMLInputElement);
    slider.value = String(Math.round(100 * part));
    slider.setAttribute("aria-valuetext", words().plan.percent(slider.value));
    this.sky_view.set_split(part);
    this.state = { ...this.state, split: part };
    this.compare();
    this.write_split();
  }

  private compare(): void {
    this.map?.compare(this.is_compared() ? this.state.split : null);
  }

  private scene(): Scene | null {
    return this.scenes.find(({ id }) => id === this.state.scene) ?? null;
  }

  /** Shows the state's scene, or the first where the state names none that exists. */
  private enter_scene(): void {
    if (this.state.scene !== null && this.scene() === null) {
      this.notice.show(new Error(words().problems.no_such_scene(this.state.scene, this.scenes[0]?.title ?? "")));
      this.state = { ...this.state, scene: null, place: null, scenario: null, view: null };
    }
    const scene = this.scene() ?? this.scenes[0];
    if (scene === undefined) return;
    this.state = { ...this.state, scene: scene.id };
    this.scene_requests.abort();
    this.scene_requests = new AbortController();
    this.places = [];
    this.search.set_places([]);
    void this.map?.show_scene(scene, this.state.view === null);
    void this.map?.show_places([]);
    const { signal } = this.scene_requests;
    api
      .places(scene.id, signal)
      .then((places) => {
        this.places = places;
        this.search.set_places(places);
        this.lights.set_places(places);
        this.show_title();
        return this.map?.show_places(places);
      })
      .catch((reason: unknown) => {
        if (!signal.aborted) this.notice.show(reason);
      });
    this.show_state();
    this.write_url(false);
  }

  /** The packs under the clouds of the state. */
  private packs(): Atmosphere[] {
    return packs_under(this.atmospheres, this.state.clouds);
  }

  /** Scattering and turbidity stay where the packs under these clouds serve them. */
  private choose_clouds(clouds: number | null): void {
    const packs = packs_under(this.atmospheres, clouds);
    const scattering = resident_scatterings(packs).find((name) => name === this.state.scattering) ?? null;
    const ends = turbidity_ends(packs, scattering);
    const wanted = this.state.turbidity ?? DEFAULT_TURBIDITY;
    const reached = ends !== null && wanted >= ends[0] && wanted <= ends[1];
    this.change({ clouds, scattering, turbidity: reached ? this.state.turbidity : turbidity_within(packs, scattering, wanted) });
  }

  /** A link may come from a server with other tables. */
  private drop_absent_air(): void {
    const { clouds } = this.state;
    if (clouds !== null && this.atmospheres.length > 0 && !cloud_bases(this.atmospheres).includes(clouds)) {
      this.notice.show(new Error(words().problems.no_clouds(clouds)));
      this.state = { ...this.state, clouds: null };
      this.write_url(false);
    }
    const { scattering } = this.state;
    const resident = resident_scatterings(this.packs());
    const best = resident[0];
    if (scattering === null || best === undefined || resident.includes(scattering)) return;
    this.notice.show(new Error(words().problems.no_scattering(scattering_title(scattering), scattering_title(best))));
    this.state = { ...this.state, scattering: null };
    this.write_url(false);
  }

  private pick(place: Place): void {
    this.notice.clear();
    this.change({ place }, { push: true });
  }

  private change(part: Partial<ViewState>, { push = false } = {}): void {
    const scene_before = this.state.scene;
    this.state = { ...this.state, ...part };
    this.write_url(push);
    if (this.state.scene !== scene_before) this.enter_scene();
    else this.show_state();
  }

  /** Back and forward, and fragments typed by hand. */
  private restore(): void {
    const scene_before = this.state.scene;
    this.state = state_from_fragment(location.hash);
    this.set_split(this.state.split);
    this.drop_absent_air();
    if (this.state.view !== null) this.map?.jump_to(this.state.view);
    if (this.state.scene !== scene_before) this.enter_scene();
    else this.show_state();
  }

  private show_state(): void {
    this.controls.show(this.state, this.scene());
    this.show_look();
    this.compare();
    for (const layer of LAYERS) this.show_layer(layer);
    this.map?.mark(this.state.place);
    this.show_title();
    const { scene, place, scenario, lights, region } = this.state;
    document.body.dataset["place"] = place === null ? "none" : "picked";
    const { scenario: _, ...conditions } = this.conditions();
    this.lights.show({ scene, place, scenario, lights, region, conditions });
    if (scene === null || place === null) {
      this.session.cancel();
      this.set_busy(false);
      this.forget_sky();
      return;
    }
    this.show_numbers();
    const parameters = this.parameters(place);
    this.show_links();
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
  private is_compared(): boolean {
    return this.state.scenario !== null && this.state.lights === "both";
  }

  private show_layer(layer: LayerName): void {
    const { scene, layers } = this.state;
    // Its sums take seconds: of plans that are only tried they are not asked for, and what is there stays.
    if (layer === "brightness" && layers.brightness > 0 && this.lights.is_trying()) return;
    const { scenario: _, ...today } = this.conditions();
    const wanted = (conditions: Conditions) => {
      const query = this.layer_query(layer, conditions);
      return scene === null || query === null ? null : { scene, query, opacity: layers[layer] };
    };
    this.map?.show_layer(layer, wanted(this.conditions()), this.is_compared() ? wanted(today) : null);
  }

  /** What a layer is asked for under such conditions; null where there is nothing to show. */
  private layer_query(layer: LayerName, conditions: Conditions): LayerQuery | null {
    const { place, clouds } = this.state;
    const { scenario } = conditions;
    return {
      elevation: this.scene()?.terrain === true ? {} : null,
      brightness: clouds === null ? conditions : null,
      radiance: scenario === undefined ? {} : { scenario },
      influence: place === null ? null : this.influence_query(place, conditions),
    }[layer];
  }

  private influence_query(place: Place, conditions: Conditions): InfluenceQuery {
    const { measure, region } = this.state;
    const marked = measure === "region" && region !== null ? { region: text_from_region(region) } : {};
    return { ...coordinates_of(place), ...conditions, measure, ...marked };
  }

  private parameters(place: Place): SkyParameters {
    return { ...coordinates_of(place), ...this.conditions() };
  }

  private conditions(): Conditions {
    const { turbidity, scattering, clouds, lamp, emission, terrain, scenario, lights } = this.state;
    const air = { ...(turbidity === null ? {} : { turbidity }), ...(scattering === null ? {} : { scattering }), ...(clouds === null ? {} : { clouds: String(clouds) }) };
    const ground = terrain === "on" ? {} : { terrain };
    const changed = scenario === null || lights === "today" ? {} : { scenario };
    return { lamp, emission, ...ground, ...air, ...changed };
  }

  private show_links(): void {
    const { scene, place } = this.state;
    if (scene === null || place === null) return;
    show_downloads(by_id("download-links", HTMLElement), scene, this.parameters(place), this.state, this.sky_view.view());
    show_influence_downloads(by_id("influence-links", HTMLElement), scene, this.influence_query(place, this.conditions()));
  }

  private show_look(): void {
    document.body.dataset["projection"] = this.state.projection;
    this.legend.show(this.state);
    this.sky_view.set_look(this.state);
    this.show_pointed();
    this.marking.show(this.state.region !== null);
  }

  private show_pointed(): void {
    const { pointed: sample } = this;
    show_readout(by_id("sky-readout", HTMLElement), sample, this.state.sky, this.state.unit);
    const shown = this.state.sky === "total" ? sample?.total_cd_m2 : sample?.artificial_cd_m2;
    this.legend.point(shown === undefined || sample?.is_below_horizon === true ? null : brightness_mag_arcsec2(shown));
  }

  private show_title(): void {
    const { place } = this.state;
    this.sky_view.set_towns(place, this.places);
    if (place === null) this.title.textContent = "";
    else {
      const name = place_name(place, this.places);
      const at = coordinates(place.latitude_deg, place.longitude_deg);
      this.title.replaceChildren(name, ...(name === at ? [] : [Object.assign(document.createElement("small"), { textContent: at })]));
    }
  }

  private site_known(site: Site): void {
    this.answer = null;
    this.numbers.replaceChildren();
    this.sky_view.show(null);
    document.body.dataset["sky"] = "site";
    show_site(this.site, site);
  }

  private show_numbers(): void {
    const scene = this.scene();
    if (this.answer !== null && scene !== null) show_numbers(this.numbers, this.answer, this.state.sky, this.state.unit, this.state.lamp, scene);
  }

  private forget_sky(): void {
    this.answer = null;
    document.body.dataset["sky"] = "none";
    this.site.replaceChildren();
    this.numbers.replaceChildren();
    this.sky_view.show(null);
  }

  private set_busy(busy: boolean): void {
    document.body.classList.toggle("busy", busy);
    this.numbers_card.setAttribute("aria-busy", String(busy));
  }

  private write_url(push: boolean): void {
    const fragment = fragment_from_state(this.state);
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

await choose_language();
void new Viewer().start();
