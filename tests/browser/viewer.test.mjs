// The viewer's main job: a place is picked, and its sky appears with its numbers.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  assertNoFaults,
  canvasColours,
  DESKTOP,
  getJson,
  numbersShown,
  openPage,
  screenColours,
  shot,
  skyShown,
} from "./support/browser.mjs";
import { COMPACT_ERROR, sample, skyPath } from "./support/sky.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

const text = (page, key) => page.locator(`[data-value=${key}]`).textContent();

/** The browser has WebGL2 and the map is drawn with lights and names. */
test("the map is drawn with lights and names", async () => {
  const opened = await openPage(browser);
  const { page, context, asked } = opened;
  assert.ok(await page.evaluate(() => document.createElement("canvas").getContext("webgl2") !== null), "no WebGL2 context");
  // Tiles may have come before one can wait for the next.
  const tileAsked = () => asked.some((path) => /tiles\/radiance\/\d+/.test(path));
  for (let tries = 0; tries < 300 && !tileAsked(); tries++) await page.waitForTimeout(100);
  assert.ok(tileAsked(), "no tile was asked for within half a minute");
  await page.waitForTimeout(1500);
  const { count } = await screenColours(browser, page, "#map");
  assert.ok(count > 200, `the map shows only ${count} colours`);
  assert.ok(asked.includes(`scenes/${here.scene.id}/tiles/radiance/tilejson.json`));
  await shot(page, "map");
  assertNoFaults(opened);
  await context.close();
});

/** The demo is said to be illustrative, and every scene can be chosen. */
test("the demo is marked as illustrative", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  const options = await page.locator("#scene option").allTextContents();
  assert.equal(options.length, here.scenes.length);
  if (here.scene.illustrative) {
    assert.match(options.join(), /illustrative/);
    assert.match((await page.locator("#scene-note").textContent()) ?? "", /illustrative/i);
  }
  assertNoFaults(opened);
  await context.close();
});

/** A click gives a marker, then the site, the numbers and the picture, all as the API says. */
test("a click gives site, numbers and picture", async () => {
  const { beside } = here;
  // With all its motion, for once.
  const moving = { ...DESKTOP, reducedMotion: "no-preference" };
  const opened = await openPage(browser, `#scene=${here.scene.id}&map=8/${beside.latitude_deg}/${beside.longitude_deg}`, moving);
  const { page, context, asked } = opened;
  assert.equal(await page.locator(".pin").count(), 0);
  const box = await page.locator("#map").boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForSelector(".pin");
  await skyShown(page);

  const place = new URLSearchParams(new URL(page.url()).hash.slice(1));
  const clicked = { latitude_deg: Number(place.get("lat")), longitude_deg: Number(place.get("lon")) };
  assert.ok(Math.abs(clicked.latitude_deg - beside.latitude_deg) < 0.01, "the middle of the map is where it was put");
  const order = asked.filter((path) => /\/(site|sky|panorama\.sky)\?/.test(path)).map((path) => path.split(/[/?]/)[2]);
  assert.deepEqual(order, ["site", "sky", "panorama.sky"]);

  const { sky } = await getJson(skyPath(here.scene, "sky", clicked));
  assert.equal(await text(page, "zenith_mag"), sky.zenith_brightness_mag_arcsec2.toFixed(2));
  assert.equal(await text(page, "bortle_class"), String(sky.bortle_class));
  assert.match((await text(page, "naked_eye_limit")) ?? "", new RegExp(`^${sky.naked_eye_limit_mag.toFixed(2)} `));
  assert.match((await text(page, "sqm")) ?? "", new RegExp(`^${sky.sqm_total_brightness_mag_arcsec2.toFixed(2)} `));
  assert.ok((await page.locator(".notes").textContent())?.includes("satellite sees no blue"), "the lamp is named as an assumption");

  // The map glides there, and on a fast machine the sky is there first.
  await page
    .waitForFunction(
      () => {
        const [pin, map] = [".pin", "#map"].map((name) => document.querySelector(name).getBoundingClientRect());
        return pin.top > map.top && pin.top < map.bottom;
      },
      undefined,
      { timeout: 5_000 },
    )
    .catch(() => assert.fail("the marker stays in view when the sky appears"));
  const colours = await canvasColours(page, ".sky-picture");
  assert.ok(colours > 60, `the picture has only ${colours} colours`);
  const times = await page.evaluate(() =>
    Object.fromEntries(performance.getEntriesByType("measure").map(({ name, duration }) => [name, Math.round(duration)])),
  );
  console.log(
    `milliseconds after the click: site ${times["sky:site"]}, numbers ${times["sky:numbers"]}, picture ${times["sky:picture"]}`,
  );
  await shot(page, "clicked");
  assertNoFaults(opened);
  await context.close();
});

