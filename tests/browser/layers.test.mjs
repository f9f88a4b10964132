// Layers of the map that are computed: how bright the zenith is everywhere, and which lights cause one sky.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, openPage, screenColours, shot, skyShown } from "./support/browser.mjs";
import { browser, here } from "./support/stage.mjs";

/** A layer is switched on, and its tiles can be had. */
async function layerShown(page, name) {
  await page.waitForSelector(`#layer-note-${name}[data-state=shown]`, { timeout: 90_000 });
}

/** The zenith's brightness is a layer of the map with a legend, of the air and lamps chosen. */
test("the zenith's brightness is a layer", async () => {
  const opened = await openPage(browser, `#scene=${here.scene.id}`);
  const { page, context, asked } = opened;
  await layerShown(page, "radiance");
  await page.uncheck("#layer-radiance");
  const before = await screenColours(browser, page, "#map");
  await page.check("#layer-brightness");
  assert.match((await page.locator("#layer-note-brightness").textContent()) ?? "", /every place/);
  await layerShown(page, "brightness");
  await page.waitForTimeout(1500);
  const after = await screenColours(browser, page, "#map");
  assert.ok(after.count > before.count + 200, `${before.count} colours without the layer, ${after.count} with it`);
  assert.match((await page.locator("#layer-note-brightness").textContent()) ?? "", /1 %.*40 × the natural sky/);
  assert.match(page.url(), /brightness=0\.8/);
  await shot(page, "brightness");
  // Other lamps make another map. It takes as long as the first: nobody waits for it here.
  await page.selectOption("#lamp", "led_4000k");
  await page.waitForSelector("#layer-note-brightness[data-state=loading]");
  assert.ok(
    asked.some((path) => /tiles\/brightness\/tilejson.*lamp=led_4000k/.test(path)),
    "no map of the other lamps was asked for",
  );
  assertNoFaults(opened);
  await context.close();
});

/** Which lights cause a place's sky is a layer that follows the place and the measure. */
test("the lights that cause a sky are a layer", async () => {
  const opened = await openPage(browser, `#scene=${here.scene.id}`);
  const { page, context, asked } = opened;
  assert.ok(await page.locator("#layer-influence").isDisabled());
  assert.equal(await page.locator("#layer-hint-influence").textContent(), "Pick a place first.");
  const { latitude_deg, longitude_deg } = here.beside;
  await page.fill("#search", `${latitude_deg}, ${longitude_deg}`);
  await page.press("#search", "Enter");
  await skyShown(page);
  assert.ok(await page.locator("#measure").isHidden());
  await page.check("#layer-influence");
  await layerShown(page, "influence");
  const zenith = await page.locator("#layer-note-influence").textContent();
  assert.match(zenith ?? "", /1\/10,000.*cd\/m² from one light/);
  await page.waitForTimeout(1500);
  await shot(page, "influence");
  await page.selectOption("#measure", "horizontal");
  await page.waitForFunction((text) => {
    const note = document.querySelector("#layer-note-influence");
    return note.dataset.state === "shown" && note.textContent !== text;
  }, zenith);
  assert.match((await page.locator("#layer-note-influence").textContent()) ?? "", /lx from one light/);
  assert.ok(asked.some((path) => /tiles\/influence\/tilejson\.json\?.*measure=horizontal/.test(path)));
  assert.match(page.url(), /measure=horizontal/);
  // A link brings it back.
  await page.reload();
  await skyShown(page);
  await layerShown(page, "influence");
  assert.equal(await page.inputValue("#measure"), "horizontal");
  assertNoFaults(opened);
  await context.close();
});

