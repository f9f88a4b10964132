import assert from "node:assert/strict";
import { test } from "node:test";
import type { PlaceShare, Shares } from "../api/types.ts";
import { loadWords } from "../language/words.ts";
import { listedTowns, othersTitle } from "./shares.ts";

await loadWords("place");

const part = (share: number) => ({ share, influence: 0, pixels: 1, flux_dnb_w: 1 });
const town = (name: string, share: number): PlaceShare => ({
  ...part(share),
  name,
  rank: 1,
  distance_m: 1e4,
  azimuth_deg: 0,
  latitude_deg: 0,
  longitude_deg: 0,
});

/** At most five towns are named, none of less than half a percent, and nothing of the whole is lost. */
test("few towns are named, and none is lost", () => {
  const of = (shares: number[]) =>
    listedTowns({
      places: shares.map((share, i) => town(`town ${i}`, share)),
      other_places: part(0.1),
      other_places_count: 7,
      elsewhere: part(0.02),
    } as Shares);
  const many = of([0.4, 0.2, 0.1, 0.08, 0.05, 0.03, 0.02]);
  assert.deepEqual([many.named.length, many.others.count, many.elsewhere], [5, 9, 0.02]);
  assert.ok(Math.abs(many.others.share - 0.15) < 1e-12);
  const one = of([0.876, 0.004]);
  assert.deepEqual([one.named.length, one.others.count], [1, 8]);
  assert.ok(Math.abs(one.others.share - 0.104) < 1e-12);
});

/** One town is one, and none are others where no town is named. */
test("towns that are not named are counted", () => {
  assert.deepEqual(
    [othersTitle(1, true), othersTitle(8, true), othersTitle(1, false), othersTitle(1200, false)],
    ["1 other town", "8 other towns", "1 town", "1,200 towns"],
  );
});
