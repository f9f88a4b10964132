// What stays as it was put: the map, the look of the sky, the focus; and what Back, Escape and the page's title say.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, openPage, PHONE, skyShown } from "./support/browser.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

/** A map that was moved away from the picked place stays there when the window or the page around it changes. */
test("the map stays where it was moved to", async () => {
  const { town } = here;
  const opened = await openPage(browser, fragment(town, `&map=8/${town.latitude_deg}/${town.longitude_deg}`));
  const { page, context } = opened;
  await skyShown(page);
  const box = await page.locator("#map").boundingBox();
  const from = [box.x + box.width * 0.9, box.y + box.height * 0.8];
  await page.mouse.move(...from);
  await page.mouse.down();
  // As slowly as a hand: MapLibre takes a drag within a frame for none.
  for (let step = 1; step <= 10; step++) {
    await page.mouse.move(from[0], from[1] - 30 * step);
    await page.waitForTimeout(60);
  }
  await page.mouse.up();
  const latitude = () => Number(inLink(page, "map").split("/")[1]);
  await page.waitForFunction((from) => Math.abs(/map=[\d.]+\/([-\d.]+)/.exec(location.hash)?.[1] - from) > 0.4, town.latitude_deg);
  const moved = latitude();
  await page.setViewportSize({ width: 1000, height: 640 });
  await page.waitForTimeout(800);
  assert.ok(Math.abs(latitude() - moved) < 0.1, `after a resize: ${latitude()} for ${moved}`);
  await page.reload();
  await skyShown(page);
  await page.waitForTimeout(800);
  assert.ok(Math.abs(latitude() - moved) < 0.1, `after a reload: ${latitude()} for ${moved}`);
  assertNoFaults(opened);
  await context.close();
});

/** Back undoes the last pick; projection, colours and layers chosen after it stay. A fragment typed by hand says everything. */
test("Back undoes a pick and keeps the look", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await page.locator("#search").fill(here.town.name);
  await page.keyboard.press("Enter");
  await page.waitForFunction((lat) => location.hash.includes(`lat=${lat}`), here.town.latitude_deg);
  await skyShown(page);
  await page.getByRole("radio", { name: "Fisheye" }).click();
  await page.selectOption("#colours", "viridis");
  await page.click("#layer-elevation");
  await page.goBack();
  await page.waitForFunction((lat) => location.hash.includes(`lat=${lat}`), here.beside.latitude_deg);
  await skyShown(page);
  assert.equal(inLink(page, "projection"), "fisheye");
  assert.equal(inLink(page, "colours"), "viridis");
  assert.equal(inLink(page, "elevation"), "0.6");
  assert.ok(await page.isChecked("#layer-elevation"));
  await page.evaluate((hash) => (location.hash = hash), fragment(here.town));
  await page.waitForFunction(() => document.body.dataset.projection === "equirectangular");
  assertNoFaults(opened);
  await context.close();
});

test("Escape leaves the enlarged sky", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await page.click("#enlarge");
  assert.ok(await page.locator("body.enlarged").count());
  // The cross in the sky goes first.
  await page.locator(".sky-overlay").focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("body.enlarged").count(), 1);
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("body.enlarged").count(), 0);
  assert.equal(await page.getAttribute("#enlarge", "aria-pressed"), "false");
  assertNoFaults(opened);
  await context.close();
});

/** The title names the place, for tabs, bookmarks and the list of ways back. */
test("the page's title names the place", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  assert.equal(await page.title(), "Skyglow");
  await page.locator("#search").fill(here.town.name);
  await page.keyboard.press("Enter");
  await skyShown(page);
  assert.equal(await page.title(), `${here.town.name} – Skyglow`);
  // Who typed goes on from the search box, not from the top of the page.
  assert.equal(await page.evaluate(() => document.activeElement.id), "search");
  assertNoFaults(opened);
  await context.close();
});

/** Coordinates are read as people paste them, and a long name stays inside the list. */
test("pasted coordinates are found", async () => {
  const opened = await openPage(browser, "", PHONE);
  const { page, context } = opened;
  for (const text of [`46°10'12"N 8°47'24"E`, "46,17 8,79", "geo:46.17,8.79", "https://www.openstreetmap.org/#map=12/46.17/8.79"]) {
    await page.fill("#search", text);
    assert.equal(await page.locator("#search-list li").textContent(), "46.1700° N, 8.7900° Ecoordinates", text);
  }
  await page.route("**/places", (route) =>
    route.fulfill({
      json: [
        {
          name: "Llanfairpwllgwyngyllgogerychwyrndrobwllllantysiliogogogoch",
          latitude_deg: 46,
          longitude_deg: 8,
          population: 3107,
        },
      ],
    }),
  );
  await page.reload();
  await page.waitForSelector("#map[data-basemap]");
  await page.fill("#search", "llan");
  await page.locator("#search-list li small").waitFor();
  const { list, name } = await page.evaluate(() => ({
    list: document.querySelector("#search-list").getBoundingClientRect().right,
    name: document.querySelector("#search-list li small").getBoundingClientRect().right,
  }));
  assert.ok(name <= list, `the name reaches to ${name} px, the list to ${list} px`);
  assertNoFaults(opened);
  await context.close();
});

/** On a phone a button on the map ends painting, so that it can be moved and the page scrolled again. */
test("painting ends by a button on the map", async () => {
  const opened = await openPage(browser, fragment(here.beside), PHONE);
  const { page, context } = opened;
  await skyShown(page);
  await page.locator("#paint-draw").tap();
  const stop = page.locator("#paint-stop");
  await stop.waitFor();
  const [button, map] = [await stop.boundingBox(), await page.locator("#map").boundingBox()];
  assert.ok(button.y > map.y && button.y + button.height < map.y + map.height, "it stands on the map");
  await stop.tap();
  assert.ok(await stop.isHidden());
  assert.equal(await page.locator("#map .painting").count(), 0);
  assertNoFaults(opened);
  await context.close();
});
