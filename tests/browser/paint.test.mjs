// Other lights painted over the map: the sky that they make, undo and redo, names, links.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assert_no_faults, get_json, numbers_shown, open_page, PHONE, shot, sky_shown } from "./support/browser.mjs";
import { sky_path } from "./support/sky.mjs";
import { browser, here, in_link } from "./support/stage.mjs";

const LAMPS = "&lamp=mixed&emission=garstang";
/** The place beside the largest town, with the map's middle on the town. */
const fragment = (more = "") => {
  const { beside, town, scene } = here;
  return `#scene=${scene.id}&lat=${beside.latitude_deg}&lon=${beside.longitude_deg}&map=8/${town.latitude_deg}/${town.longitude_deg}${more}`;
};
const scenario_of = (page) => in_link(page, "scenario");
const sky_with = async (scenario) => (await get_json(sky_path(here.scene, "sky", here.beside, LAMPS + (scenario === null ? "" : `&scenario=${scenario}`)))).sky;
/** Until the link names other lights than these. */
const changed_from = (page, scenario) => page.waitForFunction((before) => new URLSearchParams(location.hash.slice(1)).get("scenario") !== before, scenario);

/** Drags over the map along points, parts of its size from its middle. */
async function stroke(page, points) {
  const box = await page.locator("#map").boundingBox();
  const at = ([x, y]) => [box.x + box.width * (0.5 + x), box.y + box.height * (0.5 + y)];
  await page.mouse.move(...at(points[0]));
  await page.mouse.down();
  for (const point of points.slice(1)) await page.mouse.move(...at(point), { steps: 8 });
  await page.mouse.up();
}

test("a town painted dark darkens the sky beside it; undo, redo, reload and a name keep what was painted", async () => {
  const opened = await open_page(browser, fragment());
  const { page, context } = opened;
  await sky_shown(page);
  const today = await sky_with(null);
  await page.click("#paint-draw");
  assert.match((await page.locator("#paint-hint").textContent()) ?? "", /Drag over the map/);
  await stroke(page, [[-0.06, 0], [0.06, 0], [0.06, 0.08]]);
  await changed_from(page, null);
  const first = scenario_of(page);
  const dark = await sky_with(first);
  assert.ok(dark.zenith_luminance_cd_m2 < 0.95 * today.zenith_luminance_cd_m2, `${dark.zenith_luminance_cd_m2} of ${today.zenith_luminance_cd_m2}`);
  await numbers_shown(page, dark);
  assert.equal(await page.locator("#lights-changed").textContent(), "As painted");
  assert.match((await page.locator("#paint-answer").textContent()) ?? "", /pixels changed.*Upward light.*-\d/);
  const link = new URLSearchParams(new URL(page.url()).hash.slice(1));
  assert.deepEqual([link.get("lat"), link.get("lon")].map(Number), [here.beside.latitude_deg, here.beside.longitude_deg], "painting moved the picked place");
  const [edit] = (await get_json(`scenarios/${first}`)).edits;
  assert.deepEqual([edit.factor, edit.radius_m], [0, 8000]);

  // More of it, with other lamps inside an area.
  await page.selectOption("#paint-kind", "lamp");
  await page.selectOption("#paint-lamp-from", "hps");
  await page.click("#paint-shape button[value=area]");
  await stroke(page, [[-0.12, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.12, 0.2]]);
  await changed_from(page, first);
  const second = scenario_of(page);
  const { edits } = await get_json(`scenarios/${second}`);
  assert.deepEqual([edits.length, edits[1].lamp, edits[1].lamp_from, edits[1].area.type], [2, "pc_amber", "hps", "MultiPolygon"]);
  await sky_shown(page);
  await shot(page, "paint");

  await page.click("#paint-undo");
  await changed_from(page, second);
  assert.equal(scenario_of(page), first);
  await page.click("#paint-undo");
  await changed_from(page, first);
  assert.equal(scenario_of(page), null);
  await numbers_shown(page, today);
  await page.click("#paint-redo");
  await changed_from(page, null);
  assert.equal(scenario_of(page), first);
  await numbers_shown(page, dark);

  await page.fill("#paint-title", "Without the town");
  await page.press("#paint-title", "Tab");
  await changed_from(page, first);
  const named = scenario_of(page);
  assert.equal((await get_json(`scenarios/${named}`)).title, "Without the town");

  // Painting ends; then a click picks a place again, and a link brings all of it back.
  await page.click("#paint-draw");
  await page.reload();
  await sky_shown(page);
  await page.waitForSelector("#paint-undo:not([disabled])");
  assert.equal(await page.locator("#paint-title").inputValue(), "Without the town");
  await numbers_shown(page, dark);
  await page.click("#paint-clear");
  await numbers_shown(page, today);
  assert.equal(scenario_of(page), null);
  assert_no_faults(opened);
  await context.close();
});