/** One colour scale lies on the map at a time; what is chosen of the sky counts for the plan too, and the other way round. */
test("one coloured layer is on at a time", async () => {
  const { latitude_deg, longitude_deg } = here.beside;
  const opened = await openPage(browser, `#scene=${here.scene.id}&lat=${latitude_deg}&lon=${longitude_deg}&elevation=0.6`);
  const { page, context } = opened;
  await skyShown(page);
  await page.check("#layer-influence");
  const on = () => page.$$eval(".layer input[type=checkbox]:checked", (boxes) => boxes.map(({ id }) => id));
  assert.deepEqual(await on(), ["layer-influence", "layer-elevation"]);
  await page.selectOption("#measure", "horizontal");
  assert.equal(await page.inputValue("#plan-measure"), "horizontal");
  await page.selectOption("#plan-measure", "mean");
  assert.equal(await page.inputValue("#measure"), "mean");
  await page.check("#layer-radiance");
  assert.deepEqual(await on(), ["layer-radiance", "layer-elevation"]);
  // So it is in a link that names two.
  const both = `#scene=${here.scene.id}&lat=${latitude_deg}&lon=${longitude_deg}&influence=0.9&brightness=0.8`;
  await page.evaluate((link) => {
    location.hash = link;
  }, both);
  await page.waitForSelector("#layer-influence:checked");
  assert.deepEqual(await on(), ["layer-influence"]);
  assert.doesNotMatch(page.url(), /brightness/);
  assertNoFaults(opened);
  await context.close();
});

/** The map shows light on slopes and walls, of which no light has its part: what influences are of stays, and a link brings it back. */
test("a map shows the light on slopes", async () => {
  const { latitude_deg, longitude_deg } = here.beside;
  const opened = await openPage(browser, `#scene=${here.scene.id}&lat=${latitude_deg}&lon=${longitude_deg}&brightness=0.8`);
  const { page, context, asked, faults } = opened;
  await skyShown(page);
  await layerShown(page, "brightness");
  // The map itself takes a minute or two.
  await page.route(/tilejson\.json\?.*measure=slope/, (route) =>
    route.fulfill({
      status: 503,
      headers: { "retry-after": "1", "content-type": "application/problem+json" },
      body: '{"type":"/problems/being-made","title":"This is being made","status":503,"progress":0.1}',
    }),
  );
  const request = page.waitForRequest(/tilejson\.json\?.*measure=slope/);
  await page.selectOption("#map-measure", "slope");
  await request;
  assert.ok(asked.some((path) => /tiles\/brightness\/tilejson\.json\?.*measure=slope/.test(path)));
  assert.match(page.url(), /surface=slope/);
  assert.equal(await page.inputValue("#measure"), "zenith");
  await page.reload();
  await page.locator("#map[data-basemap]").waitFor();
  assert.equal(await page.inputValue("#map-measure"), "slope");
  await page.selectOption("#map-measure", "horizontal");
  assert.doesNotMatch(page.url(), /surface/);
  assert.equal(await page.inputValue("#measure"), "horizontal");
  assert.deepEqual(
    faults.filter((fault) => !/status of 503/.test(fault)),
    [],
  );
  await context.close();
});

/** A drag of the map that ends over a panel or beside the map ends there. */
test("a drag ends over a panel", async () => {
  const opened = await openPage(browser, `#scene=${here.scene.id}`);
  const { page, context } = opened;
  await page.waitForSelector("#map[data-basemap=fine]");
  const map = await page.locator("#map").boundingBox();
  const panel = await page.locator("#layers").boundingBox();
  for (const [x, y] of [
    [panel.x + 40, panel.y + 40],
    [map.x + map.width + 60, map.y + 200],
  ]) {
    const before = page.url();
    await page.mouse.move(map.x + map.width - 120, map.y + map.height - 200);
    await page.mouse.down();
    await page.mouse.move(map.x + map.width / 2, map.y + map.height / 2, { steps: 4 });
    await page.mouse.move(x, y, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction((url) => location.href !== url, before);
    const after = page.url();
    await page.mouse.move(map.x + map.width / 2, map.y + 300, { steps: 4 });
    await page.waitForTimeout(500);
    assert.equal(page.url(), after);
  }
  assertNoFaults(opened);
  await context.close();
});

/** On a slow line the page says that its map is on the way. */
test("a slow page says that the map is loading", async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  let release = () => {};
  const held = new Promise((resolve) => {
    release = resolve;
  });
  await page.route(/countries-/, async (route) => {
    await held;
    await route.continue();
  });
  await page.goto(`${process.env.SKYGLOW_URL}/`);
  const said = () => page.$eval("#map", (map) => getComputedStyle(map, "::after").content);
  await page.waitForFunction(() => getComputedStyle(document.querySelector("#map"), "::after").content !== "none");
  assert.equal(await said(), '"Loading the map…"');
  release();
  await page.waitForSelector("#map[data-basemap]");
  assert.equal(await said(), "none");
  await context.close();
});
