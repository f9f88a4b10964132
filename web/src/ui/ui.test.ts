import assert from "node:assert/strict";
import { test } from "node:test";
import { ApiError, describeProblem, problemLine } from "../api/problem.ts";
import { typeset } from "../api/units.ts";
import { loadWords, words } from "../language/words.ts";
import { cloudBases, cloudsTitle, packsUnder } from "./clouds.ts";
import { baseNote, changeOf, colourNote, plannedChange } from "./comparison.ts";
import { bothWithPrefix, coordinates, ratio, withPrefix } from "./format.ts";
import { lampGroups, lamps, lampsIn, lampTitle } from "./lamps.ts";
import { scaleEnds } from "./layer-legend.ts";
import { distanceAndBearing, placeName } from "./nearby.ts";
import { terrainTitle } from "./numbers.ts";
import { clampTurbidity, residentScatterings, scatteringTitle, turbidityRange } from "./scattering.ts";
import { matchingPlaces } from "./search.ts";

await loadWords("place");

const NAIROBI = { name: "Nairobi", latitude_deg: -1.286, longitude_deg: 36.817, population: 4_400_000 };
const PLACES = [
  { name: "Nairutia", latitude_deg: 0, longitude_deg: 36, population: 2_000 },
  NAIROBI,
  { name: "Chogoria", latitude_deg: -0.23, longitude_deg: 37.63, population: 3_000 },
  { name: "Murang'a", latitude_deg: -0.72, longitude_deg: 37.15, population: 110_000 },
  { name: "Zürich", latitude_deg: 47.37, longitude_deg: 8.54, population: null },
];

/** Names that begin with the text come first, larger ones before smaller, accents ignored. */
test("names that begin with the text come first", () => {
  assert.deepEqual(
    matchingPlaces(PLACES, "nai").map(({ name }) => name),
    ["Nairobi", "Nairutia"],
  );
  assert.deepEqual(
    matchingPlaces(PLACES, "zur").map(({ name }) => name),
    ["Zürich"],
  );
  assert.deepEqual(matchingPlaces(PLACES, "  "), []);
});

test("a place is told by its nearest town", () => {
  assert.equal(placeName(NAIROBI, PLACES), "Nairobi");
  const north = { latitude_deg: -1.286 + 20 / 111.195, longitude_deg: 36.817 };
  assert.equal(placeName(north, PLACES), "20 km N of Nairobi");
  assert.equal(placeName({ latitude_deg: -40, longitude_deg: 100 }, PLACES), "40.0000° S, 100.0000° E");
});

test("the bearing along the equator is east", () => {
  const way = distanceAndBearing({ latitude_deg: 0, longitude_deg: 0 }, { latitude_deg: 0, longitude_deg: 1 });
  assert.ok(Math.abs(way.bearingDeg - 90) < 1e-9);
  assert.ok(Math.abs(way.distanceKm - 111.195) < 0.01);
});

/** Quantities take the prefix that keeps them readable. */
test("quantities take a readable prefix", () => {
  assert.equal(withPrefix(171.2e-6, "cd/m²"), "171 µcd/m²");
  assert.equal(withPrefix(0.0123, "lx"), "12.3 mlx");
  assert.equal(withPrefix(0, "lx"), "0 lx");
  assert.equal(ratio(0.0000004), "< 0.001");
  assert.equal(ratio(1234.5), "1,235");
  assert.equal(coordinates(-1.28, 36.8), "1.2800° S, 36.8000° E");
});

/** Each scattering has its own turbidities, and the best is the default. */
test("each scattering has its own turbidities", () => {
  const packs = [
    { scattering: "single", turbidity: 1.5 },
    { scattering: "single", turbidity: 6 },
    { scattering: "multiple", turbidity: 4 },
    { scattering: "multiple", turbidity: 2 },
  ];
  assert.deepEqual(residentScatterings(packs), ["multiple", "single"]);
  assert.deepEqual(turbidityRange(packs, null), [2, 4]);
  assert.deepEqual(turbidityRange(packs, "single"), [1.5, 6]);
  assert.equal(clampTurbidity(packs, null, 5.5), 4);
  assert.equal(clampTurbidity(packs, "single", 5.5), 5.5);
  assert.equal(clampTurbidity(packs, "multiple", null), null);
  const firstOrder = packs.slice(0, 2);
  assert.deepEqual(residentScatterings(firstOrder), ["single"]);
  assert.deepEqual(turbidityRange(firstOrder, null), [1.5, 6]);
  assert.equal(turbidityRange(firstOrder, "multiple"), null);
  assert.deepEqual(["multiple", "single"].map(scatteringTitle), ["any number of times", "once only"]);
});

