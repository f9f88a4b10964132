// The plan or scenario that the state names, fetched again after a reload.

import { api } from "../api/client.ts";
import { type Change, LISTED_PIXELS } from "./plan-request.ts";

export interface ChangeLoaderEvents {
  loaded: (change: Change) => void;
  failed: (reason: unknown) => void;
}

export class ChangeLoader {
  private current: { id: string; controller: AbortController } | null = null;

  constructor(private readonly events: ChangeLoaderEvents) {}

  /** Whether that change is on its way. */
  isLoading(id: string): boolean {
    return this.current?.id === id;
  }

  async load(id: string): Promise<void> {
    this.stop();
    const controller = new AbortController();
    const { signal } = controller;
    this.current = { id, controller };
    try {
      const change: Change = id.startsWith("p-")
        ? { kind: "plan", plan: await api.plan(id, LISTED_PIXELS, signal) }
        : { kind: "scenario", scenario: await api.scenario(id, signal) };
      if (signal.aborted) return;
      this.current = null;
      this.events.loaded(change);
    } catch (reason) {
      if (signal.aborted) return;
      // The same request is then a new try.
      this.current = null;
      this.events.failed(reason);
    }
  }

  stop(): void {
    this.current?.controller.abort();
    this.current = null;
  }
}
