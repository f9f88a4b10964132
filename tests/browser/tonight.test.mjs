// Until someone chooses a time, a place is shown as of tonight: with stars, and the sentence counts them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, DESKTOP, openPage, PHONE, SERVER, shot, skyShown } from "./support/browser.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

const timeIn = (page) => new URLSearchParams(new URL(page.url()).hash.slice(1)).get("time");

async function search(page, name) {
  await page.fill("#search", name);
  await page.waitForSelector("#search-list li");
  await page.press("#search", "Enter");
  await skyShown(page);
}

/** On a phone the sentence with tonight's stars, and all of the picture, are on the first screen. */
test("a first place is shown as of tonight", async () => {
  const opened = await openPage(browser, "", { ...PHONE, isTonight: true });
  const { page, context } = opened;
  await search(page, here.town.name);
  await page.waitForSelector("#time-line:not([hidden])");
  const time = timeIn(page);
  const hours = (Date.parse(time) - Date.now()) / 3_600_000;
  assert.ok(hours > -13 && hours < 25, `${time}`);
  // A night of half a Moon, of twilight, or of a dark sky: each has its words.
  assert.match(await page.locator("#summary").textContent(), /stars tonight|Twilight/);
  await shot(page, "tonight-phone");
  await page.waitForFunction(() => /%|many towns/.test(document.querySelector("#summary").textContent));
  const bottom = await page.evaluate(() => document.querySelector(".sky-view").getBoundingClientRect().bottom);
  assert.ok(bottom <= PHONE.viewport.height, `the picture ends at ${bottom} px`);
  assertNoFaults(opened);
  await context.close();
});

/** Who wants no time keeps it, for the next place and the next visit; a link without a time has none. */
test("no time is a choice that stays", async () => {
  const opened = await openPage(browser, "", { ...DESKTOP, isTonight: true });
  const { page, context } = opened;
  await search(page, here.town.name);
  assert.notEqual(timeIn(page), null);
  await page.click("#time-none");
  await page.waitForFunction(() => !location.hash.includes("time="));
  await skyShown(page);
  await search(page, `${here.beside.latitude_deg}, ${here.beside.longitude_deg}`);
  assert.equal(timeIn(page), null);
  await page.goto("about:blank");
  await page.goto(`${SERVER}/`);
  await page.waitForSelector("#map[data-basemap]");
  await search(page, here.town.name);
  assert.equal(timeIn(page), null);
  assertNoFaults(opened);
  await context.close();
  const linked = await openPage(browser, fragment(here.beside), { ...DESKTOP, isTonight: true });
  await skyShown(linked.page);
  assert.equal(timeIn(linked.page), null);
  await search(linked.page, here.town.name);
  assert.equal(timeIn(linked.page), null);
  assertNoFaults(linked);
  await linked.context.close();
  // The same when the link is pasted into an open page.
  const empty = await openPage(browser, "", { ...DESKTOP, isTonight: true });
  await empty.page.waitForSelector("#map[data-basemap]");
  await empty.page.evaluate((hash) => {
    location.hash = hash;
  }, fragment(here.beside));
  await skyShown(empty.page);
  assert.equal(timeIn(empty.page), null);
  assertNoFaults(empty);
  await empty.context.close();
});
