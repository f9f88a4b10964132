// The way to a report of the picked place, which comes with the first of them.

import { noAnswer } from "../api/problem.ts";
import { loadWords } from "../language/words.ts";
import type { Lights } from "../lights/lights.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId } from "./dom.ts";

export function mountReportButton(store: AppStore, lights: Lights): void {
  byId("report-open", HTMLButtonElement).addEventListener("click", () => store.push({ isReport: true }));
  let isAsked = false;
  store.watch(["isReport", "place", "isAway"], ({ isReport, place, isAway }) => {
    if (!isReport || place === null || isAway || isAsked) return;
    isAsked = true;
    Promise.all([import("../report/report.ts"), loadWords("report")])
      .then(([{ Report }]) => new Report(store, lights))
      .catch(() => {
        isAsked = false;
        store.report(noAnswer());
      });
  });
}
