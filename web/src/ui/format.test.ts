import assert from "node:assert/strict";
import { test } from "node:test";
import { exposureTimeS } from "../sky/realistic.ts";
import { exposureTime } from "./format.ts";

/** The server tells the same in `server/display/src/realistic.rs`. */
test("exposures are told as cameras have them", () => {
  for (const [exposureEv, told] of [
    [0, "15 s"],
    [1, "30 s"],
    [0.5, "21 s"],
    [2, "1 min"],
    [6, "16 min"],
    [-4, "0.9 s"],
    [-6, "1/4 s"],
  ] as const)
    assert.equal(exposureTime(exposureTimeS(exposureEv)), told);
});
