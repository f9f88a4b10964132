// Pinned places side by side: their skies and numbers, kept in the link.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, PHONE, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

for (const [name, device] of [
  ["desktop", undefined],
  ["phone", PHONE],
]) {
  /** Two pinned places show the API's numbers and pictures of one scale, a link brings them back, and one can be gone to. */
  test(`pinned places are compared on a ${name}`, async () => {
    const opened = await openPage(
      browser,
      fragment(here.beside, `&pins=${here.town.latitude_deg},${here.town.longitude_deg}`),
      device,
    );
    const { page, context } = opened;
    await skyShown(page);
    await page.click("#pin");
    assert.equal(await page.locator("#pin").textContent(), "Unpin this place");
    assert.equal(inLink(page, "pins").split(";").length, 2);
    await page.waitForFunction(
      () => [...document.querySelectorAll("#compare dd")].filter((dd) => /\d/.test(dd.textContent)).length === 8,
    );
    for (const [i, place] of [here.town, here.beside].entries()) {
      const { sky } = await getJson(skyPath(here.scene, "sky", place));
      const shown = await page.locator("#compare li").nth(i).locator("dd").first().textContent();
      assert.equal(shown, sky.zenith_total_brightness_mag_arcsec2.toFixed(2));
    }
    await page.locator("#compare").scrollIntoViewIfNeeded();
    await page.waitForFunction(() => [...document.querySelectorAll("#compare img")].every((image) => image.naturalWidth === 512));
    // Where the horizon is dark comes last, as the search for darker places knows it.
    const { here: of } = await getJson(skyPath(here.scene, "darker", here.beside, "&within_km=2&limit=1"));
    const clean = of.low_sky.clean_directions_deg;
    const horizons = page.locator("#compare .compare-horizon");
    await horizons.nth(1).waitFor();
    assert.match(await horizons.nth(1).textContent(), clean.length === 0 ? /^bright horizon/ : /^dark horizon: /);
    const queries = await page.$$eval("#compare img", (images) => images.map(({ src }) => new URL(src).searchParams.toString()));
    assert.equal(new Set(queries.map((query) => query.replace(/l(at|on)=[^&]*/g, ""))).size, 1, `${queries}`);
    // Each is asked for once, when it is known what the eye is adapted to.
    const pictures = opened.asked.filter((path) => path.includes("/panorama.png?") && path.includes("width=512"));
    assert.deepEqual(pictures.map((path) => new URLSearchParams(path.split("?")[1]).toString()).sort(), queries.sort());
    const [left, right] = await page.$$eval("#compare img", (images) =>
      images.map((image) => image.getBoundingClientRect().toJSON()),
    );
    assert.ok(left.right <= right.left && Math.abs(left.top - right.top) < 1, "they stand side by side");
    await shot(page, `compare-${name}`);

    await page.reload();
    await skyShown(page);
    assert.equal(await page.locator("#compare li").count(), 2);
    await page.locator("#compare .compare-name").first().click();
    await page.waitForFunction((latitude) => location.hash.includes(`lat=${latitude}`), here.town.latitude_deg);
    await skyShown(page);
    await page.locator("#compare .compare-drop").first().click();
    assert.equal(await page.locator("#compare li").count(), 1);
    assert.equal(await page.evaluate(() => document.activeElement.id), "pin");
    assertNoFaults(opened);
    await context.close();
  });
}
