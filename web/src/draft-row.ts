// Plans that are tried one after the other, as sliders move: the server only holds them, and the one that the row ends with is
// kept. Until then its link would be dead within minutes.

import { debounced } from "./ui/dom.ts";

/** A plan that is shown and not kept yet: asks for it again, to be kept. */
export type Draft = () => Promise<unknown>;

export interface DraftRowEvents {
  failed: (reason: unknown) => void;
  /** The last of a row is kept, or could not be. */
  ended: () => void;
}

/** A row ends when nothing is tried for so long. */
const ENDS_AFTER_MS = 1500;

export class DraftRow {
  private draft: Draft | null = null;
  private keeping: Promise<boolean> = Promise.resolve(true);
  private readonly endSoon: ReturnType<typeof debounced<[]>>;

  constructor(
    private readonly events: DraftRowEvents,
    endsAfterMs = ENDS_AFTER_MS,
  ) {
    this.endSoon = debounced(endsAfterMs, () => void this.end());
  }

  /** Whether a plan is shown that is not kept yet. */
  isOpen(): boolean {
    return this.draft !== null;
  }

  /** The next of the row. */
  goOn(draft: Draft): void {
    this.draft = draft;
    this.endSoon();
  }

  /** Ends the row and keeps the last of it; whether all that was tried last is kept. */
  end(): Promise<boolean> {
    this.endSoon.cancel();
    const { draft } = this;
    if (draft === null) return this.keeping;
    this.draft = null;
    const keeping = draft().then(
      () => true,
      (reason: unknown) => {
        this.events.failed(reason);
        return false;
      },
    );
    this.keeping = keeping;
    void keeping.then(() => {
      // A failure is told to those who waited for it, and to nobody later.
      if (this.keeping === keeping) this.keeping = Promise.resolve(true);
      this.events.ended();
    });
    return keeping;
  }
}
