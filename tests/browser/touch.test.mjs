// Every tool by finger on a phone: a place, layers, looking around, a plan, the slider between skies and maps, sharing.
// (Painting and marking a part of the sky by finger have their tests beside those by mouse.)
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, numbersShown, openPage, PHONE, SERVER, shot, skyShown } from "./support/browser.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const inAddress = (page, name) => page.evaluate((name) => new URLSearchParams(location.hash.slice(1)).get(name), name);

/** Fingers that go from points to points, and are lifted there. */
async function fingers(context, page, paths) {
  const client = await context.newCDPSession(page);
  const at = (i) => paths.map((path, id) => ({ ...path[i], id }));
  await client.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
  for (let i = 1; i < paths[0].length; i++)
    await client.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(i) });
  await client.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
}

/** A straight way in steps. */
const way = (from, to, steps = 8) =>
  Array.from({ length: steps + 1 }, (_, i) => ({
    x: from.x + ((to.x - from.x) * i) / steps,
    y: from.y + ((to.y - from.y) * i) / steps,
  }));

/** Fingers pick a place, switch layers, look around and zoom, and share the view. */
test("fingers pick, switch layers, zoom and share", async () => {
  const { beside } = here;
  const opened = await openPage(browser, `#scene=${here.scene.id}&map=8/${beside.latitude_deg}/${beside.longitude_deg}`, PHONE);
  const { page, context } = opened;
  await page.locator("#map").tap();
  await skyShown(page);
  const place = { latitude_deg: Number(await inAddress(page, "lat")), longitude_deg: Number(await inAddress(page, "lon")) };
  assert.ok(Math.abs(place.latitude_deg - beside.latitude_deg) < 0.02, `${place.latitude_deg}`);
  await page.locator("#layers summary").tap();
  await page.locator("label:has(#layer-influence)").tap();
  await page.waitForSelector("#layer-note-influence[data-state=shown]");
  // One colour scale at a time.
  assert.equal(await inAddress(page, "radiance"), "0");
  await page.locator("#layers summary").tap();
  await shot(page, "touch-layers");

  await page.getByRole("radio", { name: "Look around" }).tap();
  await page.locator(".sky-overlay").scrollIntoViewIfNeeded();
  const box = await page.locator(".sky-overlay").boundingBox();
  const middle = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  await fingers(context, page, [way(middle, { x: middle.x - 100, y: middle.y })]);
  await page.waitForFunction(() => location.hash.includes("look="));
  const [azimuthDeg, , fieldDeg] = (await inAddress(page, "look")).split("/").map(Number);
  await fingers(context, page, [way(middle, { x: middle.x - 100, y: middle.y })]);
  await page.waitForFunction((before) => !location.hash.includes(`look=${before}`), `${azimuthDeg}/`);
  const [turnedDeg] = (await inAddress(page, "look")).split("/").map(Number);
  assert.ok(
    (turnedDeg - azimuthDeg + 360) % 360 > 5 && (turnedDeg - azimuthDeg + 360) % 360 < 120,
    `${azimuthDeg} to ${turnedDeg}`,
  );
  const [left, right] = [
    { x: middle.x - 40, y: middle.y },
    { x: middle.x + 40, y: middle.y },
  ];
  await fingers(context, page, [way(left, { x: left.x - 60, y: left.y }), way(right, { x: right.x + 60, y: right.y })]);
  const [, , closerDeg] = (await inAddress(page, "look")).split("/").map(Number);
  assert.ok(closerDeg < 0.7 * fieldDeg, `${fieldDeg} to ${closerDeg}`);
  await shot(page, "touch-look");

  await page.evaluate(() => {
    navigator.share = async (what) => {
      window.shared = what;
    };
  });
  await page.locator("#share").tap();
  const view = await page.evaluate(() => location.hash.slice(1));
  assert.ok((await page.evaluate(() => window.shared.url)).startsWith(`${SERVER}/at?${view}`));
  assertNoFaults(opened);
  await context.close();
});

/** Fingers find a plan, and draw the line between its sky and map and those of today. */
test("fingers find a plan and move the split", async () => {
  const opened = await openPage(browser, fragment(here.beside), PHONE);
  const { page, context } = opened;
  await skyShown(page);
  await page.locator("#plan-find").tap();
  await page.waitForSelector("#plan-status .plan-reached");
  const plan = await getJson(`plans/${inLink(page, "scenario")}?limit=0`);
  await numbersShown(page, plan.sites[0].sky_after);
  await page.getByRole("radio", { name: "Both" }).tap();
  await skyShown(page);
  const split = page.locator("#split");
  await split.scrollIntoViewIfNeeded();
  const track = await split.boundingBox();
  await page.touchscreen.tap(track.x + 0.75 * track.width, track.y + track.height / 2);
  assert.ok(Math.abs(Number(await split.inputValue()) - 75) < 6, await split.inputValue());
  const line = page.locator(".swipe-line");
  const drawnAt = await line.evaluate(({ style }) => Number.parseFloat(style.left));
  assert.ok(Math.abs(drawnAt - Number(await split.inputValue())) < 0.6, `${drawnAt}`);
  await page.locator("#map").scrollIntoViewIfNeeded();
  const handle = await page.locator(".swipe-handle").boundingBox();
  const map = await page.locator("#map").boundingBox();
  const from = { x: handle.x + handle.width / 2, y: handle.y + handle.height / 2 };
  await fingers(context, page, [way(from, { x: map.x + 0.25 * map.width, y: from.y })]);
  assert.ok(Math.abs(Number(await split.inputValue()) - 25) < 3, await split.inputValue());
  await shot(page, "touch-swipe");
  assertNoFaults(opened);
  await context.close();
});
