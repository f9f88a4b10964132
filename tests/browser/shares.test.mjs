// Whose light it is, by name: towns below the picture, and the areas of somebody's own file.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, PHONE, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const rows = (page) => page.locator("#shares-list li").allTextContents();
const REGION = "170,10;190,10;190,30;170,30";

/** The largest shares are listed as the API has them, and told in the sentence; they are asked for after the picture. */
test("towns are listed by their shares", async () => {
  for (const device of [undefined, PHONE]) {
    const opened = await openPage(browser, fragment(here.beside), device);
    const { page, context, asked } = opened;
    await page.waitForSelector("#shares-list button");
    const { places, measure } = await getJson(skyPath(here.scene, "shares", here.beside, "&limit=12"));
    assert.equal(measure, "zenith");
    const [first = ""] = await rows(page);
    assert.ok(first.startsWith(places[0].name), first);
    const told = Number(first.match(/([\d.]+) %$/)[1]);
    assert.ok(Math.abs(told - 100 * places[0].share) < 0.51, `${first} for ${places[0].share}`);
    const sentence = await page.locator("#summary").textContent();
    assert.match(sentence, new RegExp(`\\d+\\s% of the glow comes from ${places[0].name}`));
    const order = (part) => asked.findIndex((path) => path.includes(part));
    assert.ok(order("/shares?") > order("/panorama.sky?") && order("/panorama.sky?") >= 0);
    // The same of the light on the ground.
    await page.click("#shares-of button[value=ground]");
    const ground = await getJson(skyPath(here.scene, "shares", here.beside, "&limit=12&measure=horizontal"));
    const [town] = ground.places;
    await page.waitForFunction(() => /of the light on the ground/.test(document.querySelector("#summary").textContent));
    const [onGround = ""] = await rows(page);
    assert.ok(onGround.startsWith(town.name), onGround);
    assert.ok(Math.abs(Number(onGround.match(/([\d.]+) %$/)[1]) - 100 * town.share) < 0.51, `${onGround} for ${town.share}`);
    await shot(page, device === PHONE ? "shares-phone" : "shares");
    assertNoFaults(opened);
    await context.close();
  }
});

/** A town that is pointed at or has the focus is shown on the map, until the focus leaves it. */
test("a town in the list shows on the map", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  const button = page.locator("#shares-list button").first();
  await button.focus();
  const name = (await button.locator("span").evaluate((span) => span.firstChild.textContent)) ?? "";
  assert.equal(await page.locator(".shown-town").textContent(), name);
  await page.locator("#search").focus();
  await page.waitForSelector(".shown-town", { state: "detached" });
  await button.hover();
  assert.equal(await page.locator(".shown-town").textContent(), name);
  assertNoFaults(opened);
  await context.close();
});

/** A marked part of the sky has shares of its own, and the sentence does not speak of them. */
test("a marked part has its own shares", async () => {
  const opened = await openPage(browser, fragment(here.beside, `&region=${REGION}&measure=region`));
  const { page, context, asked } = opened;
  await page.waitForSelector("#shares-list button");
  assert.equal(await page.locator("#shares-title").textContent(), "Whose light in the marked part");
  const { places } = await getJson(skyPath(here.scene, "shares", here.beside, `&measure=region&region=${REGION}`));
  const [first = ""] = await rows(page);
  assert.ok(first.startsWith(places[0].name), first);
  assert.doesNotMatch(await page.locator("#summary").textContent(), /of the glow/);
  await page.click("#mark");
  await page.waitForFunction(() => document.querySelector("#summary")?.textContent?.includes("of the glow"));
  assert.equal(await page.locator("#shares-title").textContent(), "Whose light");
  assert.equal(asked.filter((path) => path.includes("/shares?")).length, 2);
  assertNoFaults(opened);
  await context.close();
});

/** Another place ends what is under way for the one before, and nothing of that is shown. */
test("another place ends the search for shares", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await page.waitForSelector("#shares-list button");
  let release = () => {};
  const held = new Promise((resolve) => {
    release = resolve;
  });
  await page.route("**/shares?*", async (route) => {
    await held;
    await route.continue().catch(() => {});
  });
  const next = { ...here.beside, latitude_deg: here.beside.latitude_deg + 0.05 };
  await page.evaluate((hash) => (location.hash = hash), fragment(next));
  await page.waitForSelector("#shares[aria-busy=true]");
  await skyShown(page);
  assert.deepEqual(await rows(page), []);
  assert.match(await page.locator("#shares-waiting").textContent(), /Finding/);
  assert.doesNotMatch(await page.locator("#summary").textContent(), /of the glow/);
  release();
  await page.waitForSelector("#shares-list button");
  assertNoFaults(opened);
  await context.close();
});

