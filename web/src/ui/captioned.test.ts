import assert from "node:assert/strict";
import { test } from "node:test";
import type { SkyAnswer } from "../api/types.ts";
import { loadWords } from "../language/words.ts";
import { captionLines, wrapped } from "./captioned.ts";

await loadWords("place");

/** Below the picture stand the place, the time, its numbers, what was assumed and whose data it is. */
test("a caption says where, when and whose", () => {
  const sky = { bortle_class: 5, ratio_to_natural: 3, zenith_total_brightness_mag_arcsec2: 20.764, naked_eye_limit_mag: 5.4 };
  const captioned = {
    place: { latitude_deg: 45.75, longitude_deg: 150 },
    name: "14 km SSW of Lecco",
    scene: { title: "Alps", attribution: "NASA Black Marble", date: "2023", illustrative: false },
    answer: { sky, coverage: 1, turbidity: 2.5 } as SkyAnswer,
    shares: null,
  };
  const today = { lamp: "mixed", clouds: null, cloudCover: 100, land: "dark" } as const;
  const view = { ...today, time: "2026-08-12T22:30:00Z", scenario: null, lights: "changed" } as const;
  const lines = captionLines(captioned, view);
  assert.deepEqual(lines, [
    "14 km SSW of Lecco · 45.7500° N, 150.0000° E",
    "2026-08-13 08:30 UTC+10 · Zenith, all light 20.76 mag/arcsec² · Bortle class 5",
    "Suburban sky. The Milky Way is faint.",
    "Haze (turbidity) 2.5 · Lamps: half sodium, half white LED, 2800 K · Clouds: none, a clear sky",
    "Skyglow · Alps · 2023 · NASA Black Marble",
  ]);
  const madeUp = { ...captioned, scene: { ...captioned.scene, illustrative: true } };
  assert.match(captionLines(madeUp, { ...view, time: null }).at(-1) ?? "", /not measured/);
  assert.match(captionLines(captioned, { ...view, land: "snow" })[3] ?? "", /a clear sky · Ground: under snow$/);
  assert.match(captionLines(captioned, { ...view, scenario: "s-0" })[3] ?? "", /^With changes · /);
});

/** Lines break between words alone, and a word that is too long has a line of its own. */
test("a caption breaks between words", () => {
  const widthPx = (text: string) => text.length;
  assert.deepEqual(wrapped("the sky over a town", 8, widthPx), ["the sky", "over a", "town"]);
  assert.deepEqual(wrapped("an extraordinarily dark sky", 8, widthPx), ["an", "extraordinarily", "dark sky"]);
});
