// Other lights than the scene's: plans that are looked for, and edits that are painted over the map.

import { api } from "../api/client.ts";
import { ApiError } from "../api/problem.ts";
import type { EditBody } from "../api/schema.ts";
import type { Plan } from "../api/types.ts";
import { placeWords } from "../language/words.ts";
import { type AppState, CONDITIONS, sceneOf, todaysConditions } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { debounced } from "../ui/dom.ts";
import { ChangeLoader } from "./change-loader.ts";
import {
  EMPTY_PAINTING,
  editFrom,
  isFull,
  type PaintChange,
  type PaintedArea,
  type Painting,
  paintingFromScenario,
  scenarioBody,
  withEdit,
} from "./painting.ts";
import { type Change, idOf, type PlanRequest } from "./plan-request.ts";
import { PlanSearch } from "./plan-search.ts";
import { PlanTrial, type StorePlan } from "./plan-trial.ts";

/** Statuses of a plan or scenario that no longer exists. */
const GONE: readonly number[] = [404, 409, 410];
/** A slider at rest for this long is tried. */
const TRIED_AFTER_MS = 120;

export class Lights {
  private scene: string | null = null;
  /** Key of all that a search depends on. */
  private searchKey = "";
  /** The lights that were chosen here last: others come from elsewhere. */
  private expected: string | null = null;
  /** What the painting last made of the state's scenario: another one comes from elsewhere. */
  private painted: string | null = null;
  /** The painting that the server last accepted. */
  private accepted: Painting = EMPTY_PAINTING;
  private storing = new AbortController();
  /** When the last stroke is stored, or refused. */
  private stored: Promise<void> = Promise.resolve();
  private readonly trial = new PlanTrial({
    failed: (reason) => this.store.report(reason),
    ended: () => this.store.set({ isTrying: this.trial.isOpen() }),
  });
  private readonly search = new PlanSearch({
    searching: (isSearching) => this.store.set({ isSearching }),
    found: (plan, storePlan) => this.found(plan, storePlan),
    failed: (reason) => this.store.report(reason),
  });
  private readonly loader = new ChangeLoader({
    loaded: (change) => this.loaded(change),
    failed: (reason) => {
      this.store.report(reason);
      if (reason instanceof ApiError && GONE.includes(reason.status)) this.choose(null);
    },
  });
  private readonly trySoon = debounced(TRIED_AFTER_MS, (request: PlanRequest) => void this.findPlan(request, false));

  constructor(private readonly store: AppStore) {
    store.watch([sceneOf, "place", ...CONDITIONS], (state) => {
      const scene = sceneOf(state);
      if (scene !== null) this.follow(scene.id);
    });
  }

  /** Looks for a plan, and stores it. */
  find(request: PlanRequest): void {
    this.stopTrying();
    void this.findPlan(request, true);
  }

  /** Looks for a plan of many that are only tried. */
  try(request: PlanRequest): void {
    this.trySoon(request);
  }

  /** Cancels the request of a slider that has just moved. */
  stopTrying(): void {
    this.trySoon.cancel();
  }

  /** When a link to what is shown will last; whether it will. */
  lasting(): Promise<boolean> {
    return this.trial.end();
  }

  /** Back to the lights of today. */
  drop(): void {
    this.endSearch();
    this.forgetPainting(null);
    this.choose(null);
  }

  /** A stroke on the map. */
  paint(area: PaintedArea, change: PaintChange): void {
    const { painting, scenario } = this.store.state;
    if (isFull(painting)) {
      this.store.report(new Error(placeWords().paint.full));
      return;
    }
    const isFirst = painting.done.length === 0 && painting.undone.length === 0;
    this.repaint(withEdit(isFirst ? { ...painting, base: scenario } : painting, editFrom(area, change)));
  }

  /** A measure; it takes the place of the one before, where that was the last. */
  apply(measure: EditBody, before: EditBody | null): void {
    const { painting, scenario } = this.store.state;
    const isAgain = before !== null && painting.done.at(-1) === before;
    const done = isAgain ? painting.done.slice(0, -1) : painting.done;
    if (isFull({ ...painting, done })) {
      this.store.report(new Error(placeWords().paint.full));
      return;
    }
    const isFirst = painting.done.length === 0 && painting.undone.length === 0;
    this.repaint(withEdit({ ...painting, done, ...(isFirst ? { base: scenario } : {}) }, measure));
  }

