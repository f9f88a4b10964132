// The operator's basemap: roads and lakes from vector tiles, and whose data they are.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, openPage, shot } from "./support/browser.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

const varint = (value) => {
  const bytes = [];
  for (let rest = value; ; rest = Math.floor(rest / 128)) {
    if (rest < 128) return [...bytes, rest];
    bytes.push((rest % 128) | 128);
  }
};
const field = (number, bytes) => [...varint(number * 8 + 2), ...varint(bytes.length), ...bytes];
const text = (words) => [...Buffer.from(words)];
const zigzag = (value) => (value < 0 ? -2 * value - 1 : 2 * value);

/** A layer of one feature with a kind: corners of 0 to 4096, from the left and from above. */
function layer(name, kind, type, corners) {
  const geometry = [];
  let [x, y] = [0, 0];
  corners.forEach(([toX, toY], i) => {
    if (i === 0) geometry.push(1 + 8);
    if (i === 1) geometry.push(2 + 8 * (corners.length - 1));
    geometry.push(zigzag(toX - x), zigzag(toY - y));
    [x, y] = [toX, toY];
  });
  if (type === 3) geometry.push(7 + 8);
  const feature = [...field(2, [0, 0]), 3 * 8, type, ...field(4, geometry.flatMap(varint))];
  return field(3, [
    ...field(1, text(name)),
    ...field(2, feature),
    ...field(3, text("kind")),
    ...field(4, field(1, text(kind))),
    5 * 8,
    ...varint(4096),
    15 * 8,
    2,
  ]);
}

const TILE = Buffer.from([
  ...layer("water", "lake", 3, [
    [500, 500],
    [2500, 500],
    [2500, 2500],
    [500, 2500],
  ]),
  ...layer("roads", "highway", 2, [
    [0, 1000],
    [4096, 3000],
  ]),
]);

/** Roads are drawn over the map, and the credits name whose data they are; a page without a basemap asks for no tiles. */
test("an operator's basemap is shown", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context, asked } = opened;
  await page.waitForFunction(() => performance.getEntriesByType("resource").some(({ name }) => name.endsWith("/api/v1/basemap")));
  assert.ok(!asked.some((path) => path.startsWith("basemap/")), "there is none");
  const map = { tilejson: "3.0.0", minzoom: 0, maxzoom: 14, bounds: [-180, -85, 180, 85], layers: ["water", "roads"] };
  const tiles = ["https://elsewhere.invalid/api/v1/basemap/{z}/{x}/{y}"];
  await page.route("**/api/v1/basemap", (route) => route.fulfill({ json: { ...map, tiles, attribution: "Somebody's map" } }));
  await page.route("**/api/v1/basemap/*/*/*", (route) =>
    route.fulfill({ body: TILE, contentType: "application/vnd.mapbox-vector-tile" }),
  );
  const tile = page.waitForRequest(/api\/v1\/basemap\/\d+\/\d+\/\d+$/);
  await page.reload();
  // Tiles are asked for beside the page, whatever the server takes its address for.
  assert.equal(new URL((await tile).url()).origin, new URL(page.url()).origin);
  await page.waitForFunction(() => document.querySelector(".maplibregl-ctrl-attrib")?.textContent.includes("Somebody's map"));
  await page.waitForTimeout(500);
  await shot(page, "basemap");
  assertNoFaults(opened);
  await context.close();
});