/** The readout shows the API's own value at the pointed direction. */
test("the readout shows the API's own value", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&sky=artificial"));
  const { page, context } = opened;
  await skyShown(page);
  const panorama = await getJson(skyPath(here.scene, "panorama.json", here.beside));
  const canvas = page.locator(".sky-overlay");
  const box = await canvas.boundingBox();
  const readout = page.locator("#sky-readout");
  // The frame leaves 34 px at the left, 8 at the right and top, 28 below.
  const plot = { left: 34, top: 8, width: box.width - 42, height: box.height - 36 };
  for (const [azimuthDeg, elevationDeg] of [
    [45, 10],
    [90, 45],
    [200, 3],
    [300, 80],
  ]) {
    await canvas.hover({
      position: { x: plot.left + (azimuthDeg / 360) * plot.width, y: plot.top + (1 - elevationDeg / 90) * plot.height },
    });
    const shown = await readout.evaluate(({ dataset }) => [dataset.azimuthDeg, dataset.elevationDeg, dataset.seen].map(Number));
    const expected = sample(panorama, shown[0], shown[1]);
    assert.ok(
      Math.abs(shown[0] - azimuthDeg) < 1.5 && Math.abs(shown[1] - elevationDeg) < 1.5,
      `${shown} for ${azimuthDeg}, ${elevationDeg}`,
    );
    assert.deepEqual([expected.azimuth_deg, expected.elevation_deg], shown.slice(0, 2));
    assert.ok(Math.abs(shown[2] / expected.luminance_cd_m2 - 1) < COMPACT_ERROR, `${shown[2]} for ${expected.luminance_cd_m2}`);
    const magnitude = (-2.5 * Math.log10(shown[2] / 1.08e5)).toFixed(2);
    assert.ok((await readout.textContent()).includes(`${magnitude} mag/arcsec²`));
  }
  assertNoFaults(opened);
  await context.close();
});

/** The fisheye has east on the left and the zenith in the middle. */
test("the fisheye has east on the left", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await page.getByRole("radio", { name: "Fisheye" }).click();
  const canvas = page.locator(".sky-overlay");
  await page.waitForTimeout(300);
  const box = await canvas.boundingBox();
  const radius = Math.min(box.width, box.height) / 2 - 26;
  const readout = page.locator("#sky-readout");
  const azimuthAt = async (right, down) => {
    await canvas.hover({ position: { x: box.width / 2 + right * radius, y: box.height / 2 + down * radius } });
    return readout.evaluate(({ dataset }) => ({
      azimuth_deg: Number(dataset.azimuthDeg),
      elevation_deg: Number(dataset.elevationDeg),
    }));
  };
  assert.ok(Math.abs((await azimuthAt(-0.9, 0)).azimuth_deg - 90) < 1.5);
  assert.ok(Math.abs((await azimuthAt(0.9, 0)).azimuth_deg - 270) < 1.5);
  assert.ok(Math.abs((await azimuthAt(0, 0.9)).azimuth_deg - 180) < 1.5);
  assert.ok((await azimuthAt(0, -0.5)).azimuth_deg % 360 < 1.5);
  assert.ok((await azimuthAt(0.005, 0)).elevation_deg > 88);
  assert.ok((await canvasColours(page, ".sky-picture")) > 60);
  assert.match(page.url(), /projection=fisheye/);
  await shot(page, "fisheye");
  assertNoFaults(opened);
  await context.close();
});

