// The report over the page: it follows the state, prints as A4, and is saved as a page of its own.

import { api } from "../api/client.ts";
import { isWithoutAnswer } from "../api/problem.ts";
import { reportWords, words } from "../language/words.ts";
import type { Lights } from "../lights/lights.ts";
import { type AppState, landOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { byId, make, saveFile } from "../ui/dom.ts";
import { reportDocument, reportTitle } from "./document.ts";
import css from "./report.css?inline";
import { loadReport, type ReportData, reportRequest } from "./report-data.ts";
import { savedPage } from "./saved-page.ts";

/** Characters that file names cannot have. */
const NOT_IN_NAMES = /[\\/:*?"<>|]/g;

/** All that a report depends on. */
function keyOf(state: Readonly<AppState>): string {
  const { scenario, areas, colours, exposureEv, sky, unit, change } = state;
  const look = [colours, exposureEv, landOf(state), sky, unit];
  return JSON.stringify([reportRequest(state), scenario, areas?.fileName, ...look, change === null]);
}

export class Report {
  private readonly root = make("section", "report");
  private readonly content = make("div", "report-content");
  private readonly save = this.button("quiet", reportWords().report.save);
  private readonly print = this.button("strong", reportWords().report.print);
  private requests = new AbortController();
  private shownKey = "";
  private data: ReportData | null = null;

  constructor(
    private readonly store: AppStore,
    private readonly lights: Lights,
  ) {
    const style = new CSSStyleSheet();
    style.replaceSync(css);
    document.adoptedStyleSheets = [...document.adoptedStyleSheets, style];
    const close = this.button("quiet", reportWords().report.close);
    close.addEventListener("click", () => this.store.push({ isReport: false }));
    this.print.addEventListener("click", () => window.print());
    this.save.addEventListener("click", () => void this.saveAsPage().catch((reason: unknown) => store.report(reason)));
    this.root.id = "report";
    this.root.tabIndex = -1;
    this.root.setAttribute("role", "dialog");
    this.root.setAttribute("aria-modal", "true");
    this.root.setAttribute("aria-labelledby", "report-title");
    this.root.append(make("div", "report-bar", close, this.save, this.print), this.content);
    addEventListener("keydown", ({ key }) => {
      if (key === "Escape" && this.store.state.isReport) this.store.push({ isReport: false });
    });
    document.body.append(this.root);
    store.watch([keyOf, "isReport", "isTrying", "isAway", "places"], (state) => void this.follow(state));
  }

  private button(kind: string, title: string): HTMLButtonElement {
    const button = make("button", kind, title) as HTMLButtonElement;
    button.type = "button";
    return button;
  }

  private async follow(state: Readonly<AppState>): Promise<void> {
    const isShown = state.isReport && reportRequest(state) !== null;
    this.setShown(isShown);
    if (!isShown || state.isTrying || state.isAway) return;
    const key = keyOf(state);
    if (key === this.shownKey) {
      this.show();
      return;
    }
    this.requests.abort();
    this.requests = new AbortController();
    const { signal } = this.requests;
    this.shownKey = key;
    this.data = null;
    this.show();
    try {
      // A link to a plan that is only tried would be dead within minutes.
      await this.lights.lasting();
      const data = await loadReport(state, signal);
      if (signal.aborted) return;
      this.data = data;
      this.show();
    } catch (reason) {
      if (signal.aborted) return;
      this.shownKey = "";
      // What went wrong is told on the page below.
      if (!isWithoutAnswer(reason)) this.store.set({ isReport: false });
      this.store.report(reason);
    }
  }

  /** The page below rests while the report is shown. */
  private setShown(isShown: boolean): void {
    const { body } = document;
    if (body.classList.contains("reporting") === isShown) return;
    body.classList.toggle("reporting", isShown);
    this.root.hidden = !isShown;
    for (const element of body.children) if (element !== this.root) element.toggleAttribute("inert", isShown);
    if (isShown) {
      this.root.scrollTop = 0;
      this.root.focus({ preventScroll: true });
    } else byId("report-open", HTMLButtonElement).focus({ preventScroll: true });
  }

  private show(): void {
    const { data } = this;
    this.save.disabled = this.print.disabled = data === null;
    this.root.setAttribute("aria-busy", String(data === null));
    if (data === null) {
      const waiting = make("p", "report-waiting", reportWords().report.waiting);
      waiting.id = "report-title";
      this.content.replaceChildren(waiting);
      return;
    }
    const { state } = this.store;
    const link = new URL(location.href);
    link.hash = link.hash.replace(/&?report=on/, "");
    const { places, change } = state;
    this.content.replaceChildren(reportDocument(data, state, { places, change, madeMs: Date.now(), link: link.href }));
  }

  private async saveAsPage(): Promise<void> {
    const paper = this.content.firstElementChild;
    if (this.data === null || !(paper instanceof HTMLElement)) return;
    const title = reportTitle(this.data, this.store.state.places);
    const { signal } = this.requests;
    const page = await savedPage(paper, { title, language: words().locale, css }, (url) => api.picture(url, signal));
    saveFile(page, `${title.replaceAll(NOT_IN_NAMES, " ")}.html`);
  }
}
