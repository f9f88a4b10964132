// Other lights than the scene's: plans that are looked for, edits that are painted over the map.

import { api, type PlanQuery } from "./api/client.ts";
import type { NamedPlace } from "./api/types.ts";
import type { Brush } from "./map/painter.ts";
import type { SkyMap } from "./map/sky_map.ts";
import { edit_from, Painting, type PaintedArea } from "./painting.ts";
import { Planning, type Change, type PlanWish } from "./planning.ts";
import type { Region } from "./sky/region.ts";
import type { LightsKind, Place } from "./state.ts";
import { by_id } from "./ui/dom.ts";
import { PaintCard } from "./ui/paint_card.ts";
import { PlanCard } from "./ui/plan_card.ts";

/** What other lights are looked for under. */
export interface LightsContext {
  scene: string | null;
  place: Place | null;
  /** Id of the plan or scenario that is shown. */
  scenario: string | null;
  lights: LightsKind;
  region: Region | null;
  /** Air, lamps and terrain, without a scenario. */
  conditions: Omit<PlanQuery, "limit" | "scenario">;
}

export interface LightsEvents {
  /** These lights are to be shown; null: those of today. */
  chosen: (scenario: string | null) => void;
  failed: (reason: unknown) => void;
}

export class Lights {
  private context: LightsContext | null = null;
  private map: SkyMap | null = null;
  private brush: Brush | null = null;
  private places: readonly NamedPlace[] = [];
  private readonly painting = new Painting();
  /** What the painting last made of the state's scenario: another one comes from elsewhere. */
  private own: string | null = null;
  private keeping = new AbortController();

  private readonly plan_card = new PlanCard({
    find: (wish) => this.find(wish),
    drop: () => this.events.chosen(null),
  });
  private readonly paint_card = new PaintCard({
    brush: (brush) => {
      this.brush = brush;
      this.map?.set_brush(brush);
      if (brush !== null) by_id("map-area", HTMLElement).scrollIntoView({ block: "nearest" });
    },
    undo: () => this.repaint(() => this.painting.undo()),
    redo: () => this.repaint(() => this.painting.redo()),
    clear: () => this.clear(),
    title: (title) =>
      this.repaint(() => {
        this.painting.title = title;
      }),
  });
  private readonly planning = new Planning({
    searching: () => this.plan_card.searching(),
    found: (change) => this.found(change),
    failed: (reason) => {
      this.events.failed(reason);
      if (this.planning.change() === null && this.context?.scenario != null) this.events.chosen(null);
      this.show_change();
    },
  });

  constructor(private readonly events: LightsEvents) {}

  set_map(map: SkyMap): void {
    this.map = map;
    map.set_brush(this.brush);
    this.show_change();
  }

  set_places(places: readonly NamedPlace[]): void {
    this.places = places;
    this.show_change();
  }

  /** Follows the state. */
  show(context: LightsContext): void {
    const { scene, place, scenario, region } = context;
    if (scene !== this.context?.scene) this.painting.clear();
    this.context = context;
    this.plan_card.set_region(region);
    if (place === null) this.paint_card.set_painting(false);
    if (scenario !== this.own) {
      // A link, the way back, or a plan: what was painted before is none of it.
      this.painting.clear();
      this.own = scenario;
    }
    if (scenario === null) this.planning.cancel();
    else void this.planning.show(scenario);
    this.show_change();
  }

  /** A stroke on the map. */
  painted(area: PaintedArea): void {
    const scenario = this.context?.scenario ?? null;
    if (this.painting.is_full()) {
      this.events.failed(new Error("A scenario holds at most a hundred edits. Undo some, or begin anew."));
      return;
    }
    this.repaint(() => {
      if (!this.painting.can_undo() && !this.painting.can_redo()) this.painting.base = scenario;
      this.painting.add(edit_from(area, this.paint_card.change()));
    });
  }

  private find(wish: PlanWish): void {
    if (this.context === null) return;
    const { scene, place, scenario, conditions } = this.context;
    if (scene === null || place === null) return;
    // A plan goes on from what was painted, never from another plan.
    const painted = scenario?.startsWith("s-") === true ? { scenario } : {};
    void this.planning.find(scene, place, { ...conditions, ...painted }, wish);
  }

  private found(change: Change): void {
    if (change.kind === "plan") {
      this.plan_card.show_wish(change.plan);
      // A plan that was looked for is not in the link yet.
      if (this.context?.scenario !== change.plan.id) this.events.chosen(change.plan.id);
    } else {
      this.painting.load(change.scenario);
    }
    this.show_change();
  }

  private clear(): void {
    const { base } = this.painting;
    this.keeping.abort();
    this.painting.clear();
    this.own = base;
    this.events.chosen(base);
  }

  /** Changes what is painted, and shows the lights that it makes. */
  private repaint(change: () => void): void {
    change();
    this.show_change();
    void this.keep();
  }

  private async keep(): Promise<void> {
    this.keeping.abort();
    this.keeping = new AbortController();
    const { signal } = this.keeping;
    const scene = this.context?.scene;
    if (scene == null) return;
    if (!this.painting.can_undo()) {
      this.own = this.painting.base;
      this.events.chosen(this.painting.base);
      return;
    }
    try {
      const scenario = await api.paint(scene, this.painting.body(), signal);
      this.planning.adopt({ kind: "scenario", scenario });
      this.own = scenario.id;
      this.events.chosen(scenario.id);
    } catch (reason) {
      if (signal.aborted) return;
      // The stroke that the server refused is taken back.
      this.painting.undo();
      this.events.failed(reason);
      this.show_change();
    }
  }

  /** What is said of the change of lights, and where it is. */
  private show_change(): void {
    const change = this.planning.change();
    const plan = change?.kind === "plan" ? change.plan : null;
    const scenario = change?.kind === "scenario" ? change.scenario : null;
    if (!this.planning.is_searching()) this.plan_card.show(plan, this.places);
    this.paint_card.show(this.painting, scenario);
    by_id("lights-changed", HTMLButtonElement).textContent = scenario === null ? "With the plan" : "As painted";
    const shown = this.context?.lights !== "today";
    void this.map?.show_dimmed(shown && plan !== null ? plan.pixels : []);
    void this.map?.show_painted(shown ? this.painting.edits() : []);
  }
}
