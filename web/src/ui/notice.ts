// One place for what went wrong, in plain words.

import { describeProblem } from "../api/problem.ts";
import { words } from "../language/words.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, make, told } from "./dom.ts";

export function mountNotice(store: AppStore): void {
  const container = byId("notice", HTMLElement);
  store.watch(["problem"], ({ problem }) => {
    container.hidden = problem === null;
    if (problem === null) {
      container.replaceChildren();
      return;
    }
    const { headline, sentences } = describeProblem(problem.reason);
    const close = make("button", "notice-close", "×") as HTMLButtonElement;
    close.type = "button";
    close.setAttribute("aria-label", words().problems.close);
    close.addEventListener("click", () => store.set({ problem: null }));
    const text = [told("strong", "", headline), ...sentences.map((sentence) => told("p", "", sentence))];
    container.replaceChildren(make("div", "notice-text", ...text), close);
  });
}