  /** Takes back all that is painted. */
  clear(): void {
    const { base } = this.store.state.painting;
    this.endSearch();
    this.forgetPainting(base);
    this.choose(base);
  }

  /** Changes what is painted, and shows the lights that it makes. */
  repaint(painting: Painting): void {
    this.store.set({ painting });
    this.stored = this.storePainting();
  }

  private follow(scene: string): void {
    const { scenario, change } = this.store.state;
    // A link, the way back, or a plan: what was painted before is none of it.
    if (scene !== this.scene || scenario !== this.painted) this.forgetPainting(scenario);
    this.scene = scene;
    const { place } = this.store.state;
    const key = JSON.stringify([scene, place, todaysConditions(this.store.state), this.paintedBefore()]);
    if (key !== this.searchKey || scenario !== this.expected) this.endSearch();
    this.searchKey = key;
    this.expected = scenario;
    if (scenario !== null && (this.loader.isLoading(scenario) || (change !== null && idOf(change) === scenario))) return;
    this.loader.stop();
    this.store.set({ change: null });
    if (scenario !== null) void this.loader.load(scenario);
  }

  private async findPlan(request: PlanRequest, isStored: boolean): Promise<void> {
    // It goes on from the last stroke, too.
    await this.stored;
    const { scene, place } = this.store.state;
    if (scene === null || place === null) return;
    const conditions = { ...todaysConditions(this.store.state), ...this.paintedBefore() };
    await this.search.find(scene, place, conditions, request, isStored);
  }

  /** A plan goes on from what was painted, never from another plan, but from what that went on from. */
  private paintedBefore(): { scenario?: string } {
    const { change, scenario: shown } = this.store.state;
    const scenario = change?.kind === "plan" && change.plan.id === shown ? (change.plan.sites[0]?.scenario ?? null) : shown;
    return scenario?.startsWith("s-") === true ? { scenario } : {};
  }

  private found(plan: Plan, storePlan: StorePlan | null): void {
    // All of a row are one step in the browser's history.
    const push = storePlan === null || !this.trial.isOpen();
    if (storePlan === null) void this.trial.end();
    else this.trial.next(storePlan);
    this.loader.stop();
    this.choose(plan.id, { change: { kind: "plan", plan } }, push);
  }

  private loaded(change: Change): void {
    // What was painted before it came is painted over it.
    const isPainted = change.kind === "scenario" && this.store.state.painting.done.length === 0;
    if (isPainted) this.accepted = paintingFromScenario(change.scenario);
    this.store.set({ change, isTrying: this.trial.isOpen(), ...(isPainted ? { painting: this.accepted } : {}) });
  }

  /** What is painted is none of these lights. */
  private forgetPainting(scenario: string | null): void {
    this.storing.abort();
    this.accepted = EMPTY_PAINTING;
    this.painted = scenario;
    this.store.set({ painting: EMPTY_PAINTING });
  }

  /** Shows these lights; without `push` they take the place of those before in the browser's history. */
  private choose(scenario: string | null, part: Partial<AppState> = {}, push = true): void {
    this.expected = scenario;
    const lights = this.store.state.lights === "both" ? "both" : "changed";
    const chosen = { ...part, scenario, lights, isTrying: this.trial.isOpen() } as const;
    if (push) this.store.push(chosen);
    else this.store.set(chosen);
  }

  /** Ends a search. The last plan that was tried stays in the browser's history, so it is stored. */
  private endSearch(): void {
    this.search.stop();
    this.stopTrying();
    void this.trial.end();
  }

  private async storePainting(): Promise<void> {
    this.storing.abort();
    this.storing = new AbortController();
    const { signal } = this.storing;
    const { scene, painting } = this.store.state;
    if (scene === null) return;
    if (painting.done.length === 0) {
      this.accepted = painting;
      this.painted = painting.base;
      this.choose(painting.base);
      return;
    }
    try {
      // What is stored stands on what is stored.
      const isLasting = await this.lasting();
      if (signal.aborted) return;
      if (!isLasting) {
        this.store.set({ painting: this.accepted });
        return;
      }
      const scenario = await api.storeScenario(scene, scenarioBody(painting), signal);
      if (signal.aborted) return;
      this.accepted = painting;
      this.painted = scenario.id;
      this.loader.stop();
      this.choose(scenario.id, { change: { kind: "scenario", scenario } });
    } catch (reason) {
      if (signal.aborted) return;
      // What the server refused is taken back.
      this.store.set({ painting: this.accepted });
      this.store.report(reason);
    }
  }
}
