// Looking around: the sky as one sees it, turned by mouse, wheel and keyboard.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, canvasColours, getJson, openPage, shot, skyShown } from "./support/browser.mjs";
import { COMPACT_ERROR, sample, skyPath } from "./support/sky.mjs";
import { browser, here } from "./support/stage.mjs";

const lookOf = async (page) => {
  const text = new URLSearchParams((await page.evaluate(() => location.hash)).slice(1)).get("look");
  return text === null ? null : text.split("/").map(Number);
};

/** One looks around with the mouse, the wheel and the keyboard, and a link looks there again. */
test("looking around by mouse, wheel and keyboard", async () => {
  const { beside, scene } = here;
  const opened = await openPage(
    browser,
    `#scene=${scene.id}&lat=${beside.latitude_deg}&lon=${beside.longitude_deg}&sky=artificial`,
  );
  const { page, context } = opened;
  await skyShown(page);
  await page.click("#projection button[value=perspective]");
  await page.waitForTimeout(200);
  assert.ok((await canvasColours(page, ".sky-picture")) > 60);
  await shot(page, "look-around");
  // It begins at the brightest light: the middle's foot is as bright as the API says.
  const { sky } = await getJson(skyPath(scene, "sky", beside));
  const box = await page.locator(".sky-overlay").boundingBox();
  const drag = async (x, y) => {
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2 + x, box.y + box.height / 2 + y, { steps: 5 });
    await page.mouse.up();
  };
  await drag(0, -1);
  const first = await lookOf(page);
  assert.ok(Math.abs(first[0] - sky.brightest_azimuth_deg) < 1.5, `${first} and not ${sky.brightest_azimuth_deg}`);
  // Dragged to the left, one looks further right; dragged down, further up.
  await drag(-100, 40);
  const second = await lookOf(page);
  assert.ok((second[0] - first[0] + 360) % 360 > 5 && second[1] > first[1], `${first} became ${second}`);
  await page.mouse.wheel(0, -300);
  const third = await lookOf(page);
  assert.ok(third[2] < second[2], `${second} became ${third}`);
  // The readout under the pointer is the sky's own there.
  await page.mouse.move(box.x + box.width / 2 + 1, box.y + box.height / 2);
  const readout = await page.locator("#sky-readout").evaluate(({ dataset }) => ({ ...dataset }));
  const expected = sample(
    await getJson(skyPath(scene, "panorama.json", beside)),
    Number(readout.azimuthDeg),
    Number(readout.elevationDeg),
  );
  assert.ok(Math.abs(Number(readout.azimuthDeg) - third[0]) < 2, `${readout.azimuthDeg} and not ${third[0]}`);
  assert.ok(Math.abs(Number(readout.seen) / expected.luminance_cd_m2 - 1) < COMPACT_ERROR);
  // By keyboard: the cross turns the view when it leaves it.
  for (let i = 0; i < 12; i++) await page.keyboard.press("Shift+ArrowRight");
  const fourth = await lookOf(page);
  assert.ok((fourth[0] - third[0] + 360) % 360 > 20, `${third} became ${fourth}`);
  await page.keyboard.press("-");
  assert.ok((await lookOf(page))[2] > fourth[2]);
  const last = await lookOf(page);
  await page.reload();
  await skyShown(page);
  assert.deepEqual(await lookOf(page), last);
  assert.equal(await page.locator("#projection button[value=perspective]").getAttribute("aria-checked"), "true");
  // The picture to take along looks there too.
  const png = await page.locator("#download-links a").first().getAttribute("href");
  const query = new URL(png).searchParams;
  assert.deepEqual([query.get("projection"), Number(query.get("azimuth"))], ["perspective", last[0]]);
  assert.equal((await fetch(png)).status, 200);
  assertNoFaults(opened);
  await context.close();
});