/** Boundaries of a file get their shares by name, as a table and as CSV; a file of something else is refused in words. */
test("areas of a file get their shares", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await page.waitForSelector("#shares-list button");
  await page.click("#shares summary");
  const { latitude_deg: lat, longitude_deg: lon } = here.town;
  const square = [
    [lon - 0.2, lat - 0.2],
    [lon + 0.2, lat - 0.2],
    [lon + 0.2, lat + 0.2],
    [lon - 0.2, lat + 0.2],
    [lon - 0.2, lat - 0.2],
  ];
  const feature = { type: "Feature", properties: { name: "Ours" }, geometry: { type: "Polygon", coordinates: [square] } };
  const file = (name, value) => ({ name, mimeType: "application/geo+json", buffer: Buffer.from(value) });
  await page.setInputFiles("#areas-file", file("notes.geojson", "no JSON"));
  await page.waitForSelector("#notice:not([hidden])");
  assert.match(await page.locator("#notice").textContent(), /notes.geojson is no GeoJSON file/);
  await page.setInputFiles("#areas-file", file("ours.geojson", JSON.stringify({ type: "FeatureCollection", features: [feature] })));
  await page.waitForSelector("#areas-answer table");
  const table = await page.locator("#areas-answer tr").allTextContents();
  assert.match(table[0], /^Ours\d/);
  assert.match(table[1], /^All others\d/);
  const percents = table.map((line) => Number(line.match(/([\d.]+) %$/)[1]));
  assert.ok(Math.abs(percents[0] + percents[1] - 100) < 0.6, `${percents}`);
  await shot(page, "areas");
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#areas-answer button:first-of-type")]);
  assert.equal(download.suggestedFilename(), "ours-shares.csv");
  assert.match(await readFile(await download.path(), "utf8"), /Ours/);
  await page.click("#areas-answer button:last-of-type");
  await page.waitForSelector("#areas-answer table", { state: "detached" });
  assertNoFaults(opened);
  await context.close();
});

/** Areas lie on the map with their shares, which a mouse reads by pointing and a finger by tapping; a property names them. */
test("areas show their shares on the map", async () => {
  const { latitude_deg: lat, longitude_deg: lon } = here.town;
  const square = [
    [lon - 0.1, lat - 0.1],
    [lon + 0.1, lat - 0.1],
    [lon + 0.1, lat + 0.1],
    [lon - 0.1, lat + 0.1],
    [lon - 0.1, lat - 0.1],
  ];
  const properties = { code: 5113, GEN: "Ours" };
  const feature = { type: "Feature", properties, geometry: { type: "Polygon", coordinates: [square] } };
  const buffer = Buffer.from(JSON.stringify({ type: "FeatureCollection", features: [feature] }));
  for (const device of [undefined, PHONE]) {
    const opened = await openPage(browser, fragment(here.beside, `&map=8/${lat}/${lon}`), device);
    const { page, context, asked } = opened;
    await page.waitForSelector("#shares-list button");
    await page.click("#shares summary");
    await page.setInputFiles("#areas-file", { name: "ours.geojson", mimeType: "application/geo+json", buffer });
    await page.waitForFunction(() => /^area 1/.test(document.querySelector("#areas-answer tbody")?.textContent ?? ""));
    await page.selectOption("#areas-name", "GEN");
    await page.waitForFunction(() => /^Ours/.test(document.querySelector("#areas-answer tbody")?.textContent ?? ""));
    assert.ok(asked.some((path) => path.includes("name_field=GEN")));
    const share = (await page.locator("#areas-answer tbody td").textContent()) ?? "";
    await page.evaluate(() => scrollTo(0, 0));
    const { x, y, width, height } = await page.locator("#map").boundingBox();
    const before = inLink(page, "lat");
    const tip = page.locator(".area-tip:not(.light-tip)");
    // The map draws what it was given within some frames.
    for (let tries = 0; tries < 40 && (await tip.isHidden()); tries++) {
      if (device === PHONE) await page.touchscreen.tap(x + width / 2, y + height / 2);
      else await page.mouse.move(x + width / 2 + (tries % 2), y + height / 2);
      // Two taps soon after one another are a double tap, which zooms.
      await tip.waitFor({ timeout: device === PHONE ? 700 : 100 }).catch(() => {});
      assert.equal(inLink(page, "lat"), before, "the place stays");
    }
    assert.equal(await tip.textContent(), `${share} Ours`);
    await shot(page, device === PHONE ? "areas-map-phone" : "areas-map");
    // A second tap is one on the map; soon after the first it would be a double tap, which zooms.
    if (device === PHONE) {
      await page.waitForTimeout(600);
      await page.touchscreen.tap(x + width / 2, y + height / 2);
      await page.waitForFunction((lat) => !location.hash.includes(`lat=${lat}&`), before);
    }
    await page.locator("#shares .more").evaluate((fold) => {
      fold.open = true;
    });
    await page.waitForSelector("#areas-answer button");
    await page.click("#areas-answer button:last-of-type");
    assert.ok(await tip.isHidden());
    assertNoFaults(opened);
    await context.close();
  }
});

/** A file that holds no pixel of the scene is told of once and forgotten: other air asks for the towns alone. */
test("an area outside the scene is told once", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await page.waitForSelector("#shares-list button");
  await page.click("#shares summary");
  const west = here.scene.bounds[2] + 5;
  const ring = [
    [west, 0],
    [west + 1, 0],
    [west + 1, 1],
    [west, 0],
  ];
  const feature = { type: "Feature", properties: { name: "Far" }, geometry: { type: "Polygon", coordinates: [ring] } };
  const buffer = Buffer.from(JSON.stringify(feature));
  await page.setInputFiles("#areas-file", { name: "far.geojson", mimeType: "application/geo+json", buffer });
  await page.waitForSelector("#notice:not([hidden])");
  assert.match(await page.locator("#notice").textContent(), /far.geojson is removed: none of its areas lies in the map's scene/);
  await page.click("#notice .notice-close");
  const [answer] = await Promise.all([
    page.waitForResponse((response) => response.url().includes("/shares?") && response.url().includes("lamp=hps")),
    page.selectOption("#lamp", "hps"),
  ]);
  assert.equal(answer.request().method(), "GET");
  await page.waitForSelector("#shares[aria-busy=false]");
  assert.ok(await page.locator("#notice").isHidden());
  await context.close();
});
