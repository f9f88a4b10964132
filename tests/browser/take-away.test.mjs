// What is taken along: pictures for bright screens and up to 4K, a change before and after, the horizon, readings of a meter, and a link
// that previews can read.
import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { test } from "node:test";
import { assertNoFaults, getJson, openPage, SERVER, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

const TIME = "2026-08-12T22:00Z";
/** A night with bright stars, and a half Moon at dusk. */
const MOONLIT = "2026-08-20T20:00Z";

/** Chunks of a PNG, by type. */
function chunksOf(png) {
  const chunks = [];
  for (let at = 8; at < png.length; ) {
    const length = png.readUInt32BE(at);
    chunks.push({ type: png.toString("latin1", at + 4, at + 8), data: png.subarray(at + 8, at + 8 + length) });
    at += 12 + length;
  }
  return chunks;
}

const typesOf = (png) => chunksOf(png).map(({ type }) => type);

/** The link "HDR" is a PNG that says so; Chromium reads the chunk, so that white is white and the sky as dark as in the plain picture. */
test("a picture for bright screens is read", async () => {
  const opened = await openPage(browser, fragment(here.beside, `&time=${MOONLIT}&sky=total&colours=eye&projection=fisheye`));
  const { page, context } = opened;
  await skyShown(page);
  const href = await page.locator("#download-links a", { hasText: "HDR" }).getAttribute("href");
  assert.match(href, /dynamic_range=hdr/);
  const url = new URL(href, page.url()).href;
  const png = Buffer.from(await (await fetch(url)).arrayBuffer());
  const chunks = chunksOf(png);
  const data = (wanted) => chunks.find(({ type }) => type === wanted)?.data;
  assert.deepEqual([...data("cICP")], [9, 16, 0, 1]);
  assert.ok(typesOf(png).indexOf("cICP") < typesOf(png).indexOf("IDAT"));
  assert.equal(data("IHDR")[8], 16, "bits of a sample");
  const brightest = data("cLLI").readUInt32BE(0) / 1e4;
  assert.ok(brightest > 400 && brightest < 1010, `${brightest}`);
  if (process.env.SKYGLOW_SHOTS) await writeFile(`${process.env.SKYGLOW_SHOTS}/hdr.png`, png);
  const plain = url.replace("&dynamic_range=hdr", "");
  const read = await page.evaluate(
    async (urls) => {
      const pictures = await Promise.all(
        urls.map(async (url) => {
          const image = new Image();
          image.src = url;
          await image.decode();
          const { naturalWidth: width, naturalHeight: height } = image;
          const context = new OffscreenCanvas(width, height).getContext("2d");
          context.drawImage(image, 0, 0);
          return { width, height, data: context.getImageData(0, 0, width, height).data };
        }),
      );
      const [{ width, height }] = pictures;
      const grey = (data, i) => (data[4 * i] + data[4 * i + 1] + data[4 * i + 2]) / 3;
      // Rows of sky through the middle of the picture.
      const row = Math.round(0.5 * height) * width;
      const means = pictures.map(({ data }) => {
        let sum = 0;
        for (let i = 0; i < width; i++) sum += grey(data, row + i);
        return sum / width;
      });
      const brightest = pictures.map(({ data }) => {
        let most = 0;
        for (let i = 0; i < width * height; i++) most = Math.max(most, grey(data, i));
        return most;
      });
      return { means, brightest, sizes: pictures.map(({ width, height }) => [width, height]) };
    },
    [url, plain],
  );
  assert.deepEqual(read.sizes[0], read.sizes[1]);
  const [hdr, standard] = read.means;
  assert.ok(Math.abs(hdr - standard) < 0.35 * standard + 4, `${read.means}: a reader without the chunk has twice as much`);
  assert.ok(read.brightest[0] > 200, `${read.brightest}`);
  // False colours go no higher than white.
  await page.selectOption("#colours", "inferno");
  await page.waitForFunction(() => !document.querySelector("#download-links").textContent.includes("HDR"));
  assertNoFaults(opened);
  await context.close();
});

/** A picture of 4K has its pixels and the shape of what is seen. */
test("a picture is saved in 4K", async () => {
  const opened = await openPage(browser, fragment(here.beside, `&time=${TIME}&sky=total&colours=eye`));
  const { page, context } = opened;
  await page.waitForSelector("#shares-list button");
  await page.selectOption("#save-size", "4k");
  const [answer, download] = await Promise.all([
    page.waitForResponse(/panorama\.png/),
    page.waitForEvent("download"),
    page.click("#save-picture"),
  ]);
  const query = new URL(answer.url()).searchParams;
  assert.deepEqual([query.get("width"), query.get("height_px")], ["3840", "960"]);
  const saved = await readFile(await download.path());
  assert.equal(saved.readUInt32BE(16), 3840);
  assert.ok(saved.readUInt32BE(20) > 960);
  if (process.env.SKYGLOW_SHOTS) await writeFile(`${process.env.SKYGLOW_SHOTS}/4k.png`, saved);
  assertNoFaults(opened);
  await context.close();
});

/** Before and after is one file of two pictures, seen by one eye; without a change there is none to save. */
test("before and after is saved as one", async () => {
  const { latitude_deg: lat, longitude_deg: lon } = here.town;
  const posted = await fetch(`${SERVER}/api/v1/scenes/${here.scene.id}/scenarios`, {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify({ edits: [{ brush: { points: [[lon, lat]], radius_m: 20000 }, factor: 0.05 }] }),
  });
  assert.ok(posted.ok, `${posted.status}`);
  const { id: scenario } = await posted.json();
  const opened = await openPage(browser, fragment(here.beside, "&sky=total&colours=eye"));
  const { page, context } = opened;
  await skyShown(page);
  assert.ok(await page.locator("#save-both").isHidden());
  await page.goto("about:blank");
  await page.goto(`${SERVER}/${fragment(here.beside, `&sky=total&colours=eye&scenario=${scenario}`)}`);
  await skyShown(page);
  await page.waitForSelector("#save-moving:not([hidden])");
  const asked = [];
  page.on("request", (request) => {
    if (request.url().includes("panorama.png")) asked.push(new URL(request.url()).searchParams);
  });
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save-both")]);
  const saved = await readFile(await download.path());
  assert.deepEqual(typesOf(saved).filter((type) => type === "fcTL").length, 2);
  assert.equal(asked.length, 2);
  const [one, other] = asked.map((query) => query.get("adaptation"));
  assert.ok(one !== null && one === other, `${one} ${other}`);
  assert.deepEqual(asked.map((query) => query.get("scenario")).sort(), [scenario, null].sort());
  assert.ok(saved.length < 2_500_000, `${saved.length}`);
  const [downloadedGif] = await Promise.all([page.waitForEvent("download"), page.click("#save-both-gif")]);
  assert.match(downloadedGif.suggestedFilename(), /\.gif$/);
  const gif = await readFile(await downloadedGif.path());
  assert.ok(gif.length < 2_500_000, `${gif.length}`);
  // The browser plays both: the first picture differs from what comes after two seconds.
  const [frames, framesOfGif] = [await meansOf(page, saved, "image/png"), await meansOf(page, gif, "image/gif")];
  for (const means of [frames, framesOfGif]) {
    assert.equal(means.length, 2);
    assert.ok(means[0] > 1.05 * means[1], `${means}`);
  }
  framesOfGif.forEach((mean, i) => {
    assert.ok(Math.abs(mean - frames[i]) < 0.6, `${framesOfGif} ${frames}`);
  });
  if (process.env.SKYGLOW_SHOTS) await writeFile(`${process.env.SKYGLOW_SHOTS}/before-after.png`, saved);
  if (process.env.SKYGLOW_SHOTS) await writeFile(`${process.env.SKYGLOW_SHOTS}/before-after.gif`, gif);
  assertNoFaults(opened);
  await context.close();
});

/** The mean value of each picture of a file. */
function meansOf(page, file, type) {
  return page.evaluate(
    async ({ bytes, type }) => {
      const decoder = new ImageDecoder({ data: Uint8Array.from(bytes), type });
      await decoder.tracks.ready;
      const count = decoder.tracks.selectedTrack.frameCount;
      const means = [];
      for (let frameIndex = 0; frameIndex < count; frameIndex++) {
        const { image } = await decoder.decode({ frameIndex });
        const context = new OffscreenCanvas(64, 16).getContext("2d");
        context.drawImage(image, 0, 0, 64, 16);
        const { data } = context.getImageData(0, 0, 64, 16);
        means.push(data.reduce((sum, value, i) => sum + (i % 4 === 3 ? 0 : value), 0) / (64 * 16 * 3));
      }
      return means;
    },
    { bytes: [...file], type },
  );
}

/** The horizon is there for programs of the night sky. */
test("the horizon can be downloaded", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  const links = await page.locator("#horizon-links a").evaluateAll((anchors) => anchors.map(({ href }) => href));
  assert.equal(links.length, 3);
  for (const [i, type] of ["text/plain", "text/plain", "application/zip"].entries()) {
    const answer = await fetch(links[i]);
    assert.equal(answer.status, 200, links[i]);
    assert.ok(answer.headers.get("content-type").startsWith(type), `${answer.headers.get("content-type")} for ${type}`);
  }
  assertNoFaults(opened);
  await context.close();
});

