import assert from "node:assert/strict";
import { test } from "node:test";
import { ApiError } from "../api/problem.ts";
import { areasFromText, refusalOf } from "./areas.ts";

const SQUARE = { type: "Polygon", coordinates: [[[8, 46]]] };

/** Properties that can be names are offered once each, in their order; others are not. */
test("properties of areas are offered as names", () => {
  const features = [
    { type: "Feature", properties: { id: 7, GEN: "Bern", tags: ["a"], gone: null }, geometry: SQUARE },
    { type: "Feature", properties: { id: 8, GEN: "Thun", note: "old" }, geometry: SQUARE },
    { type: "Feature", properties: null, geometry: SQUARE },
  ];
  const areas = areasFromText("a.geojson", JSON.stringify({ type: "FeatureCollection", features }));
  assert.deepEqual([areas?.fields, areas?.nameField], [["id", "GEN", "note"], null]);
});

/** A feature or an outline alone becomes a collection; what is neither is none. */
test("a bare outline becomes a collection", () => {
  for (const alone of [SQUARE, { type: "Feature", properties: {}, geometry: SQUARE }]) {
    const areas = areasFromText("a.json", JSON.stringify(alone));
    assert.deepEqual(areas?.body, {
      type: "FeatureCollection",
      features: [{ type: "Feature", properties: {}, geometry: SQUARE }],
    });
  }
  for (const text of ["no JSON", "[1]", "null", "3"]) assert.equal(areasFromText("a.json", text), null, text);
});

/** A file that holds nothing of the scene is refused for good, and not for what else is wrong with a request. */
test("a file is refused for what is wrong with it", () => {
  const refused = (parameter: string, message: string, status = 400) =>
    refusalOf(new ApiError(status, { errors: [{ parameter, message, code: "not_allowed", allowed: "" }] }));
  assert.equal(refused("boundary", "holds no pixel of this scene"), "outside");
  assert.equal(refused("boundary", "holds no pixel of this scene: its positions look like latitude, longitude, and"), "swapped");
  assert.equal(refused("features[3]", '"x": it crosses itself'), "unreadable");
  assert.equal(refusalOf(new ApiError(413, {})), "unreadable");
  assert.deepEqual([refused("turbidity", "is out of range", 422), refused("body", "x", 503)], [null, null]);
  assert.equal(refusalOf(new Error("no answer")), null);
});
