// How a sky is shown: as a camera sees it, in other units, and the link to it.
import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, SERVER, setSlider, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

/** Colours of the shown panorama and of the server's picture in the same directions. */
const sideBySide = (page, picture, directions) =>
  page.evaluate(
    async ({ picture, directions }) => {
      const image = new Image();
      image.src = picture;
      await image.decode();
      const pixels = (source, width, height) => {
        const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
        context.drawImage(source, 0, 0);
        return (x, y) => [...context.getImageData(Math.round(x), Math.round(y), 1, 1).data].slice(0, 3);
      };
      const canvas = document.querySelector(".sky-picture");
      const scale = canvas.width / canvas.clientWidth;
      const shown = pixels(canvas, canvas.width, canvas.height);
      const wanted = pixels(image, image.width, image.height);
      // The frame leaves 34 px at the left, 8 at the right and top, 28 below.
      const plot = { left: 34 * scale, top: 8 * scale, width: canvas.width - 42 * scale, height: canvas.height - 36 * scale };
      return directions.map(([azimuthDeg, elevationDeg]) => {
        const [across, down] = [azimuthDeg / 360, 1 - elevationDeg / 90];
        return [
          shown(plot.left + across * plot.width, plot.top + down * plot.height),
          wanted(across * image.width, down * image.height),
        ];
      });
    },
    { picture, directions },
  );

/** The sky as a camera sees it is the server's at the same exposure, which stays where it is put. */
test("the realistic picture is the server's", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&sky=artificial&colours=inferno"));
  const { page, context } = opened;
  await skyShown(page);
  assert.ok(await page.locator("#exposure-field").isHidden());
  await page.selectOption("#colours", "realistic");
  await page.waitForSelector("#exposure-field:not([hidden])");
  // Away from frame lines and names.
  const directions = [
    [37, 22],
    [77, 40],
    [141, 12],
    [200, 53],
    [253, 22],
    [318, 70],
  ];
  for (const exposure of [0, 3]) {
    await setSlider(page, "exposure", exposure);
    const picture = `${SERVER}/api/v1/${skyPath(here.scene, "panorama.png", here.beside, `&style=realistic&exposure=${exposure}&legend=off&width=2048&height_px=512`)}`;
    const pairs = await sideBySide(page, picture, directions);
    for (const [shown, wanted] of pairs) {
      assert.ok(
        shown.every((value, c) => Math.abs(value - wanted[c]) <= 6),
        `${exposure} EV: ${shown} for ${wanted}`,
      );
    }
    assert.ok(
      pairs.some(([shown]) => Math.max(...shown) > 25),
      `${exposure} EV: black`,
    );
  }
  assert.equal(await page.locator("#exposure-value").textContent(), "+3 EV: ISO 3200, f/2, 2 min");
  await shot(page, "realistic");
  const png = await page.locator("#download-links a").first().getAttribute("href");
  assert.match(png, /style=realistic&exposure=3/);
  await page.reload();
  await skyShown(page);
  assert.equal(await page.locator("#exposure").inputValue(), "3");
  assert.equal(await page.locator("#colours").inputValue(), "realistic");
  assertNoFaults(opened);
  await context.close();
});

