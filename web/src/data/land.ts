// The land in light, where someone asks for it: what fetches and draws it is loaded then.

import { noAnswer } from "../api/problem.ts";
import { landOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";

export function followLand(store: AppStore): void {
  let isAsked = false;
  store.watch([landOf, "isAway"], (state) => {
    if (isAsked || state.isAway || landOf(state) === "dark") return;
    isAsked = true;
    import("./land-session.ts")
      .then(({ LandSession }) => new LandSession(store))
      .catch(() => {
        isAsked = false;
        store.report(noAnswer());
      });
  });
}