/** A reading stands beside the model's meter, and is kept for later. */
test("a meter's reading is held against the model", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  const { sky } = await getJson(skyPath(here.scene, "sky", here.beside));
  const model = sky.sqm_total_brightness_mag_arcsec2;
  await page.click("#meter summary");
  const told = () => page.locator("#meter-told").textContent();
  await page.fill("#meter-reading", (model - 0.5).toFixed(2).replace(".", ","));
  assert.match(await told(), /0\.(49|50|51) mag\/arcsec² brighter, (58|59|57|60) % more light/);
  await page.fill("#meter-reading", (model + 0.05).toFixed(2));
  assert.match(await told(), /agree/);
  await page.fill("#meter-reading", "bright");
  assert.ok(await page.locator("#meter-keep").isDisabled());
  await page.fill("#meter-reading", (model + 0.05).toFixed(2));
  await page.click("#meter-keep");
  await shot(page, "meter");
  await page.reload();
  await skyShown(page);
  await page.click("#meter summary");
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#meter-save")]);
  const [, row] = (await readFile(await download.path(), "utf8")).split("\n");
  assert.ok(row.includes(`,${model.toFixed(2)},`) && row.includes(`,${(model + 0.05).toFixed(2)},`), row);
  assertNoFaults(opened);
  await context.close();
});

