// The sky as the eye sees it, drawn by shaders: the same picture as the server's.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, openPage, SERVER, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

const GAZE = { azimuth: 100, elevation: 25, field: 40 };
/** The frame around the looking-around picture. */
const MARGIN_PX = 8;

/**
 * How the shown picture of a gaze differs from the server's in every third pixel that is not near a line of the frame, a name or
 * the horizon: the largest difference of a channel, and how many pixels were compared.
 */
const differences = (page, picture) =>
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
      let [most, count] = [0, 0];
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
          for (let c = 0; c < 3; c++) most = Math.max(most, Math.abs(shown[at + c] - wanted[at + c]));
          colours.add(shown[at]);
          count++;
        }
      }
      return { most, count, colours: colours.size };
    },
    { picture, gaze: GAZE, margin: MARGIN_PX },
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
