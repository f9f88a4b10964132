// What if the lights were others: what a stroke on the map does, and what all of them do.

import type { Scenario } from "../api/types.ts";
import { words } from "../language/words.ts";
import type { Brush } from "../map/painter.ts";
import type { PaintChange, PaintKind, Painting } from "../painting.ts";
import { by_id, make } from "./dom.ts";
import { fixed, whole, with_prefix } from "./format.ts";
import { wire_group } from "./group.ts";
import { emissions, lamps, lamps_in } from "./lamps.ts";

export interface PaintCardEvents {
  /** The brush that strokes on the map paint with; null: none. */
  brush: (brush: Brush | null) => void;
  /** Somebody begins to paint. */
  started: () => void;
  undo: () => void;
  redo: () => void;
  clear: () => void;
  title: (title: string) => void;
}

const KINDS: readonly PaintKind[] = ["factor", "lamp", "emission", "add"];

function flux(flux_dnb_w: number): string {
  return with_prefix(flux_dnb_w, "W");
}

export class PaintCard {
  private readonly kind = by_id("paint-kind", HTMLSelectElement);
  private readonly factor = by_id("paint-factor", HTMLInputElement);
  private readonly add = by_id("paint-add", HTMLInputElement);
  private readonly lamp = by_id("paint-lamp", HTMLSelectElement);
  private readonly lamp_from = by_id("paint-lamp-from", HTMLSelectElement);
  private readonly emission = by_id("paint-emission", HTMLSelectElement);
  private readonly radius = by_id("paint-radius", HTMLInputElement);
  private readonly draw = by_id("paint-draw", HTMLButtonElement);
  private readonly undo = by_id("paint-undo", HTMLButtonElement);
  private readonly redo = by_id("paint-redo", HTMLButtonElement);
  private readonly clear = by_id("paint-clear", HTMLButtonElement);
  private readonly title = by_id("paint-title", HTMLInputElement);
  private readonly answer = by_id("paint-answer", HTMLElement);
  private shape: Brush["shape"] = "brush";
  private painting = false;

  constructor(private readonly events: PaintCardEvents) {
    for (const [select, options] of [[this.lamp, lamps()], [this.emission, emissions()]] as const) {
      select.replaceChildren(...options.map(([name, title]) => new Option(title, name)));
    }
    this.lamp.value = "pc_amber";
    this.emission.value = "shielded";
    const press = wire_group<Brush["shape"]>("paint-shape", (shape) => {
      this.shape = shape;
      this.update();
    });
    press(this.shape);
    for (const control of [this.kind, this.factor, this.add, this.radius]) control.addEventListener("input", () => this.update());
    this.draw.addEventListener("click", () => {
      this.set_painting(!this.painting);
      if (this.painting) events.started();
    });
    this.undo.addEventListener("click", () => events.undo());
    this.redo.addEventListener("click", () => events.redo());
    this.clear.addEventListener("click", () => events.clear());
    this.title.addEventListener("change", () => events.title(this.title.value.trim()));
    this.update();
  }

  /** What a stroke does to the lights below it. */
  change(): PaintChange {
    return {
      kind: KINDS.find((kind) => kind === this.kind.value) ?? "factor",
      factor: Number(this.factor.value) / 100,
      lamp: this.lamp.value,
      lamp_from: this.lamp_from.value === "" ? null : this.lamp_from.value,
      emission: this.emission.value,
      add_radiance_nw_cm2_sr: Number(this.add.value),
    };
  }

  /** Offers the lamps that can be replaced: those assumed, and those painted before. */
  private show_lamps(assumed: string, painting: Painting): void {
    const painted = painting.edits().flatMap(({ lamp }) => (typeof lamp === "object" && lamp !== null && "to" in lamp ? [lamp.to] : [lamp]));
    const there = [...lamps_in(assumed), ...painted];
    const options = [["", words().paint.all_lamps] as const, ...lamps().filter(([name]) => there.includes(name))];
    const is_same = options.length === this.lamp_from.options.length && options.every(([name], i) => this.lamp_from.options[i]?.value === name);
    if (is_same) return;
    const before = this.lamp_from.value;
    this.lamp_from.replaceChildren(...options.map(([name, title]) => new Option(title, name, false, name === before)));
  }

  set_painting(on: boolean): void {
    if (on === this.painting) return;
    this.painting = on;
    this.update();
  }

  /** `assumed`: the lamps of the lights that nobody painted. */
  show(painting: Painting, scenario: Scenario | null, assumed: string): void {
    this.show_lamps(assumed, painting);
    this.undo.disabled = !painting.can_undo();
    this.redo.disabled = !painting.can_redo();
    this.clear.disabled = !painting.can_undo();
    by_id("paint-title-field", HTMLElement).hidden = !painting.can_undo();
    if (document.activeElement !== this.title) this.title.value = painting.title;
    if (scenario === null) {
      this.answer.replaceChildren();
      return;
    }
    const { changed_pixels, new_pixels, flux_before_dnb_w, flux_after_dnb_w } = scenario;
    const change = flux_before_dnb_w > 0 ? (100 * (flux_after_dnb_w - flux_before_dnb_w)) / flux_before_dnb_w : NaN;
    const share = Number.isFinite(change) ? ` (${change > 0 ? "+" : ""}${fixed(change, Math.abs(change) < 9.95 ? 1 : 0)} %)` : "";
    const { changed, changed_some_dark, upward } = words().paint;
    const pixels = new_pixels > 0 ? changed_some_dark(whole(changed_pixels), whole(new_pixels)) : changed(whole(changed_pixels));
    this.answer.replaceChildren(make("p", "", `${pixels}. ${upward(flux(flux_before_dnb_w), flux(flux_after_dnb_w))}${share}.`));
  }

  private update(): void {
    for (const kind of KINDS) by_id(`paint-${kind}-field`, HTMLElement).hidden = kind !== this.kind.value;
    by_id("paint-radius-field", HTMLElement).hidden = this.shape !== "brush";
    const say = (input: HTMLInputElement, text: string) => {
      by_id(`${input.id}-value`, HTMLOutputElement).value = text;
      input.setAttribute("aria-valuetext", text);
    };
    say(this.factor, this.factor.value === "0" ? words().paint.switched_off : `${this.factor.value} %`);
    say(this.add, `${this.add.value} nW/cm²/sr`);
    say(this.radius, `${this.radius.value} km`);
    this.draw.setAttribute("aria-pressed", String(this.painting));
    this.draw.textContent = this.painting ? words().paint.stop : words().paint.draw;
    by_id("paint-hint", HTMLElement).textContent = this.painting ? words().paint.hint : "";
    this.events.brush(this.painting ? { shape: this.shape, radius_m: 1000 * Number(this.radius.value) } : null);
  }
}
