// The tools that are no map and no sky, by keyboard alone: layers, plans, the line between skies and maps, how a sky is shown.
// (Picking places, marking the sky, painting and looking around by keyboard have their tests beside those by mouse.)
import assert from "node:assert/strict";
import { test } from "node:test";
import { assert_no_faults, get_json, open_page, shot, sky_shown } from "./support/browser.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

const in_address = (page, name) => page.evaluate((name) => new URLSearchParams(location.hash.slice(1)).get(name), name);
const until_address = (page, pattern) => page.waitForFunction((pattern) => new RegExp(pattern).test(location.hash), pattern);

/** Tab from here until an element has the focus: whatever cannot be reached so is out of reach. */
async function tab_to(page, selector) {
  for (let i = 0; i < 120; i++) {
    if (await page.evaluate((selector) => document.activeElement?.matches(selector) === true, selector)) return;
    await page.keyboard.press("Tab");
  }
  assert.fail(`${selector} is not reached by Tab`);
}

async function press(page, key, times = 1) {
  for (let i = 0; i < times; i++) await page.keyboard.press(key);
}

test("layers, plans of both kinds, both lines and the look of the sky are reached and moved by keys", async () => {
  const opened = await open_page(browser, fragment(here.beside));
  const { page, context } = opened;
  await sky_shown(page);
  await page.focus("#search");
  await tab_to(page, "#layer-influence");
  await press(page, "Space");
  await page.waitForSelector("#layer-note-influence[data-state=shown]");
  await tab_to(page, "#opacity-influence");
  await press(page, "ArrowLeft", 4);
  assert.equal(await in_address(page, "influence"), "0.7");
  await tab_to(page, "#measure");
  await press(page, "ArrowDown");
  await until_address(page, "measure=mean");

  // The look of the sky.
  await tab_to(page, "#projection [role=radio]");
  await press(page, "ArrowRight");
  await until_address(page, "projection=fisheye");
  await tab_to(page, "#colours");
  await press(page, "End");
  await until_address(page, "colours=realistic");
  await tab_to(page, "#exposure");
  await press(page, "ArrowRight", 2);
  assert.equal(await in_address(page, "exposure"), "1");
  await tab_to(page, "#unit");
  await press(page, "End");
  await until_address(page, "unit=ratio");

  // A plan for a goal.
  await tab_to(page, "#plan-reduction");
  await press(page, "ArrowRight");
  await tab_to(page, "#plan-find");
  await press(page, "Enter");
  await page.waitForSelector("#plan-status .plan-reached");
  const goal = await in_address(page, "scenario");
  assert.ok(Math.abs((await get_json(`plans/${goal}?limit=0`)).sites[0].reduced_by - 0.35) < 1e-3);
  await sky_shown(page);

  // Today beside it, as far as the slider says.
  await page.focus("#search");
  await tab_to(page, "#lights [role=radio]");
  await press(page, "ArrowLeft");
  await until_address(page, "lights=both");
  await tab_to(page, "#split");
  await press(page, "ArrowLeft", 10);
  await until_address(page, "split=0.4");
  assert.equal(await page.$eval(".swipe-line", ({ style }) => Number.parseFloat(style.left)), 40);
  await shot(page, "keyboard");

  // One by influence.
  await tab_to(page, "#plan-method [role=radio]");
  await press(page, "ArrowRight");
  await tab_to(page, "#plan-gamma");
  await press(page, "ArrowLeft");
  await page.waitForFunction((goal) => /scenario=p-/.test(location.hash) && !location.hash.includes(goal), goal);
  await sky_shown(page);
  assert.equal((await get_json(`plans/${await in_address(page, "scenario")}?limit=0`)).gamma, 0.75);
  await tab_to(page, "#plan-drop");
  await press(page, "Enter");
  await page.waitForFunction(() => !location.hash.includes("scenario="));
  assert_no_faults(opened);
  await context.close();
});
