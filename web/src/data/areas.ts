// Boundaries that somebody chose as a file: what the server is sent, and the names that its properties hold.

import type { AreasBody } from "../api/client.ts";
import { ApiError } from "../api/problem.ts";

/** Boundaries by name. */
export interface Areas {
  fileName: string;
  body: AreasBody;
  /** Properties that may hold a name. */
  fields: readonly string[];
  /** The one that does; null: the usual ones, as the server knows them. */
  nameField: string | null;
}

/** Features that are looked at for their properties. */
const SEEN_FEATURES = 50;
const MAX_FIELDS = 60;

type Properties = Readonly<Record<string, unknown>>;

/** Properties that hold texts or numbers, in the order of the file. */
export function nameFields(features: readonly { properties?: Properties | null }[]): string[] {
  const names = features
    .slice(0, SEEN_FEATURES)
    .flatMap(({ properties }) => Object.entries(properties ?? {}))
    .filter(([, value]) => typeof value === "string" || typeof value === "number")
    .map(([name]) => name);
  return [...new Set(names)].slice(0, MAX_FIELDS);
}

/** Why a file is refused for good, whatever else is asked; null where it may be taken later. */
export function refusalOf(reason: unknown): "outside" | "swapped" | "unreadable" | null {
  if (!(reason instanceof ApiError) || reason.status < 400 || reason.status >= 500) return null;
  const ofFile = (reason.problem.errors ?? []).filter(({ parameter }) => /^(boundary|body|features\[\d+\])$/.test(parameter));
  const outside = ofFile.find(({ message }) => message.startsWith("holds no pixel"));
  if (outside !== undefined) return outside.message.includes("look like latitude") ? "swapped" : "outside";
  return ofFile.length > 0 || reason.status === 413 ? "unreadable" : null;
}

/** Reads a file; null where it is no GeoJSON. */
export function areasFromText(fileName: string, text: string): Areas | null {
  let parsed: unknown;
  try {
    parsed = JSON.parse(text);
  } catch {
    return null;
  }
  if (typeof parsed !== "object" || parsed === null || Array.isArray(parsed)) return null;
  const read = parsed as Record<string, unknown>;
  // The server takes a collection; a file may hold one feature or a bare outline.
  const feature = read.type === "Feature" ? read : { type: "Feature", properties: {}, geometry: read };
  const body = read.type === "FeatureCollection" ? read : { type: "FeatureCollection", features: [feature] };
  const features = Array.isArray(body.features) ? (body.features as { properties?: Properties | null }[]) : [];
  return { fileName, body, fields: nameFields(features), nameField: null };
}
