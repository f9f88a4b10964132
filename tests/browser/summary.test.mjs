// One sentence first: what the sky is like, before any number.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, PHONE, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

/** On a phone the sentence stands between map and picture, on a laptop above the numbers, and it alone is read aloud. */
test("a sentence stands first", async () => {
  for (const device of [undefined, PHONE]) {
    const opened = await openPage(browser, fragment(here.town, "&time=2026-08-12T23:00Z"), device);
    const { page, context } = opened;
    await skyShown(page);
    const { night_sky } = await getJson(skyPath(here.scene, "sky", here.town, "&time=2026-08-12T23:00:00Z"));
    const sentence = await page.locator("#summary").textContent();
    const seen = sentence
      .match(/You see about ([\d,]+) of ([\d,]+) stars\./)
      .slice(1)
      .map((count) => Number(count.replace(",", "")));
    assert.ok(Math.abs(seen[0] / night_sky.stars.visible - 1) < 0.051, `${seen[0]} for ${night_sky.stars.visible}`);
    assert.ok(Math.abs(seen[1] / night_sky.stars.above_horizon - 1) < 0.051);
    assert.match(sentence, /^(City|Inner-city|Bright suburban|Sky between suburban and urban)/);
    const top = async (selector) => (await page.locator(selector).boundingBox()).y;
    assert.ok((await top("#summary")) < (await top("#numbers-card")));
    if (device === PHONE)
      assert.ok((await top("#map")) < (await top("#summary")) && (await top("#summary")) < (await top(".sky-view")));
    assert.equal(await page.locator("#numbers-card[aria-live]").count(), 0);
    await shot(page, device === PHONE ? "summary-phone" : "summary");
    assertNoFaults(opened);
    await context.close();
  }
});

/** Where little of the surroundings is known the sentence says so, and no class is told as sure. */
test("little coverage is said in the sentence", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  await page.route("**/api/v1/scenes/*/sky?*", async (route) => {
    const response = await route.fetch();
    const answer = await response.json();
    const sky = { ...answer.sky, bortle_class: 1, ratio_to_natural: 0.0004 };
    await route.fulfill({ response, json: { ...answer, coverage: 0.27, sky } });
  });
  await page.evaluate((hash) => (location.hash = hash), fragment(here.town));
  await skyShown(page);
  const [sentence, bortle, zenith] = await page.locator("#summary strong, .bortle-name, .zenith").allTextContents();
  assert.equal(sentence, "Very dark sky, or brighter: the lights of only 27 % of the surroundings are known.");
  assert.match(`${bortle} ${zenith}`, /or brighter/);
  assert.match(`${bortle} ${zenith}`, /artificial less than 0.1 % of it/);
  assertNoFaults(opened);
  await context.close();
});
