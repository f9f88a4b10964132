// Other lights painted over the map: the sky that they make, undo and redo, names, links.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, numbersShown, openPage, PHONE, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, here, inLink } from "./support/stage.mjs";

const LAMPS = "&lamp=mixed&emission=modern_city";
/** The place beside the largest town, with the map's middle on the town. */
const fragment = (more = "") => {
  const { beside, town, scene } = here;
  return `#scene=${scene.id}&lat=${beside.latitude_deg}&lon=${beside.longitude_deg}&map=8/${town.latitude_deg}/${town.longitude_deg}${more}`;
};
const scenarioOf = (page) => inLink(page, "scenario");
const skyWith = async (scenario) =>
  (await getJson(skyPath(here.scene, "sky", here.beside, LAMPS + (scenario === null ? "" : `&scenario=${scenario}`)))).sky;
/** Until the link names other lights than these. */
const changedFrom = (page, scenario) =>
  page.waitForFunction((before) => new URLSearchParams(location.hash.slice(1)).get("scenario") !== before, scenario);

/** Drags over the map along points, parts of its size from its middle. */
async function stroke(page, points) {
  const box = await page.locator("#map").boundingBox();
  const at = ([x, y]) => [box.x + box.width * (0.5 + x), box.y + box.height * (0.5 + y)];
  await page.mouse.move(...at(points[0]));
  await page.mouse.down();
  for (const point of points.slice(1)) await page.mouse.move(...at(point), { steps: 8 });
  await page.mouse.up();
}

/** A town painted dark darkens the sky beside it; undo, redo, reload and a name keep what was painted. */
test("a town painted dark darkens the sky beside it", async () => {
  const opened = await openPage(browser, fragment());
  const { page, context } = opened;
  await skyShown(page);
  const today = await skyWith(null);
  await page.click("#paint-draw");
  assert.match((await page.locator("#paint-hint").textContent()) ?? "", /Drag over the map/);
  await stroke(page, [
    [-0.06, 0],
    [0.06, 0],
    [0.06, 0.08],
  ]);
  await changedFrom(page, null);
  const first = scenarioOf(page);
  const dark = await skyWith(first);
  assert.ok(
    dark.zenith_luminance_cd_m2 < 0.95 * today.zenith_luminance_cd_m2,
    `${dark.zenith_luminance_cd_m2} of ${today.zenith_luminance_cd_m2}`,
  );
  await numbersShown(page, dark);
  assert.equal(await page.locator("#lights-changed").textContent(), "With changes");
  assert.match((await page.locator("#paint-answer").textContent()) ?? "", /pixels changed.*Upward light.*−\d/);
  const link = new URLSearchParams(new URL(page.url()).hash.slice(1));
  assert.deepEqual(
    [link.get("lat"), link.get("lon")].map(Number),
    [here.beside.latitude_deg, here.beside.longitude_deg],
    "painting moved the picked place",
  );
  const [edit] = (await getJson(`scenarios/${first}`)).edits;
  assert.deepEqual([edit.factor, edit.radius_m], [0, 8000]);

  // More of it, with other lamps inside an area.
  await page.selectOption("#paint-kind", "lamp");
  await page.selectOption("#paint-lamp-from", "hps");
  await page.click("#paint-shape button[value=area]");
  await stroke(page, [
    [-0.12, -0.2],
    [0.2, -0.2],
    [0.2, 0.2],
    [-0.12, 0.2],
  ]);
  await changedFrom(page, first);
  const second = scenarioOf(page);
  const { edits } = await getJson(`scenarios/${second}`);
  assert.deepEqual([edits.length, edits[1].lamp, edits[1].lamp_from, edits[1].area.type], [2, "pc_amber", "hps", "MultiPolygon"]);
  await skyShown(page);
  await shot(page, "paint");

  await page.click("#paint-undo");
  await changedFrom(page, second);
  assert.equal(scenarioOf(page), first);
  await page.click("#paint-undo");
  await changedFrom(page, first);
  assert.equal(scenarioOf(page), null);
  await numbersShown(page, today);
  await page.click("#paint-redo");
  await changedFrom(page, null);
  assert.equal(scenarioOf(page), first);
  await numbersShown(page, dark);

  await page.fill("#paint-title", "Without the town");
  await page.press("#paint-title", "Tab");
  await changedFrom(page, first);
  const named = scenarioOf(page);
  assert.equal((await getJson(`scenarios/${named}`)).title, "Without the town");

  // Painting ends; then a click picks a place again, and a link brings all of it back.
  await page.click("#paint-draw");
  await page.reload();
  await skyShown(page);
  await page.waitForSelector("#paint-undo:not([disabled])");
  assert.equal(await page.locator("#paint-title").inputValue(), "Without the town");
  await numbersShown(page, dark);
  await page.click("#paint-clear");
  await numbersShown(page, today);
  assert.equal(scenarioOf(page), null);
  assertNoFaults(opened);
  await context.close();
});

