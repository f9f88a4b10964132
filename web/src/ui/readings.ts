// What a meter reads beside what the model has, kept by the browser for the way home from the field.

import type { Place } from "../state/view-state.ts";

export interface Reading extends Place {
  /** When it was read, UTC. */
  readAt: string;
  /** Of the night whose sky the model has, UTC; null: a dark sky of no time. */
  time: string | null;
  readMag: number;
  modelMag: number;
  scene: string;
  turbidity: number;
}

/** Readings that a Sky Quality Meter can show. */
export const READING_RANGE_MAG = [5, 24] as const;
/** What its maker promises (Unihedron SQM-L). */
export const METER_ERROR_MAG = 0.1;
/** Older ones are dropped. */
const MOST_READINGS = 500;

/** A number as people type it, with a comma too; null for what no meter shows. */
export function readingFrom(text: string): number | null {
  const [least, most] = READING_RANGE_MAG;
  const reading = Number(text.trim().replace(",", "."));
  return text.trim() !== "" && reading >= least && reading <= most ? reading : null;
}

/** How much brighter the sky is than the model has it, in magnitudes, and as a factor of its light. */
export function excess(readMag: number, modelMag: number): { brighterMag: number; times: number } {
  const brighterMag = modelMag - readMag;
  return { brighterMag, times: 10 ** (0.4 * brighterMag) };
}

/** What was stored; whatever is none is left out. */
export function readingsFrom(stored: string | null): Reading[] {
  try {
    const list: unknown = JSON.parse(stored ?? "[]");
    const isReading = (entry: unknown): entry is Reading => {
      const { readMag, modelMag, latitude_deg, longitude_deg } = (entry ?? {}) as Partial<Reading>;
      return [readMag, modelMag, latitude_deg, longitude_deg].every((value) => typeof value === "number");
    };
    return Array.isArray(list) ? list.filter(isReading) : [];
  } catch {
    return [];
  }
}

/** With one more. */
export function withReading(readings: readonly Reading[], reading: Reading): Reading[] {
  return [...readings, reading].slice(-MOST_READINGS);
}

const COLUMNS = ["read_at", "latitude_deg", "longitude_deg", "read_mag_arcsec2", "model_mag_arcsec2", "time", "scene", "turbidity"];

/** A table of them. */
export function csvOf(readings: readonly Reading[]): string {
  const rows = readings.map(({ readAt, latitude_deg, longitude_deg, readMag, modelMag, time, scene, turbidity }) =>
    [readAt, latitude_deg, longitude_deg, readMag.toFixed(2), modelMag.toFixed(2), time ?? "", scene, turbidity].join(","),
  );
  return `${[COLUMNS.join(","), ...rows].join("\n")}\n`;
}
