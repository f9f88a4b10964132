// Lamps are spectra: what eyes and instruments see of them, and what a swap of lamps changes for each.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, setSlider, shot, skyShown } from "./support/browser.mjs";
import { COMPACT_ERROR, sample, skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const LAMP = "&lamp=hps&emission=modern_city";
const number = (text) => Number(text.replace("−", "-").replace(/ .*/, ""));

/** Sodium swapped for white LED as bright on the street: little changes for the eye adapted to light, much for that adapted to the dark. */
test("a swap of lamps is told for every eye", async () => {
  const { town, beside, scene } = here;
  const map = `&map=8/${town.latitude_deg}/${town.longitude_deg}&lamp=hps`;
  const opened = await openPage(browser, fragment(beside, map));
  const { page, context } = opened;
  await skyShown(page);
  await page.selectOption("#paint-kind", "lamp");
  await page.selectOption("#paint-lamp", "led_4000k");
  await setSlider(page, "paint-radius", 40);
  await page.click("#paint-draw");
  await page.focus("#map canvas");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => location.hash.includes("scenario=s-"));
  await page.waitForSelector("#paint-answer .comparison");
  const before = (await getJson(skyPath(scene, "sky", beside, LAMP))).sky;
  const after = (await getJson(skyPath(scene, "sky", beside, `${LAMP}&scenario=${inLink(page, "scenario")}`))).sky;
  const change = (key) => page.locator(`[data-change=${key}] b`).textContent();
  const percent = (name) => 100 * (after[name] / before[name] - 1);
  assert.ok(Math.abs(number(await change("photopic")) - percent("zenith_luminance_cd_m2")) < 0.6);
  assert.ok(Math.abs(number(await change("scotopic")) - percent("zenith_scotopic_luminance_cd_m2")) < 0.6);
  assert.ok(percent("zenith_scotopic_luminance_cd_m2") > 5 * percent("zenith_luminance_cd_m2"));
  const meter = before.sqm_total_brightness_mag_arcsec2 - after.sqm_total_brightness_mag_arcsec2;
  assert.ok(Math.abs(number(await change("sqm")) - meter) < 0.006);
  assert.match(await page.locator("#paint-answer").textContent(), /bluer than before/);
  // The same is told while today's lights are shown.
  const told = await page.locator("#paint-answer").textContent();
  await page.click("#lights button[value=today]");
  await skyShown(page);
  assert.equal(await page.locator("#paint-answer").textContent(), told);
  await shot(page, "lamp-swap");
  await page.click("#paint-clear");
  await skyShown(page);
  assert.equal(await page.locator("#paint-answer").textContent(), "");
  assertNoFaults(opened);
  await context.close();
});

/** Experts choose what sees the sky: picture, readout, legend, layers and files follow, and a link has it. */
test("what sees the sky is chosen", async () => {
  const { beside, scene } = here;
  const opened = await openPage(browser, fragment(beside, "&sky=artificial&colours=inferno"));
  const { page, context, asked } = opened;
  await skyShown(page);
  await page.locator("#seen summary").click();
  await page.selectOption("#response", "scotopic");
  await skyShown(page);
  assert.equal(inLink(page, "response"), "scotopic");
  const panorama = await getJson(skyPath(scene, "panorama.json", beside, "&response=scotopic"));
  await page.locator(".sky-overlay").hover({ position: { x: 300, y: 60 } });
  const shown = await page.locator("#sky-readout").evaluate(({ dataset }) => ({ ...dataset }));
  const expected = sample(panorama, Number(shown.azimuthDeg), Number(shown.elevationDeg)).luminance_cd_m2;
  assert.ok(Math.abs(Number(shown.seen) / expected - 1) < COMPACT_ERROR, `${shown.seen} for ${expected}`);
  assert.match(await page.locator("#legend-title").textContent(), /^Eye adapted to the dark · .*cd\/m²/);
  assert.ok(await page.locator("#unit option[value=magnitude]").isDisabled(), "it has no magnitude");
  const png = () => page.locator("#download-links a").first().getAttribute("href");
  assert.match(await png(), /response=scotopic.*scale=luminance/);
  assert.equal((await fetch(await png())).status, 200);
  for (const file of ["EXR", "TIFF"]) {
    const href = await page.locator("#download-links a", { hasText: file }).getAttribute("href");
    assert.equal((await fetch(href)).status, 200, href);
  }
  await page.check("#layer-influence");
  await page.waitForSelector("#layer-note-influence[data-state=shown]");
  assert.match(await page.locator("#layer-note-influence").textContent(), /cd\/m² from one light.*Eye adapted to the dark/);
  assert.ok(asked.some((path) => /tiles\/influence\/tilejson.*response=scotopic/.test(path)));
  // The satellite's unit is its own.
  await page.selectOption("#response", "dnb");
  await skyShown(page);
  assert.equal(await page.locator("#unit-of-values").textContent(), "nW/cm²/sr");
  assert.match(await page.locator("#legend-title").textContent(), /nW\/cm²\/sr/);
  assert.equal((await fetch(await png())).status, 200);
  await shot(page, "response");
  // A picture in the colours of an eye is of no other response; the choice stays.
  await page.selectOption("#colours", "realistic");
  await skyShown(page);
  assert.doesNotMatch(await png(), /response/);
  assert.equal((await fetch(await png())).status, 200);
  assert.equal(inLink(page, "response"), "dnb");
  await page.selectOption("#colours", "inferno");
  await page.selectOption("#response", "sqm");
  await page.reload();
  await skyShown(page);
  assert.equal(await page.locator("#response").inputValue(), "sqm");
  assert.match(await png(), /response=sqm.*scale=magnitude/);
  assertNoFaults(opened);
  await context.close();
});

/** The colour of the zenith and what others see of it are among the numbers, and all lamps among the choices. */
test("the colour of the zenith is among the numbers", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&sky=artificial&lamp=hps:0.7,led_4000k:0.3"));
  const { page, context } = opened;
  await skyShown(page);
  const { sky, lamp } = await getJson(skyPath(here.scene, "sky", here.beside, "&lamp=hps:0.7,led_4000k:0.3"));
  await page.locator("#colour summary").click();
  const told = async (key) => number(await page.locator(`[data-value=${key}] b`).textContent());
  assert.ok(Math.abs((await told("scotopic_photopic_ratio")) - sky.zenith_scotopic_photopic_ratio) < 0.006);
  assert.ok(Math.abs((await told("colour_temperature")) - sky.zenith_colour_temperature_k) <= 5);
  assert.ok(Math.abs((await told("lamp_colour_temperature")) - lamp.colour_temperature_k) <= 5);
  const blue = sky.zenith_by_response.find(({ response }) => response === "johnson_b");
  assert.ok(Math.abs((await told("zenith_johnson_b")) - blue.brightness_mag_arcsec2) < 0.006);
  const options = await page.locator("#lamp option").evaluateAll((all) => all.map(({ value }) => value));
  assert.equal(new Set(options).size, options.length);
  assert.ok(options.length === 22 && !options.includes("neutral"), `${options}`);
  assert.equal(
    await page.locator("#lamp option:checked").textContent(),
    "70 % high-pressure sodium, 2000 K + 30 % white LED, 4000 K",
  );
  assert.deepEqual(await page.locator("#lamp optgroup").evaluateAll((groups) => groups.map(({ label }) => label)), [
    "Sodium",
    "LED",
    "Others",
  ]);
  assertNoFaults(opened);
  await context.close();
});