/** Numbers, readout and legend come in magnitudes, luminance or times the natural sky. */
test("every unit shows in numbers and legend", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&sky=artificial&colours=inferno"));
  const { page, context } = opened;
  await skyShown(page);
  const { sky, dark_reference: dark } = await getJson(skyPath(here.scene, "sky", here.beside));
  const box = await page.locator(".sky-overlay").boundingBox();
  await page.locator(".sky-overlay").hover({ position: { x: box.width / 2, y: box.height / 2 } });
  const big = () => page.locator(".zenith .zenith-value").textContent();
  const marks = () => page.locator(".legend-tick b").allTextContents();
  assert.equal(await big(), `${sky.zenith_total_brightness_mag_arcsec2.toFixed(2)}mag/arcsec²`);
  await page.selectOption("#unit", "ratio");
  assert.ok(
    (await marks()).some((mark) => mark.trim() === "1"),
    `${await marks()}`,
  );
  const times = sky.zenith_total_luminance_cd_m2 / dark.luminance_cd_m2;
  assert.ok(Math.abs(Number.parseFloat(await big()) / times - 1) < 0.05, await big());
  const luminance = Number(await page.locator("#sky-readout").getAttribute("data-seen"));
  const read = await page.locator("#sky-readout b").allTextContents();
  assert.ok(
    read.some((text) => Math.abs(Number.parseFloat(text) / (luminance / dark.luminance_cd_m2) - 1) < 0.05 && text.endsWith("×")),
    `${read}`,
  );
  await shot(page, "ratio");
  await page.selectOption("#unit", "luminance");
  assert.ok((await marks()).map((mark) => mark.trim()).includes("100 µ"), `${await marks()}`);
  assert.match(await page.locator("#legend-title").textContent(), /cd\/m²/);
  assert.match(await page.locator("#download-links a").first().getAttribute("href"), /scale=luminance/);
  await page.reload();
  await skyShown(page);
  assert.equal(await page.locator("#unit").inputValue(), "luminance");
  assertNoFaults(opened);
  await context.close();
});

/** Whose light it is comes as files, of the measure and the lights that are shown. */
test("influences can be downloaded", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&measure=horizontal&turbidity=3"));
  const { page, context } = opened;
  await skyShown(page);
  const links = await page.locator("#influence-links a").evaluateAll((anchors) => anchors.map(({ href }) => href));
  assert.equal(links.length, 4);
  for (const [i, type] of ["image/tiff", "application/geo+json", "text/csv", "application/json"].entries()) {
    assert.match(links[i], /measure=horizontal/);
    assert.match(links[i], /turbidity=3/);
    const answer = await fetch(links[i]);
    assert.equal(answer.status, 200, links[i]);
    assert.ok(answer.headers.get("content-type").startsWith(type), `${answer.headers.get("content-type")} for ${type}`);
  }
  assertNoFaults(opened);
  await context.close();
});

/** The link to the view is copied, or shown where the browser forbids that. */
test("the link to the view is copied", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.click("#share");
  await page.waitForFunction(() => document.querySelector("#share-told").textContent.includes("copied"));
  const view = await page.evaluate(() => location.hash.slice(1));
  const isOfView = (link) => link.startsWith(`${SERVER}/at?${view}&towards=`);
  assert.ok(isOfView(await page.evaluate(() => navigator.clipboard.readText())));
  await page.evaluate(() => {
    navigator.clipboard.writeText = () => Promise.reject(new DOMException("no", "NotAllowedError"));
  });
  await page.click("#share");
  await page.waitForSelector("#share-link:not([hidden])");
  assert.ok(isOfView(await page.locator("#share-link").inputValue()));
  await page.keyboard.press("Tab");
  assert.ok(await page.locator("#share-link").isHidden());
  assertNoFaults(opened);
  await context.close();
});

/** The saved picture is the API's with a caption below it, and is named after the place. */
test("the saved picture has a caption", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await page.waitForSelector("#shares-list button");
  for (const [projection, width] of [
    ["equirectangular", 2048],
    ["fisheye", 1536],
  ]) {
    await page.click(`#projection button[value=${projection}]`);
    const [answer, download] = await Promise.all([
      page.waitForResponse(/panorama\.png/),
      page.waitForEvent("download"),
      page.click("#save-picture"),
    ]);
    assert.match(download.suggestedFilename(), /^skyglow .+\.png$/);
    const sizeOf = (png) => [png.readUInt32BE(16), png.readUInt32BE(20)];
    const plain = sizeOf(Buffer.from(await (await fetch(answer.url())).arrayBuffer()));
    const saved = await readFile(await download.path());
    assert.equal(sizeOf(saved)[0], width);
    assert.equal(plain[0], width);
    assert.ok(sizeOf(saved)[1] > plain[1] + 100);
    if (process.env.SKYGLOW_SHOTS) await writeFile(`${process.env.SKYGLOW_SHOTS}/caption-${projection}.png`, saved);
  }
  assertNoFaults(opened);
  await context.close();
});
