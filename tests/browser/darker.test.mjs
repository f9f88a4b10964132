// Darker places nearby: looked for when somebody asks, marked on the map, and a click away.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, PHONE, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

for (const [name, device] of [
  ["desktop", undefined],
  ["phone", PHONE],
]) {
  /** The fold asks when it is opened, lists what the API has, marks it on the map, and a click shows that place's sky. */
  test(`darker places are found on a ${name}`, async () => {
    const opened = await openPage(browser, fragment(here.beside), device);
    const { page, context, asked } = opened;
    await skyShown(page);
    const isAsked = () => asked.filter((path) => path.includes("/darker?")).length;
    assert.equal(isAsked(), 0);
    assert.equal(await page.locator("#darker-title").textContent(), "Darker places within 60 km");
    await page.click("#darker summary");
    await page.waitForSelector("#darker-list button");
    const { places } = await getJson(skyPath(here.scene, "darker", here.beside, "&within_km=60&limit=6"));
    const listed = await page.locator("#darker-list button").allTextContents();
    assert.equal(listed.length, places.length);
    assert.ok(listed[0].endsWith(`${places[0].gain_mag.toFixed(1)} mag darker`), listed[0]);
    assert.equal(await page.locator("#map .darker-mark").count(), places.length);
    await shot(page, `darker-${name}`);

    // Going to one keeps the list, to compare it with the next.
    await page.locator("#darker-list button").first().click();
    await skyShown(page);
    assert.ok(Math.abs(Number(inLink(page, "lat")) - places[0].latitude_deg) < 1e-4);
    assert.equal(await page.locator("#darker-list button[aria-current=location]").count(), 1);
    assert.equal(isAsked(), 1);
    await page.click("#darker summary");
    await page.waitForSelector("#map .darker-mark", { state: "detached" });
    assertNoFaults(opened);
    await context.close();
  });
}

/** A mark on the map is its place, exactly. */
test("a mark of a darker place picks it", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&zoom=9"));
  const { page, context } = opened;
  await skyShown(page);
  await page.click("#darker summary");
  await page.waitForSelector("#map .darker-mark");
  const { places } = await getJson(skyPath(here.scene, "darker", here.beside, "&within_km=60&limit=6"));
  await page.locator("#map .darker-mark").last().dispatchEvent("click");
  await skyShown(page);
  const last = places.at(-1);
  assert.ok(Math.abs(Number(inLink(page, "lat")) - last.latitude_deg) < 2e-5);
  assert.ok(Math.abs(Number(inLink(page, "lon")) - last.longitude_deg) < 2e-5);
  assertNoFaults(opened);
  await context.close();
});