/** Clouds are those that there are packs for, and their packs are no clear sky's. */
test("clouds are those that packs are resident for", () => {
  const packs = [
    { cloud_base_m: null, n: 1 },
    { cloud_base_m: 2000, n: 2 },
    { cloud_base_m: 800, n: 3 },
    { cloud_base_m: 2000, n: 4 },
    { n: 5 },
  ];
  assert.deepEqual(cloudBases(packs), [800, 2000]);
  assert.deepEqual(
    packsUnder(packs, null).map(({ n }) => n),
    [1, 5],
  );
  assert.deepEqual(
    packsUnder(packs, 2000).map(({ n }) => n),
    [2, 4],
  );
  assert.deepEqual([cloudsTitle(null), cloudsTitle(800)], ["none, a clear sky", "closed, from 800 m up"]);
  assert.equal(cloudsTitle(800, 0.45), "over 45 % of the sky, from 800 m up");
});

/** A problem document becomes a headline and one sentence for each bad parameter, which say what the detail says. */
test("a problem becomes a headline and sentences", () => {
  const error = new ApiError(422, {
    type: "/problems/out-of-range",
    title: "Outside the range that is resident",
    detail: "turbidity=100: is out of range; allowed: 1.5 to 6",
    errors: [{ parameter: "turbidity", value: "100", allowed: "1.5 to 6", message: "is out of range", code: "out_of_range" }],
  });
  assert.deepEqual(describeProblem(error), {
    headline: { text: "Outside the range that is resident", isEnglish: true },
    sentences: [{ text: "turbidity = 100: is out of range. Allowed: 1.5 to 6.", isEnglish: true }],
  });
  const outside = new ApiError(404, {
    type: "/problems/outside-scene",
    title: "The place lies outside the scene",
    detail: "latitude 20, longitude 100 lies outside the scene, which reaches from west 33.90833333333333 south -4.720833333333333",
  });
  assert.match(describeProblem(outside).sentences[0]?.text ?? "", /from west 33\.9083 south -4\.7208\.$/);
  const busy = new ApiError(503, { type: "/problems/busy", title: "The server is busy", detail: "try again in 3 s" });
  assert.deepEqual(problemLine(busy), { text: "The server is busy. Try again in 3 s.", isEnglish: true });
  assert.deepEqual(problemLine(new Error("no WebGL")).isEnglish, false);
});

test("what terrain hides is said in words", () => {
  const title = (terrainOcclusion: boolean, hiddenLights: boolean): string =>
    terrainTitle({ terrain_occlusion: terrainOcclusion, hidden_lights: hiddenLights });
  assert.deepEqual(
    [title(false, false), title(true, false), title(true, true)],
    ["nothing", "sky below the horizon", "sky and lights"],
  );
});

/** The ends of a layer's colours are told in units that people read. */
test("the ends of a layer's colours have units", () => {
  assert.equal(typeset("nW cm-2 sr-1"), "nW/cm²/sr");
  assert.equal(typeset("cd m-2"), "cd/m²");
  assert.equal(typeset("lx"), "lx");
  assert.deepEqual(scaleEnds("radiance", { range: [0.2, 200], unit: "nW cm-2 sr-1" }, "photopic"), ["0.2", "200 nW/cm²/sr"]);
  assert.deepEqual(scaleEnds("brightness", { range: [1.8e-6, 7.2e-3], unit: "cd m-2", natural: 1.8e-4 }, "photopic"), [
    "1 %",
    "40 × the natural sky",
  ]);
  assert.deepEqual(scaleEnds("influence", { range: [2e-10, 2e-6], unit: "cd m-2" }, "photopic"), [
    "1/10,000",
    "2.00 µcd/m² from one light",
  ]);
  assert.deepEqual(scaleEnds("elevation", { range: null, unit: "m" }, "photopic"), ["0 m", "6000 m and more"]);
  const dark = { range: [4e-6, 0.016], unit: "cd m-2" };
  assert.deepEqual(scaleEnds("brightness", dark, "scotopic"), ["4.00 µcd/m²", "16.0 mcd/m²"]);
  const satellite = { range: [2e-8, 2e-4], unit: "nW cm-2 sr-1" };
  assert.deepEqual(scaleEnds("influence", satellite, "dnb"), ["1/10,000", "200 fW/cm²/sr from one light"]);
});

