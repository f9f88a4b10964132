import assert from "node:assert/strict";
import { test } from "node:test";
import { STORED_HEADER as HEARD_HEADER } from "../api/client.ts";
import { asStored, kindOf, STORED_HEADER } from "./stored.ts";

const SCOPE = "https://host.example/sky/";

/** The viewer, its files and what is told of places are kept; plans, uploads, pages for frames and other hosts are not. */
test("what is kept is told by its address", () => {
  const cases: [string, ReturnType<typeof kindOf>][] = [
    ["", "page"],
    ["?utm=1", "page"],
    ["index.html", "page"],
    ["assets/index-abc.js", "file"],
    ["api/v1/scenes", "answer"],
    ["api/v1/scenes/demo/sky?lat=46&lon=9", "answer"],
    ["api/v1/scenes/demo/panorama.sky?lat=46&lon=9", "answer"],
    ["api/v1/scenes/demo/tiles/radiance/tilejson.json", "answer"],
    ["api/v1/scenes/demo/tiles/radiance/6/38/32@2x.png", "tile"],
    ["api/v1/scenes/demo/panorama.png?lat=46", "other"],
    ["api/v1/plans/p-1", "other"],
    ["healthz", "other"],
    ["embed", "other"],
  ];
  for (const [path, kind] of cases) assert.equal(kindOf(SCOPE + path, SCOPE), kind, path);
  assert.equal(kindOf("https://host.example/other/", SCOPE), "other");
  assert.equal(kindOf("https://elsewhere.example/sky/assets/a.js", SCOPE), "other");
});

/** A kept answer has the date at which it came, and all else as it was. */
test("a kept answer says when it came", async () => {
  const date = "Sat, 28 Nov 2026 19:00:00 GMT";
  const stored = asStored(new Response(`{"a":1}`, { headers: { date, "content-type": "application/json" } }));
  assert.equal(stored.headers.get(STORED_HEADER), date);
  assert.equal(STORED_HEADER, HEARD_HEADER, "the page hears what the worker says");
  assert.deepEqual([stored.status, await stored.json()], [200, { a: 1 }]);
});
