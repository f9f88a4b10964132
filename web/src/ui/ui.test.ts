import assert from "node:assert/strict";
import { test } from "node:test";
import { ApiError, plain_words } from "../api/problem.ts";
import { coordinates, ratio, with_prefix } from "./format.ts";
import { layer_ends, typeset } from "./layers.ts";
import { distance_and_bearing, place_name } from "./nearby.ts";
import { terrain_title } from "./numbers.ts";
import { cloud_bases, clouds_title, packs_under } from "./clouds.ts";
import { resident_scatterings, scattering_title, turbidity_ends, turbidity_within } from "./scattering.ts";
import { matching_places, place_from_text } from "./search.ts";

const NAIROBI = { name: "Nairobi", latitude_deg: -1.286, longitude_deg: 36.817, population: 4_400_000 };
const PLACES = [
  { name: "Nairutia", latitude_deg: 0, longitude_deg: 36, population: 2_000 },
  NAIROBI,
  { name: "Chogoria", latitude_deg: -0.23, longitude_deg: 37.63, population: 3_000 },
  { name: "Murang'a", latitude_deg: -0.72, longitude_deg: 37.15, population: 110_000 },
  { name: "Zürich", latitude_deg: 47.37, longitude_deg: 8.54, population: null },
];

test("coordinates are read latitude first, with signs or letters", () => {
  assert.deepEqual(place_from_text("-1.29, 36.82"), { latitude_deg: -1.29, longitude_deg: 36.82 });
  assert.deepEqual(place_from_text("1.29°S 36.82°E"), { latitude_deg: -1.29, longitude_deg: 36.82 });
  assert.equal(place_from_text("91, 10"), null);
  assert.equal(place_from_text("Nairobi"), null);
});

test("names that begin with the text come first, larger ones before smaller, accents ignored", () => {
  assert.deepEqual(matching_places(PLACES, "nai").map(({ name }) => name), ["Nairobi", "Nairutia"]);
  assert.deepEqual(matching_places(PLACES, "zur").map(({ name }) => name), ["Zürich"]);
  assert.deepEqual(matching_places(PLACES, "  "), []);
});

test("a place is told by its nearest town", () => {
  assert.equal(place_name(NAIROBI, PLACES), "Nairobi");
  const north = { latitude_deg: -1.286 + 20 / 111.195, longitude_deg: 36.817 };
  assert.equal(place_name(north, PLACES), "20 km N of Nairobi");
  assert.equal(place_name({ latitude_deg: -40, longitude_deg: 100 }, PLACES), "40.0000° S, 100.0000° E");
});

test("the bearing along the equator is east", () => {
  const way = distance_and_bearing({ latitude_deg: 0, longitude_deg: 0 }, { latitude_deg: 0, longitude_deg: 1 });
  assert.ok(Math.abs(way.bearing_deg - 90) < 1e-9);
  assert.ok(Math.abs(way.distance_km - 111.195) < 0.01);
});

test("quantities take the prefix that keeps them readable", () => {
  assert.equal(with_prefix(171.2e-6, "cd/m²"), "171 µcd/m²");
  assert.equal(with_prefix(0.0123, "lx"), "12.3 mlx");
  assert.equal(with_prefix(0, "lx"), "0 lx");
  assert.equal(ratio(0.0000004), "< 0.001");
  assert.equal(ratio(1234.5), "1,235");
  assert.equal(coordinates(-1.28, 36.8), "1.2800° S, 36.8000° E");
});

test("each scattering has its own turbidities, and the best is the default", () => {
  const packs = [
    { scattering: "single", turbidity: 1.5 },
    { scattering: "single", turbidity: 6 },
    { scattering: "multiple", turbidity: 4 },
    { scattering: "multiple", turbidity: 2 },
  ];
  assert.deepEqual(resident_scatterings(packs), ["multiple", "single"]);
  assert.deepEqual(turbidity_ends(packs, null), [2, 4]);
  assert.deepEqual(turbidity_ends(packs, "single"), [1.5, 6]);
  assert.equal(turbidity_within(packs, null, 5.5), 4);
  assert.equal(turbidity_within(packs, "single", 5.5), 5.5);
  assert.equal(turbidity_within(packs, "multiple", null), null);
  const first_order = packs.slice(0, 2);
  assert.deepEqual(resident_scatterings(first_order), ["single"]);
  assert.deepEqual(turbidity_ends(first_order, null), [1.5, 6]);
  assert.equal(turbidity_ends(first_order, "multiple"), null);
  assert.deepEqual(["multiple", "single"].map(scattering_title), ["all orders", "first order alone"]);
});

test("clouds are those that there are packs for, and their packs are no clear sky's", () => {
  const packs = [{ cloud_base_m: null, n: 1 }, { cloud_base_m: 2000, n: 2 }, { cloud_base_m: 800, n: 3 }, { cloud_base_m: 2000, n: 4 }, { n: 5 }];
  assert.deepEqual(cloud_bases(packs), [800, 2000]);
  assert.deepEqual(packs_under(packs, null).map(({ n }) => n), [1, 5]);
  assert.deepEqual(packs_under(packs, 2000).map(({ n }) => n), [2, 4]);
  assert.deepEqual([clouds_title(null), clouds_title(800)], ["none, a clear sky", "closed, from 800 m up"]);
});

test("a problem document becomes a headline and one sentence for each bad parameter", () => {
  const error = new ApiError(422, {
    title: "A parameter is out of range",
    detail: "One parameter is not accepted.",
    errors: [{ parameter: "turbidity", value: "100", allowed: "1.5 to 6", message: "is out of range", code: "out_of_range" }],
  });
  assert.deepEqual(plain_words(error), {
    headline: "A parameter is out of range",
    sentences: ["One parameter is not accepted.", "turbidity = 100: is out of range. Allowed: 1.5 to 6."],
  });
});

test("what terrain hides is said in words", () => {
  const title = (terrain_occlusion: boolean, hidden_lights: boolean): string => terrain_title({ terrain_occlusion, hidden_lights });
  assert.deepEqual([title(false, false), title(true, false), title(true, true)], ["nothing", "sky below the horizon", "sky and lights"]);
});

test("the ends of a layer's colours are told in units that people read", () => {
  assert.equal(typeset("nW cm-2 sr-1"), "nW/cm²/sr");
  assert.equal(typeset("cd m-2"), "cd/m²");
  assert.equal(typeset("lx"), "lx");
  assert.deepEqual(layer_ends("radiance", { range: [0.2, 200], unit: "nW cm-2 sr-1" }), ["0.2", "200 nW/cm²/sr"]);
  assert.deepEqual(layer_ends("brightness", { range: [1.71e-6, 6.84e-3], unit: "cd m-2" }), ["1 %", "40 × the natural sky"]);
  assert.deepEqual(layer_ends("influence", { range: [2e-10, 2e-6], unit: "cd m-2" }), ["1/10,000", "2.00 µcd/m² a pixel"]);
  assert.deepEqual(layer_ends("elevation", { range: null, unit: "m" }), ["0 m", "6000 m and more"]);
});
