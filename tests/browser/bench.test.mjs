// The lamp workbench: a measure for towns and areas, and what it does to the sky.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, numbersShown, openPage, PHONE, setSlider, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const LAMPS = "&lamp=mixed&emission=modern_city";
const row = (page, name) => page.locator(`#bench-answer tr[data-row=${name}] td`).allTextContents();

/** A measure is one scenario with one edit; the table has the API's numbers before and after; another measure takes its place. */
test("a measure changes lamps around a town", async () => {
  for (const device of [undefined, PHONE]) {
    const opened = await openPage(browser, fragment(here.beside), device);
    const { page, context } = opened;
    await page.waitForSelector("#bench-where input:checked");
    await page.click("#bench-apply");
    assert.match((await page.locator("#bench-hint").textContent()) ?? "", /Choose other lamps/);
    await page.selectOption("#bench-to", "pc_amber");
    await setSlider(page, "bench-dimmed", 30);
    await page.click("#bench-apply");
    await page.waitForSelector("#bench-answer table");
    const first = inLink(page, "scenario");
    const { edits } = await getJson(`scenarios/${first}`);
    assert.deepEqual(
      edits.map(({ lamp, factor }) => ({ lamp, factor })),
      [{ lamp: "pc_amber", factor: 0.7 }],
    );
    const { sky: today } = await getJson(skyPath(here.scene, "sky", here.beside, LAMPS));
    const { sky: after } = await getJson(skyPath(here.scene, "sky", here.beside, `${LAMPS}&scenario=${first}`));
    const mags = [today, after].map((sky) => sky.sqm_total_brightness_mag_arcsec2.toFixed(2));
    assert.deepEqual((await row(page, "sqm")).slice(0, 2), mags);
    assert.ok(after.zenith_scotopic_luminance_cd_m2 < today.zenith_scotopic_luminance_cd_m2);
    assert.match((await row(page, "scotopic"))[2], /^−\d/);
    assert.match((await row(page, "photopic"))[2], /^−\d/);
    // Of other lamps the energy is not known without their lm/W.
    assert.deepEqual(await row(page, "energy"), []);
    await page.click("#bench-card summary");
    await page.fill("#bench-efficacy-before", "100");
    await page.fill("#bench-efficacy-after", "140");
    assert.deepEqual(await row(page, "energy"), ["100 %", "50 %", "−50 %"]);
    await shot(page, device === PHONE ? "bench-phone" : "bench");
    // Dimmed after midnight alone, about half of the night.
    await page.selectOption("#bench-to", "");
    await page.selectOption("#bench-curfew", "24");
    await page.click("#bench-apply");
    await page.getByText("is the sky after 00:00, by the Sun").waitFor();
    const [, after30] = await row(page, "energy");
    assert.ok(Number.parseInt(after30, 10) >= 83 && Number.parseInt(after30, 10) <= 87, after30);
    await page.selectOption("#bench-to", "pc_amber");
    await page.selectOption("#bench-curfew", "");

    await page.selectOption("#bench-shielding", "full_cutoff");
    await page.click("#bench-apply");
    await page.waitForFunction((before) => !location.hash.includes(before), first);
    await page.waitForSelector("#bench-answer table");
    const second = inLink(page, "scenario");
    assert.equal((await getJson(`scenarios/${second}`)).edits.length, 1, "it takes the place of the one before");
    await page.click("#bench-answer button");
    await page.waitForFunction(() => !location.hash.includes("scenario="));
    await page.waitForSelector("#bench-answer table", { state: "detached" });
    await numbersShown(page, today);
    assertNoFaults(opened);
    await context.close();
  }
});

/** Areas of a file are places for a measure too, and without any place nothing is done. */
test("a measure holds in areas of a file", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await page.waitForSelector("#bench-where input:checked");
  await page.uncheck("#bench-where input:checked");
  await setSlider(page, "bench-dimmed", 50);
  await page.click("#bench-apply");
  assert.match((await page.locator("#bench-hint").textContent()) ?? "", /Choose a town or an area/);
  const { latitude_deg: lat, longitude_deg: lon } = here.town;
  const [w, s, e, n] = [lon - 0.1, lat - 0.1, lon + 0.1, lat + 0.1].map((degrees) => +degrees.toFixed(4));
  const ring = [
    [w, s],
    [e, s],
    [e, n],
    [w, n],
    [w, s],
  ];
  const feature = { type: "Feature", properties: { name: "Ours" }, geometry: { type: "Polygon", coordinates: [ring] } };
  const buffer = Buffer.from(JSON.stringify(feature));
  await page.click("#shares summary");
  await page.setInputFiles("#areas-file", { name: "ours.geojson", mimeType: "application/geo+json", buffer });
  await page.locator("#bench-where label", { hasText: "Ours" }).locator("input").check();
  await page.click("#bench-apply");
  await page.waitForSelector("#bench-answer table");
  const [edit] = (await getJson(`scenarios/${inLink(page, "scenario")}`)).edits;
  assert.deepEqual(edit.area, { type: "MultiPolygon", coordinates: [[ring]] });
  // Light that is only dimmed saves what it is dimmed by.
  assert.deepEqual(await row(page, "energy"), ["100 %", "50 %", "−50 %"]);
  assertNoFaults(opened);
  await context.close();
});
