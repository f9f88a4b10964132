// The viewer's store: what a link holds of its state is in the page's address, and comes back with the browser's history.

import type { Region } from "../sky/region.ts";
import { Store } from "../store.ts";
import { debounced } from "../ui/dom.ts";
import { type AppState, initialState } from "./app-state.ts";
import { fragmentFromState, stateFromFragment } from "./fragment.ts";
import { DEFAULT_STATE, type Place } from "./view-state.ts";

/** Opacity of the lights that cause a marked part of the sky. */
const SHOWN_INFLUENCE = 0.9;
/** A line that is dragged is written into the address once it rests this long. */
const SPLIT_WAIT_MS = 300;

function fragmentWithoutSplit(state: Readonly<AppState>): string {
  return fragmentFromState({ ...state, split: DEFAULT_STATE.split });
}

export class AppStore extends Store<AppState> {
  constructor() {
    super(initialState(stateFromFragment(location.hash)));
    this.watch([fragmentWithoutSplit], (state) => this.writeAddress(state, false));
    const writeSoon = debounced(SPLIT_WAIT_MS, () => this.writeAddress(this.state, false));
    this.watch(["split"], writeSoon);
    // Back and forward, and fragments typed by hand.
    addEventListener("popstate", () => this.set(stateFromFragment(location.hash)));
  }

  /** A change that is a step of its own in the browser's history. */
  push(part: Partial<AppState>): void {
    this.writeAddress({ ...this.state, ...part }, true);
    this.set(part);
  }

  pick(place: Place): void {
    this.push({ place, problem: null });
  }

  /** Marks a part of the sky, and shows which lights cause it; null: no part. */
  markRegion(region: Region | null): void {
    const { layers, measure } = this.state;
    const influence = layers.influence === 0 ? SHOWN_INFLUENCE : layers.influence;
    if (region !== null) this.push({ region, measure: "region", layers: { ...layers, influence } });
    else this.push({ region, measure: measure === "region" ? "zenith" : measure });
  }

  report(reason: unknown): void {
    this.set({ problem: { reason } });
  }

  private writeAddress(state: Readonly<AppState>, push: boolean): void {
    const fragment = fragmentFromState(state);
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