/** Another lamp and hazier air change the numbers to the API's for them. */
test("lamps and air change the numbers", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  const first = await text(page, "zenith_mag");
  await page.selectOption("#lamp", "led_4000k");
  const led = await getJson(skyPath(here.scene, "sky", here.beside, "&lamp=led_4000k"));
  await numbersShown(page, led.sky);
  assert.notEqual(await text(page, "zenith_mag"), first);
  await page.locator("#turbidity").fill("4.2");
  const hazy = await getJson(skyPath(here.scene, "sky", here.beside, "&lamp=led_4000k&turbidity=4.2"));
  await numbersShown(page, hazy.sky);
  assert.notEqual(hazy.sky.zenith_brightness_mag_arcsec2, led.sky.zenith_brightness_mag_arcsec2);
  await page.selectOption("#emission", "full_cutoff");
  const shielded = await getJson(skyPath(here.scene, "sky", here.beside, "&lamp=led_4000k&turbidity=4.2&emission=full_cutoff"));
  await numbersShown(page, shielded.sky);
  assert.match(page.url(), /turbidity=4\.2&lamp=led_4000k&emission=full_cutoff/);
  // Shares of one's own, and the other convention, in place of a usual kind's.
  await page.click("#emission-shares summary");
  await page.selectOption("#emission", "garstang_1986");
  assert.equal(await page.inputValue("#direct-uplight"), "15");
  await page.locator("#direct-uplight").fill("5");
  await page.selectOption("#emission-keep", "nadir_radiance");
  const own = "&emission=garstang_1986&direct_uplight=0.05&emission_keep=nadir_radiance";
  const shares = await getJson(skyPath(here.scene, "sky", here.beside, `&lamp=led_4000k&turbidity=4.2${own}`));
  await numbersShown(page, shares.sky);
  assert.match(page.url(), /emission=garstang_1986&uplight=0\.05&keep=nadir_radiance/);
  assertNoFaults(opened);
  await context.close();
});

/** Terrain hides the sky below the horizon, says so where one points, and can be left out. */
test("terrain hides the sky below the horizon", async () => {
  const valley = { latitude_deg: 46.02, longitude_deg: 7.75 };
  const opened = await openPage(browser, fragment(valley));
  const { page, context, asked } = opened;
  await skyShown(page);
  const panorama = await getJson(skyPath(here.scene, "panorama.json", valley));
  const column = panorama.horizon_deg.indexOf(Math.max(...panorama.horizon_deg));
  const azimuthDeg = column * panorama.grid.azimuth_step_deg;
  assert.ok(panorama.horizon_deg[column] > 3, `the highest ground is at ${panorama.horizon_deg[column]} degrees`);
  const canvas = page.locator(".sky-overlay");
  const box = await canvas.boundingBox();
  const plot = { left: 34, top: 8, width: box.width - 42, height: box.height - 36 };
  const position = { x: plot.left + (azimuthDeg / 360) * plot.width, y: plot.top + (1 - 1 / 90) * plot.height };
  await canvas.hover({ position });
  assert.match((await page.locator("#sky-readout").textContent()) ?? "", /below the horizon/);
  await shot(page, "terrain");
  await page.selectOption("#terrain", "off");
  const open = await getJson(skyPath(here.scene, "sky", valley, "&terrain=off"));
  await numbersShown(page, open.sky);
  await page.waitForFunction(() => !document.querySelector("#sky-readout")?.textContent?.includes("below the horizon"));
  assert.match(page.url(), /terrain=off/);
  assert.ok(asked.some((path) => /panorama\.sky\?.*terrain=off/.test(path)));
  assertNoFaults(opened);
  await context.close();
});

/** The natural sky can be added to picture and readout; the numbers tell it always. */
test("the natural sky can be added", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&sky=artificial"));
  const { page, context, asked } = opened;
  await skyShown(page);
  const before = asked.length;
  await page.getByRole("radio", { name: "With natural sky" }).click();
  const { sky } = await getJson(skyPath(here.scene, "sky", here.beside));
  assert.equal(await text(page, "zenith_total_mag"), sky.zenith_total_brightness_mag_arcsec2.toFixed(2));
  const panorama = await getJson(skyPath(here.scene, "panorama.json", here.beside));
  await page.locator(".sky-overlay").hover({ position: { x: 300, y: 60 } });
  const shown = await page
    .locator("#sky-readout")
    .evaluate(({ dataset }) => [dataset.azimuthDeg, dataset.elevationDeg, dataset.seen].map(Number));
  const expected = sample(panorama, shown[0], shown[1]).luminance_cd_m2 + panorama.dark_reference.value;
  assert.ok(Math.abs(shown[2] / expected - 1) < COMPACT_ERROR);
  assert.deepEqual(
    asked.slice(before).filter((path) => /panorama|sky\?/.test(path)),
    [],
    "no new request is needed",
  );
  assertNoFaults(opened);
  await context.close();
});
