// Coordinates as people paste them: decimal degrees, degrees with minutes and seconds, `geo:` addresses (RFC 5870), links of maps.

import type { Place } from "../state/view-state.ts";
import { cardinalNames } from "./format.ts";

const NUMBER = "\\d{1,3}(?:[.,]\\d+)?";
const SIGNED = "[-+−]?\\d{1,3}(?:\\.\\d+)?";
/** What stands between latitude and longitude. */
const LINK_PATTERNS = [
  // OpenStreetMap: its marker before the middle of the map.
  /[?&]mlat=(-?[\d.]+)&mlon=(-?[\d.]+)/,
  /[#&?]map=[\d.]+\/(-?[\d.]+)\/(-?[\d.]+)/,
  // Google: the place itself before the middle of the map.
  /!3d(-?[\d.]+)!4d(-?[\d.]+)/,
  /@(-?[\d.]+),(-?[\d.]+)/,
  /[?&](?:q|query|ll|sll|daddr|center)=(?:loc:)?(-?[\d.]+)(?:,|%2C)\s*\+?(-?[\d.]+)/i,
  /[?&]cp=(-?[\d.]+)~(-?[\d.]+)/,
  // Links of this viewer.
  /[#?&]lat=(-?[\d.]+)&lon=(-?[\d.]+)/,
] as const;

function placeOf(latitudeDeg: number, longitudeDeg: number): Place | null {
  const isOnEarth = Math.abs(latitudeDeg) <= 90 && Math.abs(longitudeDeg) <= 180;
  return isOnEarth ? { latitude_deg: latitudeDeg, longitude_deg: longitudeDeg } : null;
}

function fromLink(text: string): Place | null {
  for (const pattern of LINK_PATTERNS) {
    const match = pattern.exec(text);
    if (match !== null) return placeOf(Number(match[1]), Number(match[2]));
  }
  return null;
}

/** Letters of north, east, south and west, in the page's language and in English: `O` is east in German. */
function letters(): Record<"latitude" | "longitude" | "negative", string> {
  const [north, east, south, west] = cardinalNames();
  return { latitude: `${north}NS${south}`, longitude: `${east}EW${west}`, negative: `${south}S${west}W` };
}

/** `36°49'2"E`, `E36.45`, `36,82`: what is written of one of both; null where it is none. */
function angleFrom(text: string, axis: string, negative: string): number | null {
  const parts = `(${NUMBER})\\s*(?:°|º|d|deg)?\\s*(?:(${NUMBER})\\s*(?:'|′|’|m)\\s*)?(?:(${NUMBER})\\s*(?:"|″|”|''|′′|s)\\s*)?`;
  const match = new RegExp(`^\\s*([-+−])?([${axis}])?\\s*([-+−])?${parts}([${axis}])?\\s*$`, "i").exec(text);
  if (match === null) return null;
  const [, sign, letterBefore, signAfterLetter, degrees = "", minutes = "0", seconds = "0", letterAfter] = match;
  const [d, m, s] = [degrees, minutes, seconds].map((number) => Number(number.replace(",", "."))) as [number, number, number];
  if (m >= 60 || s >= 60 || (letterBefore !== undefined && letterAfter !== undefined)) return null;
  const letter = letterBefore ?? letterAfter ?? "";
  const isNegative = /[-−]/.test(sign ?? signAfterLetter ?? "") !== (letter !== "" && negative.includes(letter.toUpperCase()));
  const size = d + m / 60 + s / 3600;
  return isNegative ? -size : size;
}

/** The two halves of a text: at a letter, a semicolon, a comma with a space, or spaces alone. */
function halves(text: string, axis: { latitude: string; longitude: string }): [string, string][] {
  const any = `${axis.latitude}${axis.longitude}`;
  const separators = [
    // After the letter of the first, before that of the second.
    new RegExp(`(?<=[\\d°'"′″’”]\\s*[${any}])\\s*[,;/]?\\s*`, "i"),
    new RegExp(`(?<=[\\d°'"′″’”])\\s*[,;/]?\\s*(?=[${any}]\\s*[\\d+−-])`, "i"),
    /\s*[;/|]\s*/,
    /\s*,\s+/,
    // A comma is a sign of decimals where both have one, and else parts them.
    /(?<=\.\d+\s*°?)\s*,\s*/,
    /(?<=\d,\d+\s*°?)\s*,\s*(?=[-+−]?\d+,\d)/,
    /(?<=^[-+−]?\d{1,2}\s*°?)\s*,\s*/,
    /\s+/,
  ];
  return separators.flatMap((separator): [string, string][] => {
    const match = separator.exec(text);
    if (match === null || match.index === 0) return [];
    return [[text.slice(0, match.index), text.slice(match.index + match[0].length)]];
  });
}

/** A place from a text such as `-1.29, 36.82` (latitude first, unless letters say otherwise), or null. */
export function placeFromText(text: string): Place | null {
  const trimmed = text.trim();
  const geo = new RegExp(`^geo:(${SIGNED}),(${SIGNED})`, "i").exec(trimmed);
  if (geo !== null) return placeOf(Number(geo[1]), Number(geo[2]));
  if (/^https?:\/\//i.test(trimmed)) return fromLink(trimmed);
  const axis = letters();
  // A degree of a language's own letter is one of its letters too.
  for (const [first, second] of halves(trimmed, axis)) {
    const latitude = angleFrom(first, axis.latitude, axis.negative);
    const longitude = angleFrom(second, axis.longitude, axis.negative);
    if (latitude !== null && longitude !== null) return placeOf(latitude, longitude);
    const [longitudeFirst, latitudeSecond] = [
      angleFrom(first, axis.longitude, axis.negative),
      angleFrom(second, axis.latitude, axis.negative),
    ];
    if (longitudeFirst !== null && latitudeSecond !== null && new RegExp(`[${axis.longitude}]`, "i").test(first))
      return placeOf(latitudeSecond, longitudeFirst);
  }
  return null;
}
