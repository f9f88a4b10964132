// Clouds with gaps: numbers are of the mean of all skies, the picture shows one of them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, setSlider, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const number = (page, name) => page.locator(`[data-value=${name}]`).first().textContent();

/** A layer of cloud is chosen, its cover slid down, and a link restores both. */
test("clouds have a cover that a link keeps", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context, asked } = opened;
  await skyShown(page);
  assert.ok(await page.locator("#cloud-cover-field").isHidden());
  await page.locator("#clouds").selectOption("1500");
  await page.waitForFunction(() => /closed, from 1500 m/.test(document.querySelector("[data-value=clouds]")?.textContent));
  await skyShown(page);
  assert.ok(await page.locator("#cloud-cover-note").isHidden());
  // They are asked for once the sky is shown.
  const shares = page.waitForRequest(/\/shares\?.*cloud_cover=0\.4(&|$)/);
  await setSlider(page, "cloud-cover", 40);
  await page.waitForFunction(() => /over 40 % of the sky/.test(document.querySelector("[data-value=clouds]")?.textContent));
  await skyShown(page);
  assert.ok(await page.locator("#cloud-cover-note").isVisible());
  assert.deepEqual([inLink(page, "clouds"), inLink(page, "cover")], ["1500", "40"]);
  const ofKind = (kind) => asked.filter((path) => path.includes(`/${kind}?`)).at(-1);
  assert.match(ofKind("sky"), /cloud_cover=0.4(&|$)/);
  assert.doesNotMatch(ofKind("sky"), /cloud_pattern/);
  assert.match(ofKind("panorama.sky"), /cloud_cover=0.4&cloud_pattern=3/);
  await shares;
  const { sky } = await getJson(skyPath(here.scene, "sky", here.beside, "&clouds=1500&cloud_cover=0.4"));
  const zenith = sky.zenith_total_brightness_mag_arcsec2.toFixed(2);
  assert.match(await number(page, "zenith_total_mag"), new RegExp(zenith.replace(".", "[.]")));
  await shot(page, "clouds");
  await page.reload();
  await skyShown(page);
  assert.equal(await page.locator("#cloud-cover").inputValue(), "40");
  assertNoFaults(opened);
  await context.close();
});