/** Every lamp is offered once, in groups, told apart by its colour temperature. */
test("every lamp is offered once with its colour temperature", () => {
  const titles = lampGroups().flatMap(({ choices }) => choices.map(([, title]) => title));
  assert.deepEqual(
    lamps()
      .map(([name]) => name)
      .sort(),
    Object.keys(words().lamps).sort(),
  );
  assert.ok(
    titles.every((title) => /, \d{4} K$/.test(title)),
    `${titles}`,
  );
  assert.equal(new Set(titles).size, titles.length);
  assert.deepEqual(
    lampGroups().map(({ title }) => title),
    ["", "Sodium", "LED", "Others"],
  );
});

/** Lamps of the user's own are told by what they are. */
test("own lamps are told by what they are", () => {
  assert.equal(lampTitle("hps"), "high-pressure sodium, 2000 K");
  assert.equal(lampTitle("hps:7,led_4000k:3"), "70 % high-pressure sodium, 2000 K + 30 % white LED, 4000 K");
  assert.equal(lampTitle("400:0,450:1.2,500:0"), "own spectrum");
  assert.equal(lampTitle("0.5,0.6,0.1"), "own fluxes 0.5,0.6,0.1");
  assert.equal(lampTitle("neutral"), "own: neutral");
  assert.deepEqual(lampsIn("mixed"), ["hps", "led_4000k"]);
  assert.deepEqual(lampsIn("lps:1,mercury:2"), ["lps", "mercury"]);
  assert.deepEqual(lampsIn("0.5,0.6,0.1"), []);
});

/** Changes are told in percent, large ones as factors, and none as none. */
test("changes are told in percent or as factors", () => {
  assert.equal(changeOf(1, 2.1), "+110 %");
  assert.equal(changeOf(1, 1.012), "+1.2 %");
  assert.equal(changeOf(1, 0.6), "−40 %");
  assert.equal(changeOf(1, 1.0001), "±0 %");
  assert.equal(changeOf(1, 25), "25 ×");
  assert.equal(changeOf(0, 1), null);
});

/** A bluer light of which eyes at night see less than before is not said to be more to them. */
test("the colour is told with what eyes see of it", () => {
  const note = (from: number | null, to: number, scotopic: [number, number]) =>
    colourNote(
      { zenith_scotopic_photopic_ratio: from, zenith_scotopic_luminance_cd_m2: scotopic[0] },
      { zenith_scotopic_photopic_ratio: to, zenith_scotopic_luminance_cd_m2: scotopic[1] },
    );
  assert.match(note(0.6, 1.7, [1, 2]), /bluer.*see more of it\.$/);
  assert.match(note(1.2, 1.5, [1, 0.71]), /bluer.*lose less of it than/);
  assert.match(note(1.7, 0.6, [2, 1]), /redder.*see less of it\.$/);
  assert.match(note(1.7, 1.5, [1, 2]), /redder.*see more of it, though less/);
  assert.deepEqual([note(1.2, 1.22, [1, 2]), note(null, 1, [1, 2])], ["", ""]);
});

/** Before and after are told in one unit, that of the larger. */
test("before and after have one unit", () => {
  assert.deepEqual(bothWithPrefix(13_500, 8568, "W"), ["13.5", "8.57", "kW"]);
  assert.deepEqual(bothWithPrefix(0, 2.5e-4, "cd/m²"), ["0", "250", "µcd/m²"]);
  assert.deepEqual(bothWithPrefix(0, 0, "lx"), ["0", "0", "lx"]);
});

/** A plan for the marked part says what that becomes; the zenith has its row already. */
test("a plan says what its measure becomes", () => {
  const site = { measure: "region", before: 2.5e-4, after: 1.75e-4, unit: "cd m-2" };
  const planned = plannedChange(site);
  assert.deepEqual({ ...planned, name: "" }, { name: "", from: "250", to: "175", unit: "µcd/m²", change: "−30 %" });
  assert.equal(planned?.name, "Artificial, in the marked part of the sky");
  assert.equal(plannedChange({ ...site, measure: "zenith" }), null);
});

/** What painted lights lie on is said, for their numbers leave it out. */
test("what a measure lies on is said", () => {
  assert.match(baseNote("p-1"), /the plan that this lies on/);
  assert.match(baseNote("s-1"), /the changed lights that this lies on/);
  assert.equal(baseNote(null), "");
});
