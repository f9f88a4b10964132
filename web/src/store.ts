// A store with subscriptions: components watch the parts of the state that they show.

/** A field of the state, or what is made of it. */
export type Part<S> = keyof S | ((state: Readonly<S>) => unknown);

/** A state that is replaced, never changed in place, and those who watch it. */
export class Store<S extends object> {
  private readonly watchers = new Set<() => void>();
  private isNotifying = false;
  private isStale = false;

  constructor(private current: Readonly<S>) {}

  get state(): Readonly<S> {
    return this.current;
  }

  /** Replaces parts of the state, and notifies who watches one of them. A watcher may set the state again. */
  set(part: Partial<S>): void {
    this.current = { ...this.current, ...part };
    this.isStale = true;
    if (this.isNotifying) return;
    this.isNotifying = true;
    try {
      while (this.isStale) {
        this.isStale = false;
        for (const notify of this.watchers) notify();
      }
    } finally {
      this.isNotifying = false;
    }
  }

  /** Calls now, and whenever one of these parts is another than before; earlier watchers come first. */
  watch(parts: readonly Part<S>[], changed: (state: Readonly<S>) => void): void {
    let before: unknown[] | null = null;
    const notify = () => {
      const state = this.current;
      const now = parts.map((part) => (typeof part === "function" ? part(state) : state[part]));
      if (before !== null && now.every((value, i) => Object.is(value, before?.[i]))) return;
      before = now;
      changed(state);
    };
    this.watchers.add(notify);
    notify();
  }
}
