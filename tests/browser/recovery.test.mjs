// A server that goes away and comes back.
import assert from "node:assert/strict";
import { test } from "node:test";
import { getJson, openPage, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

/** What is shown stays, one message says it in plain words, and everything comes by itself once the server is back. */
test("a server that comes back is asked again", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context, faults } = opened;
  await skyShown(page);
  const before = await page.locator("[data-value=zenith_mag]").textContent();
  await context.route("**/api/v1/**", (route) => route.abort("connectionrefused"));
  await page.selectOption("#lamp", "led_4000k");
  await page.click("#layer-elevation");
  const notice = page.getByRole("alert");
  await notice.getByText("The server does not answer").waitFor();
  await page.mouse.move(300, 300);
  await page.mouse.wheel(0, -600);
  await page.waitForTimeout(1500);
  assert.match(await notice.textContent(), /The server does not answer/);
  assert.doesNotMatch(await page.locator("body").textContent(), /AJAXError|Failed to fetch/);
  assert.equal(await page.locator("[data-value=zenith_mag]").textContent(), before);
  // Another place cannot be shown now, and so the last one stays.
  const link = page.url();
  await page.fill("#search", `${here.town.latitude_deg}, ${here.town.longitude_deg}`);
  await page.press("#search", "Enter");
  await page.waitForTimeout(200);
  assert.equal(page.url(), link);
  assert.equal(await page.locator("[data-value=zenith_mag]").textContent(), before);
  assert.equal(await page.getAttribute("body", "data-sky"), "picture");
  await shot(page, "away");
  await context.unroute("**/api/v1/**");
  const { sky } = await getJson(skyPath(here.scene, "sky", here.beside, "&lamp=led_4000k"));
  const led = sky.zenith_brightness_mag_arcsec2.toFixed(2);
  await page.waitForFunction((value) => document.querySelector("[data-value=zenith_mag]")?.textContent === value, led);
  await notice.waitFor({ state: "hidden" });
  await page.waitForSelector("#layer-note-elevation[data-state=shown]");
  // Chromium itself notes requests without an answer; nothing else may be amiss.
  assert.deepEqual(
    faults.filter((fault) => !/ERR_CONNECTION_REFUSED/.test(fault)),
    [],
  );
  await context.close();
});

/** A page that was opened while the server was away shows its scene once it is back. */
test("a page opened too early comes by itself", async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  await context.route("**/api/v1/**", (route) => route.abort("connectionrefused"));
  await page.goto(`${process.env.SKYGLOW_URL}/${fragment(here.town)}`);
  await page.getByRole("alert").getByText("The server does not answer").waitFor();
  await context.unroute("**/api/v1/**");
  await skyShown(page);
  await page.getByRole("alert").waitFor({ state: "hidden" });
  await context.close();
});
