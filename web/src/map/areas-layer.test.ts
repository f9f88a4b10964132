import assert from "node:assert/strict";
import { test } from "node:test";
import { areaFeatures } from "./areas-layer.ts";

/** Shares come in their own order and find their outlines by number; an outline that is missing is left out. */
test("areas find their outlines", () => {
  const geometry = (lon: number) => ({ type: "Point", coordinates: [lon, 46] });
  const features = [{ geometry: geometry(1) }, { geometry: geometry(2) }, { geometry: null }];
  const shares = [
    { feature: 2, name: "Second", share: 0.6 },
    { feature: 1, name: "First", share: 0.25 },
    { feature: 3, name: "None", share: 0.1 },
    { feature: 9, name: "Beyond", share: 0.05 },
  ];
  const shown = areaFeatures({ features, shares }).features;
  assert.deepEqual(
    shown.map(({ properties, geometry: outline }) => [properties?.label, outline]),
    [
      ["Second\n60 %", geometry(2)],
      ["First\n25 %", geometry(1)],
    ],
  );
});
