// The report: what it says, how it prints, how it is saved, and the ways into it and out of it.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { assertNoFaults, DESKTOP, getJson, openPage, PHONE, SERVER, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

/** Waits until the report is there, its pictures too. */
async function reportShown(page) {
  await page.waitForSelector("#report .paper");
  await page.waitForFunction(() =>
    [...document.querySelectorAll("#report img")].every(({ complete, naturalWidth }) => complete && naturalWidth > 0),
  );
}

/** Mean of the bytes of pictures. */
function brightness(page, selector) {
  return page.$$eval(selector, (images) =>
    images.map((image) => {
      const canvas = new OffscreenCanvas(256, 32);
      const context = canvas.getContext("2d");
      context.drawImage(image, 0, 0, 256, 32);
      const { data } = context.getImageData(0, 0, 256, 32);
      return data.reduce((sum, byte, i) => sum + (i % 4 === 3 ? 0 : byte), 0) / (256 * 32 * 3);
    }),
  );
}

/** A plan for the place, stored. */
async function planned() {
  const { latitude_deg: lat, longitude_deg: lon } = here.beside;
  const answer = await fetch(`${SERVER}/api/v1/scenes/${here.scene.id}/plans`, {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify({ method: "target", max_cut: 0.5, sites: [{ lat, lon, measure: "zenith", reduce_by: 0.3 }] }),
  });
  assert.ok(answer.ok, String(answer.status));
  return answer.json();
}

/** One button leads to it; it has the numbers of the API and the page's sentence; Escape and Back lead out of it. */
test("a button opens the report of the place", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await page.waitForSelector("#shares-list button");
  const sentence = await page.locator("#summary").textContent();
  await page.getByRole("button", { name: "Report" }).click();
  await reportShown(page);
  assert.equal(inLink(page, "report"), "on");
  assert.equal(await page.locator("#report .sentence").textContent(), sentence);
  const { sky } = await getJson(skyPath(here.scene, "sky", here.beside));
  const numbers = await page.locator("#report .numbers tr").allTextContents();
  assert.ok(
    numbers.some((row) => row.includes(sky.zenith_total_brightness_mag_arcsec2.toFixed(2))),
    numbers.join("\n"),
  );
  const { places } = await getJson(skyPath(here.scene, "shares", here.beside, "&limit=12"));
  const towns = await page.locator("#report .shares-table tbody th").allTextContents();
  assert.deepEqual(
    towns.slice(0, 3),
    places.slice(0, 3).map(({ name }) => name),
  );
  assert.match(await page.locator("#report").textContent(), /Illustrative scene: made up/);
  // The page below is out of reach meanwhile.
  assert.ok(await page.$eval("main", (main) => main.inert));
  await shot(page, "report");
  await page.keyboard.press("Escape");
  await page.waitForSelector("#report", { state: "hidden" });
  assert.equal(await page.evaluate(() => document.activeElement?.id), "report-open");
  assert.equal(inLink(page, "report"), null);
  await page.keyboard.press("Enter");
  await reportShown(page);
  await page.goBack();
  await page.waitForSelector("#report", { state: "hidden" });
  assert.ok(!(await page.$eval("main", (main) => main.inert)));
  assertNoFaults(opened);
  await context.close();
});

/** It prints as A4 on white, without the page around it; with a plan a second page has the sky before and after. */
test("a report prints as pages of A4", async () => {
  const plan = await planned();
  const opened = await openPage(browser, fragment(here.beside, `&scenario=${plan.id}&report=on`));
  const { page, context } = opened;
  await reportShown(page);
  await page.waitForSelector("#report .change .lead");
  assert.equal(await page.locator("#report .change img").count(), 2);
  // Both skies are seen by one eye: one that adapts to each sees them alike.
  const seen = await page.$$eval("#report .change img", (images) =>
    images.map(({ src }) => Number(new URL(src).searchParams.get("adaptation"))),
  );
  assert.ok(seen[0] > 1e-4 && seen[0] === seen[1], `${seen}`);
  for (const caption of await page.locator("#report .change figcaption").allTextContents())
    assert.match(caption, /, to an eye adapted to the sky of today$/);
  const [before, after] = await brightness(page, "#report .change img");
  assert.ok(after < 0.95 * before, `${before} before, ${after} after`);
  const rows = await page.locator("#report .changes tbody tr").allTextContents();
  const [{ sky_before, sky_after }] = plan.sites;
  const mags = [sky_before, sky_after].map((sky) => sky.zenith_total_brightness_mag_arcsec2.toFixed(2));
  assert.ok(rows[0].includes(mags.join("")), `${rows[0]} for ${mags}`);
  await page.emulateMedia({ media: "print" });
  const printed = await page.evaluate(() => ({
    paper: getComputedStyle(document.querySelector(".paper")).backgroundColor,
    ink: getComputedStyle(document.querySelector(".paper h1")).color,
    main: getComputedStyle(document.querySelector("main")).display,
    bar: getComputedStyle(document.querySelector(".report-bar")).display,
  }));
  assert.deepEqual(printed, { paper: "rgb(255, 255, 255)", ink: "rgb(20, 25, 42)", main: "none", bar: "none" });
  const pdf = (await page.pdf({ preferCSSPageSize: true, printBackground: true })).toString("latin1");
  const pages = pdf.match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  assert.ok(pages === 2 || pages === 3, `${pages} pages: today, then the change with what was assumed`);
  const [, width, height] = /\/MediaBox\s*\[0 0 ([\d.]+) ([\d.]+)\]/.exec(pdf) ?? [];
  assert.ok(Math.abs(Number(width) - 595) < 1.5 && Math.abs(Number(height) - 842) < 1.5, `${width} × ${height} points`);
  await context.close();
});

/** It speaks the page's language on a phone, and is saved as one file that needs no server. */
test("a report is saved as a page of its own", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&report=on"), { ...PHONE, locale: "de-DE" });
  const { page, context } = opened;
  await reportShown(page);
  assert.match(await page.locator("#report h1").textContent(), /^Der Nachthimmel /);
  const overflow = await page.$eval("#report", (report) => report.scrollWidth - report.clientWidth);
  assert.equal(overflow, 0);
  await shot(page, "report-phone");
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name: "Als HTML speichern" }).click(),
  ]);
  assert.match(download.suggestedFilename(), /^Der Nachthimmel, .*\.html$/);
  const html = await readFile(await download.path(), "utf8");
  assert.match(html, /<html lang="de">/);
  assert.match(html, /<img[^>]* src="data:image\/png;base64,/);
  assert.doesNotMatch(html, /<script|<img[^>]* src="http/);
  assertNoFaults(opened);
  await context.close();
  // It shows by itself, without the server.
  const alone = await browser.newContext({ ...DESKTOP, offline: true });
  const saved = await alone.newPage();
  await saved.setContent(html);
  await saved.waitForFunction(() => (document.querySelector("img")?.naturalWidth ?? 0) > 1000);
  assert.equal(await saved.$eval(".paper", (paper) => getComputedStyle(paper).backgroundColor), "rgb(255, 255, 255)");
  await shot(saved, "report-saved");
  await alone.close();
});
