// Edits that somebody paints over the lights, with undo and redo.

import type { EditAnswer, EditBody, LampBody, ScenarioAnswer, ScenarioBody } from "../api/schema.ts";

/** What a stroke does to the lights below it. */
export type PaintKind = "factor" | "lamp" | "emission" | "add";

export interface PaintChange {
  kind: PaintKind;
  /** Factor on the lights that are there. */
  factor: number;
  /** Preset of the new lamps. */
  lamp: string;
  /** Preset of the lamps that they replace; null: of all. */
  lampFrom: string | null;
  /** Preset of how light is sent upward. */
  emission: string;
  /** Radiance that is added, nW cm⁻² sr⁻¹. */
  addRadianceNwCm2Sr: number;
}

/** Longitude and latitude, degrees. */
export type LonLat = readonly [number, number];

/** Where a stroke was painted: along points, or inside a closed curve. */
export type PaintedArea =
  | { shape: "brush"; points: readonly LonLat[]; radiusM: number }
  | { shape: "area"; points: readonly LonLat[] };

const MAX_EDITS = 100;

export function editFrom(area: PaintedArea, change: PaintChange): EditBody {
  const points = area.points.map(([longitudeDeg, latitudeDeg]): [number, number] => [
    +longitudeDeg.toFixed(5),
    +latitudeDeg.toFixed(5),
  ]);
  const where =
    area.shape === "brush"
      ? { brush: { points, radius_m: area.radiusM } }
      : { polygon: { type: "Polygon", coordinates: [[...points, points[0]]] } };
  switch (change.kind) {
    case "factor":
      return { ...where, factor: change.factor };
    case "lamp":
      return { ...where, lamp: { to: change.lamp, ...(change.lampFrom === null ? {} : { from: change.lampFrom }) } };
    case "emission":
      return { ...where, emission: change.emission };
    case "add":
      return { ...where, add_radiance_nw_cm2_sr: change.addRadianceNwCm2Sr };
  }
}

/** An edit as it was sent, from the server's answer. */
export function editFromAnswer({
  area,
  radius_m,
  factor,
  add_radiance_nw_cm2_sr,
  lamp,
  lamp_from,
  keep,
  emission,
}: EditAnswer): EditBody {
  const where = radius_m == null ? { polygon: area } : { brush: { points: area.coordinates as [number, number][], radius_m } };
  const sent = emission == null ? {} : { emission };
  const fixture = lamp as string | number[] | null | undefined;
  if (add_radiance_nw_cm2_sr != null)
    return { ...where, add_radiance_nw_cm2_sr, ...(fixture == null ? {} : { lamp: fixture }), ...sent };
  const lamps: { lamp?: LampBody } =
    fixture == null
      ? {}
      : { lamp: { to: fixture, ...(lamp_from == null ? {} : { from: lamp_from }), ...(keep == null ? {} : { keep }) } };
  const onlyFactor = fixture == null && emission == null;
  return { ...where, ...(factor == null || (factor === 1 && !onlyFactor) ? {} : { factor }), ...lamps, ...sent };
}

/** What somebody painted: replaced, never changed in place. */
export interface Painting {
  readonly done: readonly EditBody[];
  readonly undone: readonly EditBody[];
  /** The plan or scenario that the edits go on from. */
  readonly base: string | null;
  readonly title: string;
}

export const EMPTY_PAINTING: Painting = { done: [], undone: [], base: null, title: "" };

export function isFull({ done }: Painting): boolean {
  return done.length >= MAX_EDITS;
}

export function withEdit(painting: Painting, edit: EditBody): Painting {
  return { ...painting, done: [...painting.done, edit], undone: [] };
}

export function withUndo(painting: Painting): Painting {
  const edit = painting.done.at(-1);
  return edit === undefined ? painting : { ...painting, done: painting.done.slice(0, -1), undone: [...painting.undone, edit] };
}

export function withRedo(painting: Painting): Painting {
  const edit = painting.undone.at(-1);
  return edit === undefined ? painting : { ...painting, done: [...painting.done, edit], undone: painting.undone.slice(0, -1) };
}

/** What somebody painted before, to go on from. */
export function paintingFromScenario({ edits, base, title }: Pick<ScenarioAnswer, "edits" | "base" | "title">): Painting {
  return { done: edits.map(editFromAnswer), undone: [], base: base ?? null, title: title ?? "" };
}

/** What the server is asked to store. */
export function scenarioBody({ done, base, title }: Painting): ScenarioBody {
  return { edits: [...done], ...(base === null ? {} : { base }), ...(title === "" ? {} : { title }) };
}