/** A plan goes on from what was painted, and paint goes over a plan. */
test("plans and paint build on each other", async () => {
  const opened = await openPage(browser, fragment());
  const { page, context } = opened;
  await skyShown(page);
  await page.click("#paint-draw");
  // By keyboard: a dab in the middle of the map.
  await page.focus("#map canvas");
  await page.keyboard.press("Enter");
  await changedFrom(page, null);
  const painted = scenarioOf(page);
  const dark = await skyWith(painted);
  await page.click("#plan-find");
  await page.waitForSelector("#plan-status .plan-reached");
  const plan = scenarioOf(page);
  const [site] = (await getJson(`plans/${plan}`)).sites;
  assert.ok(
    Math.abs(site.sky_before.zenith_luminance_cd_m2 / dark.zenith_luminance_cd_m2 - 1) < 1e-6,
    "the plan began from other lights",
  );
  await page.selectOption("#paint-kind", "add");
  await page.focus("#map canvas");
  await page.keyboard.press("Enter");
  await changedFrom(page, plan);
  const both = await getJson(`scenarios/${scenarioOf(page)}`);
  assert.deepEqual([both.base, both.edits.length, both.edits[0].add_radiance_nw_cm2_sr], [plan, 1, 20]);
  assertNoFaults(opened);
  await context.close();
});

test("a finger paints on a phone", async () => {
  const opened = await openPage(browser, fragment(), PHONE);
  const { page, context } = opened;
  await skyShown(page);
  await page.locator("#paint-draw").scrollIntoViewIfNeeded();
  await page.tap("#paint-draw");
  const client = await context.newCDPSession(page);
  const box = await page.locator("#map").boundingBox();
  assert.ok(box.y < PHONE.viewport.height, "the map is not in view to be painted on");
  // What ends it lies in view, below nothing.
  const end = await page.locator("#paint-stop").boundingBox();
  const hit = await page.evaluate(([x, y]) => document.elementFromPoint(x, y)?.id, [end.x + end.width / 2, end.y + 6]);
  assert.equal(hit, "paint-stop");
  const point = (i) => ({ x: box.x + box.width * (0.4 + 0.02 * i), y: Math.max(box.y, 0) + 150 });
  await client.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [point(0)] });
  for (let i = 1; i < 10; i++) await client.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: [point(i)] });
  await client.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  await changedFrom(page, null);
  await skyShown(page);
  await shot(page, "paint-phone");
  await page.keyboard.press("Escape");
  await page.waitForSelector("#paint-stop", { state: "hidden" });
  assertNoFaults(opened);
  await context.close();
});

/** Strokes and steps back that overtake a slow answer all count, and a search waits for the last of them. */
test("strokes that overtake a slow answer all count", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  let asked = 0;
  await page.route("**/scenarios", async (route) => {
    // These answers come long after the next question.
    const late = asked++ < 3;
    if (late) await new Promise((resolve) => setTimeout(resolve, 1200));
    // Who asked may not wait any more.
    await route.continue().catch(() => {});
  });
  await page.click("#paint-draw");
  await stroke(page, [
    [-0.1, 0],
    [0, 0],
  ]);
  await stroke(page, [
    [0.1, 0],
    [0.2, 0],
  ]);
  await stroke(page, [
    [0.1, 0.1],
    [0.2, 0.1],
  ]);
  await page.click("#paint-undo");
  await page.waitForFunction(() => location.hash.includes("scenario=s-"));
  await skyShown(page);
  // A first answer may be there before the last stroke, where drawing takes longer than it is held back.
  const edits = async () => (await getJson(`scenarios/${scenarioOf(page)}`)).edits.length;
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
  const plan = await getJson(`plans/${scenarioOf(page)}?limit=0`);
  assert.equal((await getJson(`scenarios/${plan.sites[0].scenario}`)).edits.length, 3);
  assertNoFaults(opened);
  await context.close();
});
