// What if the lights were others: what a stroke on the map does, and what all of them do.

import type { Scenario } from "../api/types.ts";
import { placeWords } from "../language/words.ts";
import type { Lights } from "../lights/lights.ts";
import { type PaintChange, type Painting, type PaintKind, withRedo, withUndo } from "../lights/painting.ts";
import type { Brush } from "../map/painter.ts";
import { baseOf, type Comparison, scenarioOf } from "../state/app-state.ts";
import type { AppStore } from "../state/app-store.ts";
import { baseNote, changeOf, comparisonRows } from "./comparison.ts";
import { byId, make } from "./dom.ts";
import { bothWithPrefix, whole } from "./format.ts";
import { wireGroup } from "./group.ts";
import { emissions, lampGroups, lamps, lampsIn, lampTitle } from "./lamps.ts";
import { fillGroups, fillSelect } from "./select.ts";

const KINDS: readonly PaintKind[] = ["factor", "lamp", "emission", "add"];

export class PaintCard {
  private readonly kind = byId("paint-kind", HTMLSelectElement);
  private readonly factor = byId("paint-factor", HTMLInputElement);
  private readonly add = byId("paint-add", HTMLInputElement);
  private readonly lamp = byId("paint-lamp", HTMLSelectElement);
  private readonly lampFrom = byId("paint-lamp-from", HTMLSelectElement);
  private readonly emission = byId("paint-emission", HTMLSelectElement);
  private readonly radius = byId("paint-radius", HTMLInputElement);
  private readonly draw = byId("paint-draw", HTMLButtonElement);
  private readonly undo = byId("paint-undo", HTMLButtonElement);
  private readonly redo = byId("paint-redo", HTMLButtonElement);
  private readonly clear = byId("paint-clear", HTMLButtonElement);
  private readonly title = byId("paint-title", HTMLInputElement);
  private readonly answer = byId("paint-answer", HTMLElement);
  private shape: Brush["shape"] = "brush";
  private isPainting = false;

  constructor(
    private readonly store: AppStore,
    lights: Lights,
  ) {
    fillGroups(this.lamp, lampGroups(), "pc_amber", lampTitle);
    fillSelect(this.emission, emissions(), "full_cutoff");
    const press = wireGroup<Brush["shape"]>("paint-shape", (shape) => {
      this.shape = shape;
      this.update();
    });
    press(this.shape);
    for (const control of [this.kind, this.factor, this.add, this.radius]) control.addEventListener("input", () => this.update());
    this.draw.addEventListener("click", () => {
      this.setPainting(!this.isPainting);
      if (this.isPainting) byId("map-area", HTMLElement).scrollIntoView({ block: "nearest" });
    });
    addEventListener("keydown", ({ key }) => {
      if (key === "Escape") this.setPainting(false);
    });
    byId("paint-stop", HTMLButtonElement).addEventListener("click", () => {
      this.setPainting(false);
      this.draw.scrollIntoView({ block: "center" });
    });
    this.undo.addEventListener("click", () => lights.repaint(withUndo(store.state.painting)));
    this.redo.addEventListener("click", () => lights.repaint(withRedo(store.state.painting)));
    this.clear.addEventListener("click", () => lights.clear());
    this.title.addEventListener("change", () => lights.repaint({ ...store.state.painting, title: this.title.value.trim() }));
    this.update();
    store.watch(["place"], ({ place }) => {
      if (place === null) this.setPainting(false);
    });
    store.watch(["painting", "lamp"], ({ painting, lamp }) => this.showLamps(lamp, painting));
    store.watch(["painting"], ({ painting }) => this.showPainting(painting));
    store.watch([scenarioOf, "comparison"], (state) => {
      this.showScenario(scenarioOf(state), state.comparison, baseOf(state));
    });
  }

