// Other lights than the scene's: plans that are looked for, edits that are painted over the map.

import { api, type PlanQuery } from "./api/client.ts";
import { ApiError } from "./api/problem.ts";
import type { EditBody } from "./api/schema.ts";
import type { NamedPlace, Plan } from "./api/types.ts";
import { words } from "./language/words.ts";
import type { Brush } from "./map/painter.ts";
import type { SkyMap } from "./map/sky_map.ts";
import { edit_from, Painting, type PaintedArea } from "./painting.ts";
import { DraftRow } from "./draft_row.ts";
import { id_of, Planning, type Change, type PlanWish } from "./planning.ts";
import type { Region } from "./sky/region.ts";
import type { LightsKind, Place } from "./state.ts";
import { by_id } from "./ui/dom.ts";
import { PaintCard } from "./ui/paint_card.ts";
import { PlanCard } from "./ui/plan_card.ts";

/** Answers that say that a plan or scenario is not there any more. */
const GONE: readonly number[] = [404, 409, 410];
const NO_EDITS: readonly EditBody[] = [];

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
  /** These lights are to be shown; null: those of today. Without `push` they take the place of those before in the browser's history. */
  chosen: (scenario: string | null, how: { push: boolean }) => void;
  /** No plan is tried any more: what is made of others alone can be asked for. */
  settled: () => void;
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
  /** When the last stroke is kept, or refused. */
  private kept: Promise<void> = Promise.resolve();
  /** What the server last took. */
  private accepted = this.painting.snapshot();
  /** What searches depend on, as it was shown last. */
  private key = "";
  /** The lights that were chosen here last: others come from elsewhere. */
  private expected: string | null = null;
  private readonly row = new DraftRow({
    failed: (reason) => this.events.failed(reason),
    ended: () => this.events.settled(),
  });
  private shown_dimmed: Plan | null = null;
  private shown_edits: readonly EditBody[] = NO_EDITS;

  private readonly plan_card = new PlanCard({
    find: (wish, keep) => void this.find(wish, keep),
    drop: () => this.drop(),
  });
  private readonly paint_card = new PaintCard({
    brush: (brush) => {
      this.brush = brush;
      this.map?.set_brush(brush);
    },
    started: () => by_id("map-area", HTMLElement).scrollIntoView({ block: "nearest" }),
    undo: () => this.repaint(() => this.painting.undo()),
    redo: () => this.repaint(() => this.painting.redo()),
    clear: () => this.clear(),
    title: (title) =>
      this.repaint(() => {
        this.painting.title = title;
      }),
  });
  private readonly planning = new Planning({
    searching: (on) => {
      this.plan_card.searching(on);
      this.show_change();
    },
    found: (change, keep) => {
      // All of a row are one step in the browser's history.
      const push = keep === null || !this.row.is_open();
      if (keep === null) {
        void this.row.end();
        this.show_wish(change);
      } else {
        // A slider that goes on moving is not put back to where it was.
        this.row.go_on(keep);
      }
      this.choose(id_of(change), push);
      this.show_change();
    },
    loaded: (change) => {
      this.show_wish(change);
      // Whoever painted before it was there painted over it.
      if (change.kind === "scenario" && !this.painting.can_undo()) {
        this.painting.load(change.scenario);
        this.accepted = this.painting.snapshot();
      }
      this.show_change();
    },
    failed: (reason, what) => {
      this.events.failed(reason);
      const is_gone = reason instanceof ApiError && GONE.includes(reason.status);
      if (what === "load" && is_gone) this.choose(null);
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
    const is_other_scene = scene !== this.context?.scene;
    this.context = context;
    this.plan_card.set_region(region);
    if (place === null) this.paint_card.set_painting(false);
    if (is_other_scene || scenario !== this.own) {
      // A link, the way back, or a plan: what was painted before is none of it.
      this.forget_painting(scenario);
    }
    const key = this.search_key();
    if (key !== this.key || scenario !== this.expected) this.end_search();
    this.key = key;
    this.expected = scenario;
    void this.planning.show(scenario);
    this.show_change();
  }

  /** A stroke on the map. */
  painted(area: PaintedArea): void {
    const scenario = this.context?.scenario ?? null;
    if (this.painting.is_full()) {
      this.events.failed(new Error(words().paint.full));
      return;
    }
    this.repaint(() => {
      if (!this.painting.can_undo() && !this.painting.can_redo()) this.painting.base = scenario;
      this.painting.add(edit_from(area, this.paint_card.change()));
    });
  }

  private async find(wish: PlanWish, is_kept: boolean): Promise<void> {
    // It goes on from the last stroke, too.
    await this.kept;
    if (this.context === null) return;
    const { scene, place, conditions } = this.context;
    if (scene === null || place === null) return;
    await this.planning.find(scene, place, { ...conditions, ...this.painted_before() }, wish, is_kept);
  }

  /** A plan goes on from what was painted, never from another plan, but from what that went on from. */
  private painted_before(): { scenario?: string } {
    const change = this.planning.change();
    const shown = this.context?.scenario ?? null;
    const scenario = change?.kind === "plan" && change.plan.id === shown ? (change.plan.sites[0]?.scenario ?? null) : shown;
    return scenario?.startsWith("s-") === true ? { scenario } : {};
  }

  /** All that a search depends on. */
  private search_key(): string {
    const { scene, place, conditions } = this.context ?? {};
    return JSON.stringify([scene, place, conditions, this.painted_before()]);
  }

  private show_wish(change: Change): void {
    if (change.kind === "plan") this.plan_card.show_wish(change.plan);
  }

  /** What is painted is none of these lights. */
  private forget_painting(scenario: string | null): void {
    this.keeping.abort();
    this.painting.clear();
    this.accepted = this.painting.snapshot();
    this.own = scenario;
  }

  /** Shows these lights; without `push` they take the place of those before in the browser's history. */
  private choose(scenario: string | null, push = true): void {
    this.expected = scenario;
    this.events.chosen(scenario, { push });
  }

  /** What is looked for is no longer wanted; what was tried last stays in the browser's history, so it is kept. */
  private end_search(): void {
    this.planning.stop_search();
    this.plan_card.rest();
    void this.row.end();
  }

  /** Whether the plan that is shown is one of many that are tried. */
  is_trying(): boolean {
    return this.row.is_open();
  }

  /** When a link to what is shown will last; whether it will. */
  lasting(): Promise<boolean> {
    return this.row.end();
  }

  private drop(): void {
    this.end_search();
    this.forget_painting(null);
    this.choose(null);
  }

  private clear(): void {
    const { base } = this.painting;
    this.end_search();
    this.forget_painting(base);
    this.choose(base);
  }

  /** Changes what is painted, and shows the lights that it makes. */
  private repaint(change: () => void): void {
    change();
    this.show_change();
    this.kept = this.keep();
  }

  private async keep(): Promise<void> {
    this.keeping.abort();
    this.keeping = new AbortController();
    const { signal } = this.keeping;
    const scene = this.context?.scene;
    if (scene == null) return;
    if (!this.painting.can_undo()) {
      this.accepted = this.painting.snapshot();
      this.own = this.painting.base;
      this.choose(this.painting.base);
      return;
    }
    try {
      // What is kept stands on what is kept.
      const is_lasting = await this.lasting();
      if (signal.aborted) return;
      if (!is_lasting) {
        this.painting.restore(this.accepted);
        this.show_change();
        return;
      }
      const scenario = await api.paint(scene, this.painting.body(), signal);
      if (signal.aborted) return;
      this.accepted = this.painting.snapshot();
      this.planning.adopt({ kind: "scenario", scenario });
      this.own = scenario.id;
      this.choose(scenario.id);
    } catch (reason) {
      if (signal.aborted) return;
      // What the server refused is taken back.
      this.painting.restore(this.accepted);
      this.events.failed(reason);
      this.show_change();
    }
  }

  /** What is said of the change of lights, and where it is; of what is the same as before nothing is touched. */
  private show_change(): void {
    const change = this.planning.change();
    const plan = change?.kind === "plan" ? change.plan : null;
    const scenario = change?.kind === "scenario" ? change.scenario : null;
    const shown = this.context?.lights !== "today";
    this.plan_card.show(plan, this.places);
    this.paint_card.show(this.painting, scenario, this.context?.conditions.lamp ?? "mixed");
    by_id("lights-changed", HTMLButtonElement).textContent = scenario === null ? words().sky.with_plan : words().sky.as_painted;
    const dimmed = shown ? plan : null;
    const edits = shown ? this.painting.edits() : NO_EDITS;
    if (this.map === null) return;
    if (dimmed !== this.shown_dimmed) void this.map.show_dimmed(dimmed?.pixels ?? []);
    if (edits !== this.shown_edits) void this.map.show_painted(edits);
    this.shown_dimmed = dimmed;
    this.shown_edits = edits;
  }
}
