// The land in light below the viewer's own sky: the server's pictures of it, put below the skyline.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, openPage, shot, skyShown } from "./support/browser.mjs";
import { browser, fragment, inLink } from "./support/stage.mjs";

/** A valley in the Alps. */
const VALLEY = { latitude_deg: 46.53, longitude_deg: 8.61 };
/** Of the ground as a camera sees it without light, the mean of red, green and blue. */
const SILHOUETTE = 54;
const PICTURES = /panorama\.webp\?.*ground=(lit|snow)/;

/** Waits until land is shown as that, and nothing more is on its way. */
async function landShown({ page, asked }, kind) {
  const isThere = () => asked.filter((path) => PICTURES.exec(path)?.[1] === kind).length >= 4;
  for (let i = 0; i < 100 && kind !== "dark" && !isThere(); i++) await page.waitForTimeout(50);
  await page.waitForSelector("body:not(.busy)");
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

/** The picture of the sky: means of all channels over high sky and near ground, and every byte of that sky. */
const skyAndGround = (page) =>
  page.$eval(".sky-picture", (canvas) => {
    const { width, height } = canvas;
    const part = (from, to) => {
      const [top, rows] = [Math.round(from * height), Math.round((to - from) * height)];
      const copy = new OffscreenCanvas(Math.round(0.8 * width), rows).getContext("2d");
      copy.drawImage(canvas, -Math.round(0.1 * width), -top);
      const { data } = copy.getImageData(0, 0, copy.canvas.width, rows);
      return [...data].filter((_, i) => i % 4 !== 3);
    };
    const mean = (bytes) => bytes.reduce((sum, byte) => sum + byte, 0) / bytes.length;
    const sky = part(0.05, 0.3);
    return { sky, skyMean: mean(sky), groundMean: mean(part(0.86, 0.94)) };
  });

/** Lit ground is brighter than a silhouette and snow brighter than that, in a sky that stays as it is. */
test("the land is shown in its light", async () => {
  const opened = await openPage(browser, fragment(VALLEY, "&projection=perspective&look=150/12/70&exposure=2"));
  const { page, context, asked } = opened;
  await skyShown(page);
  assert.ok(!asked.some((path) => PICTURES.test(path)), "nobody asked for land");
  const dark = await skyAndGround(page);
  assert.ok(dark.groundMean < 10, `${dark.groundMean}`);
  const land = page.locator("#land");
  const shown = [dark];
  for (const kind of ["lit", "snow"]) {
    await land.selectOption(kind);
    await landShown(opened, kind);
    assert.equal(inLink(page, "land"), kind);
    await shot(page, `land-${kind}`);
    const now = await skyAndGround(page);
    assert.deepEqual(now.sky, dark.sky, `the sky above ${kind} ground`);
    assert.ok(now.groundMean > (shown.at(-1)?.groundMean ?? 0) + 5, `${kind}: ${now.groundMean} after ${shown.at(-1)?.groundMean}`);
    shown.push(now);
    assert.match(await page.locator("#download-links a").first().getAttribute("href"), new RegExp(`ground=${kind}`));
  }
  assert.ok(shown[2].groundMean < 2 * dark.skyMean, `snow of ${shown[2].groundMean} below a sky of ${dark.skyMean}`);
  await land.selectOption("water");
  await landShown(opened, "water");
  assert.equal(inLink(page, "land"), "water");
  await land.selectOption("dark");
  await landShown(opened, "dark");
  assert.equal(inLink(page, "land"), null);
  assert.ok(Math.abs((await skyAndGround(page)).groundMean - dark.groundMean) < 1);
  assertNoFaults(opened);
  await context.close();
});

/** A link restores the land in every projection, and false colours and terrain that is left out have none. */
test("a link restores the land in light", async () => {
  const opened = await openPage(
    browser,
    fragment(VALLEY, "&land=snow&colours=realistic&exposure=2&projection=perspective&look=150/12/70"),
  );
  const { page, context, asked } = opened;
  await skyShown(page);
  await landShown(opened, "snow");
  const around = await skyAndGround(page);
  assert.ok(around.groundMean > SILHOUETTE + 5, `${around.groundMean} below ${around.skyMean}`);
  const count = () => asked.filter((path) => PICTURES.test(path)).length;
  const before = count();
  await page.click("#projection button[value=fisheye]");
  await page.waitForTimeout(300);
  assert.equal(count(), before, "one landscape is that of all projections");
  await page.selectOption("#colours", "inferno");
  assert.ok(await page.locator("#land-field").isHidden());
  await page.selectOption("#colours", "eye");
  await page.selectOption("#terrain", "off");
  await skyShown(page);
  assert.ok(await page.locator("#land-field").isHidden());
  assertNoFaults(opened);
  await context.close();
});
