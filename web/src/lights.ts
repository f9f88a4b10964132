// Other lights than the scene's: plans that are looked for, edits that are painted over the map.

import { api, type PlanQuery } from "./api/client.ts";
import { ApiError } from "./api/problem.ts";
import type { EditBody } from "./api/schema.ts";
import type { NamedPlace, Plan } from "./api/types.ts";
import { DraftRow } from "./draft-row.ts";
import { words } from "./language/words.ts";
import type { Brush } from "./map/painter.ts";
import type { SkyMap } from "./map/sky-map.ts";
import { editFrom, type PaintedArea, Painting } from "./painting.ts";
import { type Change, idOf, Planning, type PlanRequest } from "./planning.ts";
import type { Region } from "./sky/region.ts";
import type { LightsKind, Place } from "./state.ts";
import { byId } from "./ui/dom.ts";
import { PaintCard } from "./ui/paint-card.ts";
import { PlanCard } from "./ui/plan-card.ts";

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
  private shownDimmed: Plan | null = null;
  private shownEdits: readonly EditBody[] = NO_EDITS;

  private readonly planCard = new PlanCard({
    find: (wish, keep) => void this.find(wish, keep),
    drop: () => this.drop(),
  });
  private readonly paintCard = new PaintCard({
    brush: (brush) => {
      this.brush = brush;
      this.map?.setBrush(brush);
    },
    started: () => byId("map-area", HTMLElement).scrollIntoView({ block: "nearest" }),
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
      this.planCard.searching(on);
      this.showChange();
    },
    found: (change, keep) => {
      // All of a row are one step in the browser's history.
      const push = keep === null || !this.row.isOpen();
      if (keep === null) {
        void this.row.end();
        this.showWish(change);
      } else {
        // A slider that goes on moving is not put back to where it was.
        this.row.goOn(keep);
      }
      this.choose(idOf(change), push);
      this.showChange();
    },
    loaded: (change) => {
      this.showWish(change);
      // Whoever painted before it was there painted over it.
      if (change.kind === "scenario" && !this.painting.canUndo()) {
        this.painting.load(change.scenario);
        this.accepted = this.painting.snapshot();
      }
      this.showChange();
    },
    failed: (reason, what) => {
      this.events.failed(reason);
      const isGone = reason instanceof ApiError && GONE.includes(reason.status);
      if (what === "load" && isGone) this.choose(null);
      this.showChange();
    },
  });

  constructor(private readonly events: LightsEvents) {}

  setMap(map: SkyMap): void {
    this.map = map;
    map.setBrush(this.brush);
    this.showChange();
  }

  setPlaces(places: readonly NamedPlace[]): void {
    this.places = places;
    this.showChange();
  }

  /** Follows the state. */
  show(context: LightsContext): void {
    const { scene, place, scenario, region } = context;
    const isOtherScene = scene !== this.context?.scene;
    this.context = context;
    this.planCard.setRegion(region);
    if (place === null) this.paintCard.setPainting(false);
    if (isOtherScene || scenario !== this.own) {
      // A link, the way back, or a plan: what was painted before is none of it.
      this.forgetPainting(scenario);
    }
    const key = this.searchKey();
    if (key !== this.key || scenario !== this.expected) this.endSearch();
    this.key = key;
    this.expected = scenario;
    void this.planning.show(scenario);
    this.showChange();
  }

  /** A stroke on the map. */
  painted(area: PaintedArea): void {
    const scenario = this.context?.scenario ?? null;
    if (this.painting.isFull()) {
      this.events.failed(new Error(words().paint.full));
      return;
    }
    this.repaint(() => {
      if (!this.painting.canUndo() && !this.painting.canRedo()) this.painting.base = scenario;
      this.painting.add(editFrom(area, this.paintCard.change()));
    });
  }

  private async find(wish: PlanRequest, isKept: boolean): Promise<void> {
    // It goes on from the last stroke, too.
    await this.kept;
    if (this.context === null) return;
    const { scene, place, conditions } = this.context;
    if (scene === null || place === null) return;
    await this.planning.find(scene, place, { ...conditions, ...this.paintedBefore() }, wish, isKept);
  }

  /** A plan goes on from what was painted, never from another plan, but from what that went on from. */
  private paintedBefore(): { scenario?: string } {
    const change = this.planning.change();
    const shown = this.context?.scenario ?? null;
    const scenario = change?.kind === "plan" && change.plan.id === shown ? (change.plan.sites[0]?.scenario ?? null) : shown;
    return scenario?.startsWith("s-") === true ? { scenario } : {};
  }

  /** All that a search depends on. */
  private searchKey(): string {
    const { scene, place, conditions } = this.context ?? {};
    return JSON.stringify([scene, place, conditions, this.paintedBefore()]);
  }

  private showWish(change: Change): void {
    if (change.kind === "plan") this.planCard.showWish(change.plan);
  }

  /** What is painted is none of these lights. */
  private forgetPainting(scenario: string | null): void {
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
  private endSearch(): void {
    this.planning.stopSearch();
    this.planCard.rest();
    void this.row.end();
  }

  /** Whether the plan that is shown is one of many that are tried. */
  isTrying(): boolean {
    return this.row.isOpen();
  }

  /** When a link to what is shown will last; whether it will. */
  lasting(): Promise<boolean> {
    return this.row.end();
  }

  private drop(): void {
    this.endSearch();
    this.forgetPainting(null);
    this.choose(null);
  }

  private clear(): void {
    const { base } = this.painting;
    this.endSearch();
    this.forgetPainting(base);
    this.choose(base);
  }

  /** Changes what is painted, and shows the lights that it makes. */
  private repaint(change: () => void): void {
    change();
    this.showChange();
    this.kept = this.keep();
  }

  private async keep(): Promise<void> {
    this.keeping.abort();
    this.keeping = new AbortController();
    const { signal } = this.keeping;
    const scene = this.context?.scene;
    if (scene == null) return;
    if (!this.painting.canUndo()) {
      this.accepted = this.painting.snapshot();
      this.own = this.painting.base;
      this.choose(this.painting.base);
      return;
    }
    try {
      // What is kept stands on what is kept.
      const isLasting = await this.lasting();
      if (signal.aborted) return;
      if (!isLasting) {
        this.painting.restore(this.accepted);
        this.showChange();
        return;
      }
      const scenario = await api.storeScenario(scene, this.painting.body(), signal);
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
      this.showChange();
    }
  }

  /** What is said of the change of lights, and where it is; of what is the same as before nothing is touched. */
  private showChange(): void {
    const change = this.planning.change();
    const plan = change?.kind === "plan" ? change.plan : null;
    const scenario = change?.kind === "scenario" ? change.scenario : null;
    const shown = this.context?.lights !== "today";
    this.planCard.show(plan, this.places);
    this.paintCard.show(this.painting, scenario, this.context?.conditions.lamp ?? "mixed");
    byId("lights-changed", HTMLButtonElement).textContent = scenario === null ? words().sky.withPlan : words().sky.asPainted;
    const dimmed = shown ? plan : null;
    const edits = shown ? this.painting.edits() : NO_EDITS;
    if (this.map === null) return;
    if (dimmed !== this.shownDimmed) void this.map.showDimmed(dimmed?.pixels ?? []);
    if (edits !== this.shownEdits) void this.map.showPainted(edits);
    this.shownDimmed = dimmed;
    this.shownEdits = edits;
  }
}
