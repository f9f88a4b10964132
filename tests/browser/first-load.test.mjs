// What is seen of the page before its scripts are there, and in how many bytes: on a slow line nobody looks at an empty box.
import assert from "node:assert/strict";
import { test } from "node:test";
import { DESKTOP, PHONE, SERVER, shot } from "./support/browser.mjs";
import { browser } from "./support/stage.mjs";

/** At 400 kbit/s a third of a second, after the answers' first bytes. */
const MAX_BYTES = 16_000;

for (const [name, device] of [
  ["desktop", DESKTOP],
  ["phone", PHONE],
]) {
  /** The page says what it is, where to search and what to do before any script is there. */
  test(`the page is seen before its scripts on a ${name}`, async () => {
    const context = await browser.newContext({ ...device, serviceWorkers: "block" });
    const page = await context.newPage();
    const asked = [];
    page.on("request", (request) => asked.push(new URL(request.url()).pathname));
    // Scripts never come.
    await page.route(/\.js$/, () => {});
    await page.goto(`${SERVER}/`, { waitUntil: "commit" });
    await page.waitForFunction(() => performance.getEntriesByName("first-contentful-paint").length > 0);
    for (const seen of ["h1", "#search", ".welcome h2", ".welcome li >> nth=0"])
      assert.ok(await page.locator(seen).isVisible(), seen);
    const inView = await page.locator(".welcome h2").evaluate((title) => title.getBoundingClientRect().bottom < innerHeight);
    assert.ok(inView, "what the page is for is seen without scrolling");
    assert.equal(await page.$eval("#map", (map) => getComputedStyle(map, "::after").content), '"Loading the map…"');
    assert.equal(await page.$eval("h1", (title) => getComputedStyle(title).display), "flex", "it has its styles");
    // They are asked for before the scripts, which take their share of the line.
    const [style, script] = [/\.css$/, /\.js$/].map((kind) => asked.findIndex((path) => kind.test(path)));
    assert.ok(style > 0 && style < script, `${asked}`);
    const bytes = await page.evaluate(() =>
      [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")]
        .filter(({ name, entryType }) => entryType === "navigation" || name.endsWith(".css"))
        .map(({ encodedBodySize }) => encodedBodySize),
    );
    const sum = bytes.reduce((all, size) => all + size, 0);
    assert.ok(bytes.length === 2 && sum > 5_000 && sum < MAX_BYTES, `${bytes}`);
    await shot(page, `first-load-${name}`);
    await context.close();
  });
}
