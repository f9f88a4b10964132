// Plans that are tried one after the other, as sliders move: the server only holds them for minutes, and the one that the row ends
// with is stored. Until then its link would soon be dead.

import { debounced } from "../ui/dom.ts";

/** Asks again for a plan that is shown and not stored yet, to be stored. */
export type StorePlan = () => Promise<unknown>;

export interface PlanTrialEvents {
  failed: (reason: unknown) => void;
  /** The last plan is stored, or could not be. */
  ended: () => void;
}

/** A row of plans ends when nothing is tried for so long. */
const ENDS_AFTER_MS = 1500;

export class PlanTrial {
  private storeLast: StorePlan | null = null;
  private storing: Promise<boolean> = Promise.resolve(true);
  private readonly endSoon: ReturnType<typeof debounced<[]>>;

  constructor(
    private readonly events: PlanTrialEvents,
    endsAfterMs = ENDS_AFTER_MS,
  ) {
    this.endSoon = debounced(endsAfterMs, () => void this.end());
  }

  /** Whether a plan is shown that is not stored yet. */
  isOpen(): boolean {
    return this.storeLast !== null;
  }

  /** The next plan of the row. */
  next(storePlan: StorePlan): void {
    this.storeLast = storePlan;
    this.endSoon();
  }

  /** Ends the row and stores the last of it; whether all that was tried last is stored. */
  end(): Promise<boolean> {
    this.endSoon.cancel();
    const { storeLast } = this;
    if (storeLast === null) return this.storing;
    this.storeLast = null;
    const storing = storeLast().then(
      () => true,
      (reason: unknown) => {
        this.events.failed(reason);
        return false;
      },
    );
    this.storing = storing;
    void storing.then(() => {
      // Those who waited for it hear of a failure, and nobody later.
      if (this.storing === storing) this.storing = Promise.resolve(true);
      this.events.ended();
    });
    return storing;
  }
}
