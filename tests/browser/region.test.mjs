// A curve around a part of the sky: the lights that cause it glow on the map, and a plan can be about it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, PHONE, shot, skyShown } from "./support/browser.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const regionOf = (page) => inLink(page, "region");
const cornersOf = (page) =>
  regionOf(page)
    .split(";")
    .map((corner) => corner.split(",").map(Number));

/** Draws an ellipse with the mouse, its middle and size as parts of the picture. */
async function circle(page, [x, y], [width, height]) {
  const box = await page.locator(".sky-overlay").boundingBox();
  const point = (i) => [
    box.x + box.width * (x + width * Math.cos((i * Math.PI) / 18)),
    box.y + box.height * (y + height * Math.sin((i * Math.PI) / 18)),
  ];
  await page.mouse.move(...point(0));
  await page.mouse.down();
  for (let i = 1; i < 36; i++) await page.mouse.move(...point(i));
  await page.mouse.up();
}

/** A curve drawn around the sky's south shows the lights that cause it, and a plan can be about it. */
test("a drawn region shows the lights that cause it", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context, asked } = opened;
  await skyShown(page);
  await page.click("#mark");
  assert.match((await page.locator("#mark-hint").textContent()) ?? "", /Draw around/);
  // A click is no curve: drawing goes on.
  const box = await page.locator(".sky-overlay").boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  assert.equal(await page.locator("#mark").getAttribute("aria-pressed"), "true");
  await circle(page, [0.5, 0.7], [0.06, 0.15]);
  await page.waitForSelector("#layer-note-influence[data-state=shown]");
  assert.equal(await page.locator("#mark").textContent(), "Unmark");
  assert.equal(await page.locator("#mark-hint").textContent(), "");
  const corners = cornersOf(page);
  assert.ok(corners.length >= 12 && corners.length <= 80, `${corners.length}`);
  for (const [azimuthDeg] of corners) assert.ok(azimuthDeg > 140 && azimuthDeg < 215, `${azimuthDeg}`);
  assert.equal(await page.locator("#measure").inputValue(), "region");
  await page.waitForTimeout(1200);
  const tile = asked.find((path) => /tiles\/influence\/\d+\//.test(path));
  const query = new URLSearchParams(tile?.split("?")[1] ?? "");
  assert.deepEqual([query.get("measure"), query.get("region")], ["region", regionOf(page)], `${tile}`);
  await shot(page, "region");

  await page.selectOption("#plan-measure", "region");
  await page.click("#plan-find");
  await page.waitForSelector("#plan-status .plan-reached");
  assert.match((await page.locator(".plan-reached").textContent()) ?? "", /30 % darker in the marked part of the sky/);
  const id = inLink(page, "scenario");
  const [site] = (await getJson(`plans/${id}`)).sites;
  assert.equal(site.measure, "region");
  assert.ok(Math.abs(site.reduced_by - 0.3) < 1e-3);

  // The mark belongs to the link, and to both projections.
  await page.reload();
  await skyShown(page);
  assert.deepEqual(cornersOf(page), corners);
  await page.click("#projection button[value=fisheye]");
  await page.waitForTimeout(300);
  await shot(page, "region-fisheye");
  await page.click("#mark");
  assert.equal(regionOf(page), null);
  assert.equal(await page.locator("#measure").inputValue(), "zenith");
  assert.equal(await page.locator("#plan-measure").inputValue(), "zenith");
  assertNoFaults(opened);
  await context.close();
});

/** A part of the sky is marked by keyboard, and Escape ends it without a mark. */
test("a region is drawn by keyboard", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await page.click("#mark");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("#mark").textContent(), "Mark a part");
  assert.equal(regionOf(page), null);
  await page.focus("#mark");
  await page.keyboard.press("Enter");
  const step = async (key, times) => {
    for (let i = 0; i < times; i++) await page.keyboard.press(`Shift+${key}`);
    await page.keyboard.press("Enter");
  };
  await step("ArrowDown", 2);
  await step("ArrowRight", 2);
  await step("ArrowUp", 1);
  await step("ArrowLeft", 1);
  await page.keyboard.press("Enter");
  await page.waitForSelector("#layer-note-influence[data-state=shown]");
  assert.equal(cornersOf(page).length, 4);
  assertNoFaults(opened);
  await context.close();
});

test("a finger marks a part of the sky on a phone", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&projection=fisheye"), PHONE);
  const { page, context } = opened;
  await skyShown(page);
  await page.locator("#mark").scrollIntoViewIfNeeded();
  await page.tap("#mark");
  const client = await context.newCDPSession(page);
  await page.locator(".sky-overlay").scrollIntoViewIfNeeded();
  const box = await page.locator(".sky-overlay").boundingBox();
  const point = (i) => ({
    x: box.x + box.width * (0.5 + 0.2 * Math.cos((i * Math.PI) / 12)),
    y: box.y + box.height * (0.5 + 0.2 * Math.sin((i * Math.PI) / 12)),
  });
  await client.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [point(0)] });
  for (let i = 1; i < 24; i++) await client.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: [point(i)] });
  await client.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  // The panel of layers is folded on a phone.
  await page.waitForSelector("#layer-note-influence[data-state=shown]", { state: "attached" });
  // All around the zenith.
  const azimuths = cornersOf(page).map(([azimuthDeg]) => Math.floor(azimuthDeg / 90));
  assert.equal(new Set(azimuths).size, 4, `${azimuths}`);
  await shot(page, "region-phone");
  assertNoFaults(opened);
  await context.close();
});
