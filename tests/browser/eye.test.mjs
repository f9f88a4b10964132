// The sky as the eye sees it, drawn by shaders: the same picture as the server's.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, SERVER, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const GAZE = { azimuth: 100, elevation: 25, field: 40 };
/** The frame around the looking-around picture. */
const MARGIN_PX = 8;

/**
 * How the shown picture of a gaze differs from the server's in every third pixel that is not near a line of the frame, a name or
 * the horizon: the largest difference of a channel, how many pixels were compared, and in how many it is more than 2.
 */
const differences = (page, picture, gaze = GAZE) =>
  page.evaluate(
    async ({ picture, gaze, margin }) => {
      const radians = Math.PI / 180;
      const canvas = document.querySelector(".sky-picture");
      const [width, height] = [canvas.width - 2 * margin, canvas.height - 2 * margin];
      const fov = (2 * Math.atan((Math.tan((gaze.field / 2) * radians) * width) / height)) / radians;
      const image = new Image();
      image.src = `${picture}&projection=perspective&azimuth=${gaze.azimuth}&elevation=${gaze.elevation}&fov=${fov}&width=${width}&height_px=${height}`;
      await image.decode();
      const pixels = (source, left, top) => {
        const context = new OffscreenCanvas(width, height).getContext("2d");
        context.drawImage(source, -left, -top);
        return context.getImageData(0, 0, width, height).data;
      };
      const [shown, wanted] = [pixels(canvas, margin, margin), pixels(image, 0, 0)];
      const focal = height / 2 / Math.tan((gaze.field / 2) * radians);
      const [cos, sin] = [Math.cos(gaze.elevation * radians), Math.sin(gaze.elevation * radians)];
      const nearLine = (degrees, step) => Math.abs(((degrees + 360 + step / 2) % step) - step / 2) < 1;
      let [most, count, beyond] = [0, 0, 0];
      const colours = new Set();
      for (let y = 1; y < height; y += 3) {
        for (let x = 1; x < width; x += 3) {
          const [right, up] = [x + 0.5 - width / 2, height / 2 - y - 0.5];
          const [ahead, above] = [focal * cos - up * sin, focal * sin + up * cos];
          const elevation = Math.atan2(above, Math.hypot(ahead, right)) / radians;
          const azimuth = gaze.azimuth + Math.atan2(right, ahead) / radians;
          // Names of towns and terrain lie below 15°; the marks of elevations stand at the azimuths of the lines.
          if (elevation < 15 || nearLine(elevation, 30) || nearLine(azimuth, 45)) continue;
          if ((azimuth + 360) % 90 < 8 && nearLine(elevation - 1, 30)) continue;
          const at = 4 * (y * width + x);
          const differs = Math.max(...[0, 1, 2].map((c) => Math.abs(shown[at + c] - wanted[at + c])));
          most = Math.max(most, differs);
          if (differs > 2) beyond++;
          colours.add(shown[at]);
          count++;
        }
      }
      return { most, count, beyond, colours: colours.size };
    },
    { picture, gaze, margin: MARGIN_PX },
  );

/** Every pixel of the eye's picture is the server's to 2 of 255, at any exposure. */
test("the eye's picture is the server's", async () => {
  const { town } = here;
  for (const exposure of [0, 3]) {
    const look = `&projection=perspective&look=${Object.values(GAZE).join("/")}&colours=eye&sky=total&exposure=${exposure}`;
    const opened = await openPage(browser, fragment(town, look));
    const { page, context } = opened;
    await skyShown(page);
    const picture = `${SERVER}/api/v1/${skyPath(here.scene, "panorama.png", town, `&style=eye&exposure=${exposure}&legend=off`)}`;
    const { most, count, colours } = await differences(page, picture);
    assert.ok(count > 2000 && colours > 8, `${count} pixels of ${colours} reds`);
    assert.ok(most <= 2, `${exposure} EV: differs by ${most}`);
    await shot(page, `eye-${exposure}`);
    assertNoFaults(opened);
    await context.close();
  }
});

/** With half a Moon up, its glare and the stars are the server's too. */
test("the Moon's picture is the server's", async () => {
  const { beside } = here;
  const time = "2026-08-20T20:30:00Z";
  const night = await getJson(skyPath(here.scene, "sky", beside, `&time=${time}`));
  const { azimuth_deg: azimuth, apparent_altitude_deg: altitude } = night.night_sky.moon;
  assert.ok(altitude > 3, `the Moon is ${altitude}° up`);
  // Its disc stands low on the left; what is compared lies above 15°.
  const gaze = { azimuth: (azimuth + 8) % 360, elevation: 25, field: 40 };
  const look = `&time=${time.replace(":00Z", "Z")}&projection=perspective&look=${Object.values(gaze).join("/")}&colours=eye&sky=total`;
  const opened = await openPage(browser, fragment(beside, look));
  const { page, context } = opened;
  await skyShown(page);
  const picture = `${SERVER}/api/v1/${skyPath(here.scene, "panorama.png", beside, `&time=${time}&style=eye&legend=off`)}`;
  await shot(page, "eye-moon");
  const { most, count, colours, beyond } = await differences(page, picture, gaze);
  assert.ok(count > 2000 && colours > 20, `${count} pixels of ${colours} reds`);
  // A star's edge may fall on the next pixel.
  assert.ok(beyond / count < 2e-3, `${beyond} of ${count} differ by more than 2, by ${most} at most`);
  assertNoFaults(opened);
  await context.close();
});

