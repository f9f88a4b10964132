import assert from "node:assert/strict";
import { test } from "node:test";
import type { FoundPlace, Scene } from "../api/types.ts";
import { worldResults } from "./world-search.ts";

const found = (name: string, country: string, latitudeDeg: number, scene: string | null): FoundPlace => ({
  name,
  country,
  latitude_deg: latitudeDeg,
  longitude_deg: 9,
  scene,
});
const SCENES = [
  { id: "alps", title: "The Alps", bounds: [5, 43, 15, 49] },
  { id: "kenya", title: "Kenya", date: "2020", bounds: [5, -5, 42, 5] },
  { id: "kenya2023", title: "Kenya 2023", date: "2023", bounds: [5, -5, 42, 5] },
] as Scene[];

/** Finds say their country and another scene; what is listed already under another name, and nothing else, is left out. Places without a scene come last, and are three at most. */
test("finds of the world say their scene", () => {
  const milano = { name: "Milano", latitude_deg: 45.46, longitude_deg: 9 };
  const places = [
    found("Milan", "IT", 45.47, "alps"),
    found("Milas", "TR", 37.3, null),
    found("Mili", "KE", -1, "kenya"),
    found("Milezzo", "IT", 46, "alps"),
  ];
  const many = [1, 2, 3, 4].map((i) => found(`Mil ${i}`, "US", -10 * i, null));
  assert.equal(worldResults(many, [], SCENES, "alps").length, 3);
  assert.deepEqual(
    worldResults(places, [milano], SCENES, "alps").map(({ title, detail, isCovered }) => [title, detail, isCovered]),
    [
      ["Mili", "Kenya · Kenya 2023", true],
      ["Milezzo", "Italy", true],
      ["Milas", "Türkiye · no scene covers it", false],
    ],
  );
});