  /** What a stroke does to the lights below it. */
  change(): PaintChange {
    return {
      kind: KINDS.find((kind) => kind === this.kind.value) ?? "factor",
      factor: Number(this.factor.value) / 100,
      lamp: this.lamp.value,
      lampFrom: this.lampFrom.value === "" ? null : this.lampFrom.value,
      emission: this.emission.value,
      addRadianceNwCm2Sr: Number(this.add.value),
    };
  }

  /** Offers the lamps that can be replaced: those assumed where nobody painted, and those painted before. */
  private showLamps(assumed: string, painting: Painting): void {
    const painted = painting.done.flatMap(({ lamp }) =>
      typeof lamp === "object" && lamp !== null && "to" in lamp ? [lamp.to] : [lamp],
    );
    const there = [...lampsIn(assumed), ...painted];
    const options = [["", placeWords().paint.allLamps] as const, ...lamps().filter(([name]) => there.includes(name))];
    const isSame =
      options.length === this.lampFrom.options.length && options.every(([name], i) => this.lampFrom.options[i]?.value === name);
    if (isSame) return;
    const before = this.lampFrom.value;
    this.lampFrom.replaceChildren(...options.map(([name, title]) => new Option(title, name, false, name === before)));
  }

  private setPainting(on: boolean): void {
    if (on === this.isPainting) return;
    this.isPainting = on;
    this.update();
  }

  private showPainting({ done, undone, title }: Painting): void {
    const isEmpty = done.length === 0;
    this.undo.disabled = isEmpty;
    this.redo.disabled = undone.length === 0;
    this.clear.disabled = isEmpty;
    byId("paint-title-field", HTMLElement).hidden = isEmpty;
    if (document.activeElement !== this.title) this.title.value = title;
  }

  private showScenario(scenario: Scenario | null, comparison: Comparison | null, base: string | null): void {
    if (scenario === null) {
      this.answer.replaceChildren();
      return;
    }
    const { changed_pixels, new_pixels, flux_before_dnb_w, flux_after_dnb_w } = scenario;
    const change = changeOf(flux_before_dnb_w, flux_after_dnb_w);
    const [from, to, unit] = bothWithPrefix(flux_before_dnb_w, flux_after_dnb_w, "W");
    const { changed, changedSomeDark, upward, againstToday } = placeWords().paint;
    const pixels = new_pixels > 0 ? changedSomeDark(whole(changed_pixels), whole(new_pixels)) : changed(whole(changed_pixels));
    const sentences = `${pixels}. ${upward(from, `${to} ${unit}`)}${change === null ? "" : ` (${change})`}.`;
    // The server tells them with what is painted over.
    const lights = make("p", "", base === null ? sentences : `${againstToday} ${sentences}`);
    const note = baseNote(base);
    const rows = comparison === null ? [] : [...comparisonRows(comparison), ...(note === "" ? [] : [make("p", "lead", note)])];
    this.answer.replaceChildren(...rows, lights);
  }

  private update(): void {
    for (const kind of KINDS) byId(`paint-${kind}-field`, HTMLElement).hidden = kind !== this.kind.value;
    byId("paint-radius-field", HTMLElement).hidden = this.shape !== "brush";
    const say = (input: HTMLInputElement, text: string) => {
      byId(`${input.id}-value`, HTMLOutputElement).value = text;
      input.setAttribute("aria-valuetext", text);
    };
    say(this.factor, this.factor.value === "0" ? placeWords().paint.switchedOff : `${this.factor.value} %`);
    say(this.add, `${this.add.value} nW/cm²/sr`);
    say(this.radius, `${this.radius.value} km`);
    this.draw.setAttribute("aria-pressed", String(this.isPainting));
    this.draw.textContent = this.isPainting ? placeWords().paint.stop : placeWords().paint.draw;
    byId("paint-stop", HTMLButtonElement).hidden = !this.isPainting;
    byId("paint-hint", HTMLElement).textContent = this.isPainting ? placeWords().paint.hint : "";
    this.store.set({ brush: this.isPainting ? { shape: this.shape, radiusM: 1000 * Number(this.radius.value) } : null });
  }
}