/** The link to share has a page that says the place and shows its sky, and leads to the view. */
test("a shared link has a preview", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&projection=fisheye"));
  const { page, context } = opened;
  await skyShown(page);
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.click("#share");
  await page.waitForFunction(() => document.querySelector("#share-told").textContent.includes("copied"));
  const link = await page.evaluate(() => navigator.clipboard.readText());
  const html = await (await fetch(link)).text();
  const picture = /og:image" content="([^"]+)"/.exec(html)[1].replaceAll("&amp;", "&");
  const answer = await fetch(picture);
  assert.equal(answer.headers.get("content-type"), "image/png", picture);
  if (process.env.SKYGLOW_SHOTS) await writeFile(`${process.env.SKYGLOW_SHOTS}/og.png`, Buffer.from(await answer.arrayBuffer()));
  const view = new URL(page.url()).hash;
  await page.goto(link);
  await page.waitForFunction(() => location.pathname === "/");
  await skyShown(page);
  const parts = (hash) =>
    [...new URLSearchParams(hash.slice(1))].filter(([name]) => ["scene", "lat", "lon", "projection"].includes(name));
  assert.deepEqual(parts(new URL(page.url()).hash), parts(view));
  assertNoFaults(opened);
  await context.close();
});

/** The next dark weekend is a Friday's or Saturday's night, and its dark hours. */
test("the next dark weekend is found", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await page.click("#time-weekend");
  await page.waitForFunction(() => location.hash.includes("time="));
  await page.waitForFunction(() => [5, 6].includes(new Date(`${document.querySelector("#night-date").value}T12:00Z`).getUTCDay()));
  assert.match(await page.locator("#time-told").textContent(), /: night$/);
  await shot(page, "weekend");
  assertNoFaults(opened);
  await context.close();
});

/** A light on the map says its share while the layer of influences is shown. */
test("a light on the map says its share", async () => {
  const { pixels } = await getJson(skyPath(here.scene, "influence.json", here.beside, "&limit=1"));
  const [light] = pixels;
  const at = `map=11/${light.latitude_deg}/${light.longitude_deg}`;
  const opened = await openPage(browser, fragment(here.beside, `&${at}&influence=0.9`));
  const { page, context } = opened;
  await skyShown(page);
  await page.waitForFunction(() => performance.getEntriesByType("resource").some(({ name }) => name.includes("influence.json")));
  const box = await page.locator("#map").boundingBox();
  await page.waitForFunction(
    ([x, y]) => {
      document.querySelector("#map canvas").dispatchEvent(new MouseEvent("mousemove", { clientX: x, clientY: y, bubbles: true }));
      return [...document.querySelectorAll(".area-tip")].some(({ hidden }) => !hidden);
    },
    [box.x + box.width / 2, box.y + box.height / 2],
  );
  const tip = await page.locator(".area-tip:not([hidden])").textContent();
  const share = 100 * light.share;
  assert.equal(Number.parseFloat(tip), +(share < 9.95 ? share.toFixed(1) : share.toFixed(0)), tip);
  await shot(page, "light-share");
  assertNoFaults(opened);
  await context.close();
});
