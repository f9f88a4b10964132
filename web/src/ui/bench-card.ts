// The lamp workbench: a measure for towns and areas, and what it does to the sky of the place.

import type { EditBody } from "../api/schema.ts";
import { placeWords } from "../language/words.ts";
import type { Lights } from "../lights/lights.ts";
import { energyRatio, type MeasureChange, measureEdit, nightAfter } from "../lights/measure.ts";
import { withUndo } from "../lights/painting.ts";
import { type AppState, baseOf, scenarioOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import type { Place } from "../state/view-state.ts";
import { changeTable } from "./change-table.ts";
import { baseNote, colourNote } from "./comparison.ts";
import { byId, make } from "./dom.ts";
import { percent, whole } from "./format.ts";
import { emissions, lampGroups, lamps, lampsIn, lampTitle } from "./lamps.ts";
import { fillGroups, fillSelect } from "./select.ts";

/** Towns that are offered, those of the largest shares. */
const OFFERED_TOWNS = 6;
const OFFERED_AREAS = 40;

/** Hours by the Sun after which lamps may be dimmed, from noon on: 25 is one o'clock. */
const CURFEWS = [22, 23, 24, 25] as const;
const HOUR_MS = 3_600_000;

function hourTitle(hour: number): string {
  return `${String(hour % 24).padStart(2, "0")}:00`;
}

/** Hours of sunset and sunrise by the Sun; of a night that is not known, or has none, those of the equinox. */
function nightHours({ night, place }: Readonly<AppState>): [number, number] {
  const { set_utc = null, rise_utc = null } = night?.sun ?? {};
  if (set_utc === null || rise_utc === null || place === null) return [18, 6];
  const bySun = (utc: string) => (Date.parse(utc) / HOUR_MS + place.longitude_deg / 15) % 24;
  return [bySun(set_utc), bySun(rise_utc)];
}

/** Where the measure can hold. */
type Where = { key: string; title: string } & ({ town: Place } | { feature: unknown });

/** The number of an input; null where there is none. */
function numberOf(input: HTMLInputElement): number | null {
  const value = input.valueAsNumber;
  return Number.isFinite(value) && value > 0 ? value : null;
}

function chosenOf(select: HTMLSelectElement): string | null {
  return select.value === "" ? null : select.value;
}

export class BenchCard {
  private readonly list = byId("bench-where", HTMLElement);
  private readonly radius = byId("bench-radius", HTMLInputElement);
  private readonly from = byId("bench-from", HTMLSelectElement);
  private readonly to = byId("bench-to", HTMLSelectElement);
  private readonly shielding = byId("bench-shielding", HTMLSelectElement);
  private readonly dimmed = byId("bench-dimmed", HTMLInputElement);
  private readonly curfew = byId("bench-curfew", HTMLSelectElement);
  private readonly hint = byId("bench-hint", HTMLElement);
  private readonly answer = byId("bench-answer", HTMLElement);
  private places: readonly Where[] = [];
  private readonly chosen = new Set<string>();
  /** Of which place the towns are. */
  private townsOf: Place | null = null;
  /** What was applied last, and what it changes. */
  private applied: { edit: EditBody; change: MeasureChange; curfew: string | null } | null = null;

  constructor(
    private readonly store: AppStore,
    private readonly lights: Lights,
  ) {
    const { bench } = placeWords();
    fillGroups(this.to, [{ title: "", choices: [["", bench.sameLamps]] }, ...lampGroups()], "", lampTitle);
    fillSelect(this.shielding, [["", bench.sameShielding], ...emissions()], "");
    fillSelect(
      this.curfew,
      [["", bench.curfewNone], ...CURFEWS.map((hour): [string, string] => [String(hour), bench.curfewFrom(hourTitle(hour))])],
      "",
    );
    for (const slider of [this.radius, this.dimmed]) slider.addEventListener("input", () => this.showValues());
    for (const id of ["bench-efficacy-before", "bench-efficacy-after"])
      byId(id, HTMLInputElement).addEventListener("input", () => this.showAnswer(store.state));
    this.shielding.addEventListener("change", () => this.say(this.shielding.value === "" ? "" : bench.shieldedKeep));
    byId("bench-apply", HTMLButtonElement).addEventListener("click", () => this.apply());
    this.showValues();
    store.watch(["lamp"], ({ lamp }) => {
      const there = lamps().filter(([name]) => lampsIn(lamp).includes(name));
      const before = this.from.value;
      const isThere = there.some(([name]) => name === before);
      fillSelect(this.from, [["", placeWords().paint.allLamps], ...there], isThere ? before : "");
    });
    store.watch(["shares", "areas", "areaShares"], (state) => this.offer(state));
    store.watch(["painting", "comparison", scenarioOf], (state) => this.showAnswer(state));
  }

  /** Offers the towns of the sky as it is, and the areas of a file. */
  private offer({ place, shares, scenario, lights, areas, areaShares }: Readonly<AppState>): void {
    const { bench } = placeWords();
    const isToday = scenario === null || lights === "today";
    const isNew = place !== this.townsOf;
    const towns =
      shares !== null && (isToday || isNew)
        ? shares.places.slice(0, OFFERED_TOWNS).map((town): Where => {
            const { latitude_deg, longitude_deg, name, share } = town;
            const title = bench.town(name, percent(share));
            return { key: `town ${latitude_deg} ${longitude_deg}`, title, town: { latitude_deg, longitude_deg } };
          })
        : this.places.filter((where) => "town" in where);
    if (isNew && shares !== null) {
      this.townsOf = place;
      this.chosen.clear();
      const [first] = towns;
      if (first !== undefined) this.chosen.add(first.key);
    }
    const features = (areas?.body as { features?: readonly unknown[] } | undefined)?.features ?? [];
    const areasOfFile = (areaShares?.areas ?? []).slice(0, OFFERED_AREAS).map(
      ({ feature, name, share }): Where => ({
        key: `area ${areas?.fileName} ${feature}`,
        title: bench.area(name, percent(share)),
        feature: features[feature - 1],
      }),
    );
    this.places = [...towns, ...areasOfFile];
    const [legend] = this.list.querySelectorAll("legend");
    this.list.replaceChildren(...(legend === undefined ? [] : [legend]), ...this.places.map((where) => this.box(where)));
  }

  private box({ key, title }: Where): HTMLElement {
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = this.chosen.has(key);
    box.addEventListener("change", () => {
      if (box.checked) this.chosen.add(key);
      else this.chosen.delete(key);
    });
    return make("label", "", box, make("span", "", title));
  }

  private change(): MeasureChange {
    return {
      lampFrom: chosenOf(this.from),
      lampTo: chosenOf(this.to),
      emission: chosenOf(this.shielding),
      lightLeft: 1 - Number(this.dimmed.value) / 100,
      nightPart: this.curfew.value === "" ? 1 : nightAfter(Number(this.curfew.value), nightHours(this.store.state)),
    };
  }

  private apply(): void {
    const { bench } = placeWords();
    const there = this.places.filter(({ key }) => this.chosen.has(key));
    const area = {
      towns: there.flatMap((where) => ("town" in where ? [where.town] : [])),
      radiusM: 1000 * Number(this.radius.value),
      features: there.flatMap((where) => ("feature" in where ? [where.feature] : [])),
    };
    const change = this.change();
    const edit = measureEdit(area, change);
    if (edit === null) {
      this.say(there.length === 0 ? bench.nowhere : bench.nothing);
      return;
    }
    this.say("");
    const before = this.applied?.edit ?? null;
    this.applied = { edit, change, curfew: change.lightLeft < 1 ? chosenOf(this.curfew) : null };
    this.lights.apply(edit, before);
  }

  /** What the measure changes, where it is what was applied last. */
  private showAnswer(state: Readonly<AppState>): void {
    const { applied } = this;
    const { painting, comparison } = state;
    const scenario = scenarioOf(state);
    const isOurs = applied !== null && painting.done.at(-1) === applied.edit;
    if (!isOurs || comparison === null || scenario === null) {
      this.answer.replaceChildren();
      return;
    }
    const { before, after } = comparison;
    const efficacies = {
      before: numberOf(byId("bench-efficacy-before", HTMLInputElement)),
      after: numberOf(byId("bench-efficacy-after", HTMLInputElement)),
    };
    const base = baseOf(state);
    const { together } = placeWords().comparison;
    const known = {
      // The server has them with what the measure lies on.
      fluxesDnbW: base === null ? ([scenario.flux_before_dnb_w, scenario.flux_after_dnb_w] as const) : null,
      // Of several measures nobody knows whose energy it is.
      energyRatio: painting.done.length === 1 ? energyRatio(applied.change, efficacies) : null,
    };
    const count = painting.done.length;
    const { bench } = placeWords();
    const { curfew, change } = applied;
    const told = curfew === null ? "" : bench.curfewTold(hourTitle(Number(curfew)), percent(change.nightPart));
    const notes = [told, baseNote(base), count > 1 ? together(whole(count)) : "", colourNote(before, after)];
    const undo = make("button", "quiet", bench.undo) as HTMLButtonElement;
    undo.type = "button";
    undo.addEventListener("click", () => this.lights.repaint(withUndo(this.store.state.painting)));
    this.answer.replaceChildren(
      changeTable(before, after, known),
      ...notes.filter((note) => note !== "").map((note) => make("p", "lead", note)),
      make("div", "buttons", undo),
    );
  }

  private say(text: string): void {
    this.hint.textContent = text;
  }

  private showValues(): void {
    const show = (slider: HTMLInputElement, text: string) => {
      byId(`${slider.id}-value`, HTMLOutputElement).value = text;
      slider.setAttribute("aria-valuetext", text);
    };
    show(this.radius, `${this.radius.value} km`);
    show(this.dimmed, `${this.dimmed.value} %`);
  }
}
