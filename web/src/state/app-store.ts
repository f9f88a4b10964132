// The viewer's store: what a link holds of its state is in the page's address, and comes back with the browser's history.

import { isWithoutAnswer, noAnswer } from "../api/problem.ts";
import { words } from "../language/words.ts";
import type { Region } from "../sky/region.ts";
import { Store } from "../store.ts";
import { debounced } from "../ui/dom.ts";
import { coordinates } from "../ui/format.ts";
import { type AppState, initialState, sceneFor } from "./app-state.ts";
import { fragmentFromState, stateFromFragment } from "./fragment.ts";
import { DEFAULT_STATE, type Place, withLayer } from "./view-state.ts";

/** What the browser's history brings back. How it is shown stays as it is: Back undoes a pick, and not the colours chosen after it. */
const STEPS = ["scene", "place", "scenario", "time", "region", "measure", "view", "isReport"] as const;
/** State of the entries in the browser's history that this page wrote: others are links, or typed by hand. */
const OWN_ENTRY = "skyglow";

/** Opacity of the lights that cause a marked part of the sky. */
const SHOWN_INFLUENCE = 0.9;
/** A line that is dragged is written into the address once it rests this long. */
const SPLIT_WAIT_MS = 300;

function fragmentWithoutSplit(state: Readonly<AppState>): string {
  return fragmentFromState({ ...state, split: DEFAULT_STATE.split });
}

export class AppStore extends Store<AppState> {
  /** Whether a link was followed while the page was open: pasted into its address, say. */
  isLinked = false;

  constructor() {
    super(initialState(stateFromFragment(location.hash)));
    this.watch([fragmentWithoutSplit], (state) => this.writeAddress(state, false));
    const writeSoon = debounced(SPLIT_WAIT_MS, () => this.writeAddress(this.state, false));
    this.watch(["split"], writeSoon);
    history.replaceState(OWN_ENTRY, "");
    // Back and forward, and fragments typed by hand.
    addEventListener("popstate", ({ state }) => {
      const view = stateFromFragment(location.hash);
      this.isLinked ||= state !== OWN_ENTRY && view.place !== null;
      this.set(state === OWN_ENTRY ? Object.fromEntries(STEPS.map((name) => [name, view[name]])) : view);
      history.replaceState(OWN_ENTRY, "");
    });
  }

  /** A change that is a step of its own in the browser's history. */
  push(part: Partial<AppState>): void {
    this.writeAddress({ ...this.state, ...part }, true);
    this.set(part);
  }

  /** Shows a place, in the scene that has it, and says whether it does: what is shown stays where there is none, or no server. */
  pick(place: Place): boolean {
    const { state } = this;
    // The list of packs comes with that of scenes.
    if (state.scenes.length === 0 && state.atmospheres.length > 0) {
      this.report(new Error(words().problems.noScenes));
      return false;
    }
    if (state.isAway && state.place !== null) {
      this.set({ problem: { reason: noAnswer() } });
      return false;
    }
    const scene = sceneFor(state, place);
    if (scene === null && state.scenes.length > 0) {
      this.report(new Error(words().top.noSceneCovers(coordinates(place.latitude_deg, place.longitude_deg))));
      return false;
    }
    const isOther = scene !== null && scene.id !== state.scene;
    this.push({ place, problem: null, ...(isOther ? { scene: scene.id, scenario: null } : {}) });
    return true;
  }

  /** Marks a part of the sky, and shows which lights cause it; null: no part. */
  markRegion(region: Region | null): void {
    const { layers, measure } = this.state;
    const influence = layers.influence === 0 ? SHOWN_INFLUENCE : layers.influence;
    if (region !== null) this.push({ region, measure: "region", layers: withLayer(layers, "influence", influence) });
    else this.push({ region, measure: measure === "region" ? "zenith" : measure });
  }

  /** Tells what went wrong. That the server does not answer is told once, and nothing else that follows from it. */
  report(reason: unknown): void {
    const isAway = isWithoutAnswer(reason);
    if (isAway && this.state.isAway) return;
    this.set({ problem: { reason }, ...(isAway ? { isAway } : {}) });
  }

  private writeAddress(state: Readonly<AppState>, push: boolean): void {
    const fragment = fragmentFromState(state);
    if (fragment === location.hash) return;
    const url = `${location.pathname}${location.search}${fragment}`;
    try {
      if (push) history.pushState(OWN_ENTRY, "", url);
      else history.replaceState(OWN_ENTRY, "", url);
    } catch {
      // Some browsers take no more than some changes of the address in a while; the next one has it all.
    }
  }
}