test("a plan goes on from what was painted, and paint goes over a plan", async () => {
  const opened = await open_page(browser, fragment());
  const { page, context } = opened;
  await sky_shown(page);
  await page.click("#paint-draw");
  // By keyboard: a dab in the middle of the map.
  await page.focus("#map canvas");
  await page.keyboard.press("Enter");
  await changed_from(page, null);
  const painted = scenario_of(page);
  const dark = await sky_with(painted);
  await page.click("#plan-find");
  await page.waitForSelector("#plan-status .plan-reached");
  const plan = scenario_of(page);
  const [site] = (await get_json(`plans/${plan}`)).sites;
  assert.ok(Math.abs(site.sky_before.zenith_luminance_cd_m2 / dark.zenith_luminance_cd_m2 - 1) < 1e-6, "the plan began from other lights");
  await page.selectOption("#paint-kind", "add");
  await page.focus("#map canvas");
  await page.keyboard.press("Enter");
  await changed_from(page, plan);
  const both = await get_json(`scenarios/${scenario_of(page)}`);
  assert.deepEqual([both.base, both.edits.length, both.edits[0].add_radiance_nw_cm2_sr], [plan, 1, 20]);
  assert_no_faults(opened);
  await context.close();
});

test("a finger paints on a phone", async () => {
  const opened = await open_page(browser, fragment(), PHONE);
  const { page, context } = opened;
  await sky_shown(page);
  await page.locator("#paint-draw").scrollIntoViewIfNeeded();
  await page.tap("#paint-draw");
  const client = await context.newCDPSession(page);
  const box = await page.locator("#map").boundingBox();
  assert.ok(box.y < PHONE.viewport.height, "the map is not in view to be painted on");
  const point = (i) => ({ x: box.x + box.width * (0.4 + 0.02 * i), y: Math.max(box.y, 0) + 150 });
  await client.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [point(0)] });
  for (let i = 1; i < 10; i++) await client.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: [point(i)] });
  await client.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  await changed_from(page, null);
  await sky_shown(page);
  await shot(page, "paint-phone");
  assert_no_faults(opened);
  await context.close();
});

test("strokes and steps back that overtake a slow answer all count, and a search waits for the last of them", async () => {
  const opened = await open_page(browser, fragment(here.beside));
  const { page, context } = opened;
  await sky_shown(page);
  let asked = 0;
  await page.route("**/scenarios", async (route) => {
    // These answers come long after the next question.
    const late = asked++ < 3;
    if (late) await new Promise((resolve) => setTimeout(resolve, 1200));
    // Who asked may not wait any more.
    await route.continue().catch(() => {});
  });
  await page.click("#paint-draw");
  await stroke(page, [[-0.1, 0], [0, 0]]);
  await stroke(page, [[0.1, 0], [0.2, 0]]);
  await stroke(page, [[0.1, 0.1], [0.2, 0.1]]);
  await page.click("#paint-undo");
  await page.waitForFunction(() => location.hash.includes("scenario=s-"));
  await sky_shown(page);
  // A first answer may be there before the last stroke, where drawing takes longer than it is held back.
  const edits = async () => (await get_json(`scenarios/${scenario_of(page)}`)).edits.length;
  for (let tries = 0; tries < 50 && (await edits()) !== 2; tries++) await new Promise((resolve) => setTimeout(resolve, 200));
  assert.equal(await edits(), 2);
  assert.ok(await page.locator("#paint-redo").isEnabled());
  // A plan that is looked for at once goes on from the stroke before it.
  await page.route("**/scenarios", async (route) => {
    await new Promise((resolve) => setTimeout(resolve, 800));
    await route.continue().catch(() => {});
  });
  await page.click("#paint-redo");
  await page.click("#plan-find");
  await page.waitForSelector("#plan-status .plan-reached");
  const plan = await get_json(`plans/${scenario_of(page)}?limit=0`);
  assert.equal((await get_json(`scenarios/${plan.sites[0].scenario}`)).edits.length, 3);
  assert_no_faults(opened);
  await context.close();
});
