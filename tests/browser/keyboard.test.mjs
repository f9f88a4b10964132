// The tools that are no map and no sky, by keyboard alone: layers, plans, the line between skies and maps, how a sky is shown.
// (Picking places, marking the sky, painting and looking around by keyboard have their tests beside those by mouse.)
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, shot, skyShown } from "./support/browser.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

const inAddress = (page, name) => page.evaluate((name) => new URLSearchParams(location.hash.slice(1)).get(name), name);
const untilAddress = (page, pattern) => page.waitForFunction((pattern) => new RegExp(pattern).test(location.hash), pattern);

/** Tab from here until an element has the focus: whatever cannot be reached so is out of reach. */
async function tabTo(page, selector) {
  for (let i = 0; i < 120; i++) {
    if (await page.evaluate((selector) => document.activeElement?.matches(selector) === true, selector)) return;
    await page.keyboard.press("Tab");
  }
  assert.fail(`${selector} is not reached by Tab`);
}

async function press(page, key, times = 1) {
  for (let i = 0; i < times; i++) await page.keyboard.press(key);
}

/** Layers, plans of both kinds, both lines and the look of the sky are reached and moved by keys. */
test("all controls are reached and moved by keys", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await page.focus("#search");
  await tabTo(page, "#layer-influence");
  await press(page, "Space");
  await page.waitForSelector("#layer-note-influence[data-state=shown]");
  await tabTo(page, "#opacity-influence");
  await press(page, "ArrowLeft", 4);
  assert.equal(await inAddress(page, "influence"), "0.7");
  await tabTo(page, "#measure");
  await press(page, "ArrowDown");
  await untilAddress(page, "measure=mean");

  // The look of the sky.
  await tabTo(page, "#projection [role=radio]");
  await press(page, "ArrowRight");
  await untilAddress(page, "projection=fisheye");
  await tabTo(page, "#colours");
  await press(page, "End");
  await untilAddress(page, "colours=realistic");
  await tabTo(page, "#exposure");
  await press(page, "ArrowRight", 2);
  assert.equal(await inAddress(page, "exposure"), "1");
  await tabTo(page, "#unit");
  await press(page, "End");
  await untilAddress(page, "unit=ratio");

  // A plan for a goal.
  await tabTo(page, "#plan-reduction");
  await press(page, "ArrowRight");
  await tabTo(page, "#plan-find");
  await press(page, "Enter");
  await page.waitForSelector("#plan-status .plan-reached");
  const goal = await inAddress(page, "scenario");
  assert.ok(Math.abs((await getJson(`plans/${goal}?limit=0`)).sites[0].reduced_by - 0.35) < 1e-3);
  await skyShown(page);

  // Today beside it, as far as the slider says.
  await page.focus("#search");
  await tabTo(page, "#lights [role=radio]");
  await press(page, "ArrowLeft");
  await untilAddress(page, "lights=both");
  await tabTo(page, "#split");
  await press(page, "ArrowLeft", 10);
  await untilAddress(page, "split=0.4");
  assert.equal(await page.$eval(".swipe-line", ({ style }) => Number.parseFloat(style.left)), 40);
  await shot(page, "keyboard");

  // One by influence.
  await tabTo(page, "#plan-method [role=radio]");
  await press(page, "ArrowRight");
  await tabTo(page, "#plan-gamma");
  await press(page, "ArrowLeft");
  await page.waitForFunction((goal) => /scenario=p-/.test(location.hash) && !location.hash.includes(goal), goal);
  await skyShown(page);
  assert.equal((await getJson(`plans/${await inAddress(page, "scenario")}?limit=0`)).gamma, 0.75);
  await tabTo(page, "#plan-drop");
  await press(page, "Enter");
  await page.waitForFunction(() => !location.hash.includes("scenario="));
  assertNoFaults(opened);
  await context.close();
});