/** A darker place looks darker to an eye that follows the sky, and darker still to one that stays as it is. */
test("the eye can be kept as it is", async () => {
  const { beside, town } = here;
  const opened = await openPage(browser, fragment(town, "&colours=eye&sky=total"));
  const { page, context } = opened;
  await skyShown(page);
  const middle = () =>
    page.$eval(".sky-picture", (canvas) => {
      const copy = new OffscreenCanvas(1, 1).getContext("2d");
      copy.drawImage(canvas, -Math.round(canvas.width * 0.45), -Math.round(canvas.height * 0.4));
      return [...copy.getImageData(0, 0, 1, 1).data];
    });
  const ofTown = await middle();
  const keep = page.locator("#keep-adaptation");
  await keep.click();
  await page.waitForSelector("#keep-adaptation[aria-pressed=true]");
  const kept = Number(inLink(page, "adaptation"));
  assert.ok(kept > 1e-4, `${kept}`);
  await page.goto(page.url().replace(/lat=[^&]*&lon=[^&]*/, `lat=${beside.latitude_deg}&lon=${beside.longitude_deg}`));
  await page.reload();
  await skyShown(page);
  const withKept = await middle();
  assert.match(await page.locator("#download-links a").first().getAttribute("href"), new RegExp(`adaptation=${kept}`));
  await keep.click();
  await page.waitForSelector("#keep-adaptation[aria-pressed=false]");
  assert.equal(inLink(page, "adaptation"), null);
  const following = await middle();
  assert.ok(following[2] > withKept[2] + 5, `${following} and ${withKept}`);
  assert.ok(ofTown[1] > following[1] + 3, `${ofTown} and ${following}`);
  assertNoFaults(opened);
  await context.close();
});

/** While one looks around, WebGL's own canvas is shown; at rest the fine picture is. */
test("the sky moves by WebGL and rests fine", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&projection=perspective&colours=eye&sky=total"));
  const { page, context } = opened;
  await skyShown(page);
  const shown = () =>
    page.$$eval(".sky-canvases canvas", (all) => all.map((canvas) => [canvas.style.visibility, canvas.style.opacity].join()));
  const rest = ["hidden,", "visible,", ",1"];
  assert.deepEqual(await shown(), rest);
  const box = await page.locator(".sky-overlay").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  const moving = await page.evaluate(
    ({ x, y }) =>
      new Promise((resolve) => {
        const at = { clientX: x + 30, clientY: y, buttons: 1, bubbles: true };
        document.querySelector(".sky-overlay").dispatchEvent(new PointerEvent("pointermove", at));
        requestAnimationFrame(() => {
          const [live, picture] = document.querySelectorAll(".sky-canvases canvas");
          const copy = new OffscreenCanvas(live.width, live.height).getContext("2d");
          copy.drawImage(live, 0, 0);
          const { data } = copy.getImageData(0, 0, live.width, live.height);
          const colours = new Set();
          for (let i = 0; i < data.length; i += 4) colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
          resolve({ live: live.style.visibility, picture: picture.style.visibility, colours: colours.size });
        });
      }),
    { x: box.x + box.width / 2, y: box.y + box.height / 2 },
  );
  assert.deepEqual([moving.live, moving.picture], ["visible", "hidden"]);
  assert.ok(moving.colours > 30, `${moving.colours} colours`);
  await page.mouse.up();
  await page.waitForTimeout(500);
  assert.deepEqual(await shown(), rest);
  assertNoFaults(opened);
  await context.close();
});

/** A lost WebGL context is drawn around, and used again when it is back. */
test("the sky survives a lost WebGL context", async () => {
  // The sky's canvas is not on the page: whoever makes a context is asked.
  const opened = await openPage(browser, "");
  const { page, context } = opened;
  await page.addInitScript(() => {
    const getContext = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (type, ...more) {
      const made = getContext.call(this, type, ...more);
      if (type === "webgl2" && !this.isConnected && made !== null) window.skyContext ??= made;
      return made;
    };
  });
  await page.goto(`${SERVER}/${fragment(here.beside, "&colours=eye&sky=total")}`);
  await page.reload();
  await skyShown(page);
  const middle = () =>
    page.$eval(".sky-picture", (canvas) => [
      ...canvas.getContext("2d").getImageData(Math.round(canvas.width * 0.45), Math.round(canvas.height * 0.5), 1, 1).data,
    ]);
  const before = await middle();
  assert.ok(before[2] > 5, `${before}`);
  const near = (other) => before.every((value, c) => Math.abs(value - other[c]) <= 2);
  await page.evaluate(() => {
    window.loss = window.skyContext.getExtension("WEBGL_lose_context");
    window.loss.loseContext();
  });
  await page.waitForTimeout(300);
  assert.ok(near(await middle()), `without a GPU ${await middle()} for ${before}`);
  await page.evaluate(() => window.loss.restoreContext());
  await page.waitForTimeout(300);
  assert.ok(near(await middle()), `back again ${await middle()} for ${before}`);
  await context.close();
});
