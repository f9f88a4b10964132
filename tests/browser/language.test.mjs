// The page speaks the browser's language where it knows it, and another one when somebody chooses it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, DESKTOP, openPage, SERVER, shot, skyShown } from "./support/browser.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const GERMAN = { ...DESKTOP, locale: "de-AT" };
const language = (page) => page.getAttribute("html", "lang");
const welcome = (page) => page.locator(".welcome h2").textContent();

/** A German browser gets a German page, numbers and all. */
test("a German browser gets a German page", async () => {
  const opened = await openPage(browser, "", GERMAN);
  const { page, context } = opened;
  assert.equal(await language(page), "de");
  assert.equal(await welcome(page), "Wie hell ist die Nacht dort?");
  assert.equal(await page.locator(".welcome li b").first().textContent(), "Ort wählen");
  assert.ok(await page.getByRole("combobox", { name: "Ort oder Koordinaten suchen" }).isVisible());
  assert.ok(await page.getByRole("button", { name: "Verkleinern" }).isVisible(), "the map's own buttons too");
  await shot(page, "german");

  const { latitude_deg, longitude_deg } = here.beside;
  const letters = `${Math.abs(latitude_deg)}° ${latitude_deg < 0 ? "S" : "N"}, ${Math.abs(longitude_deg)}° ${longitude_deg < 0 ? "W" : "O"}`;
  await page.fill("#search", letters);
  await page.press("#search", "Enter");
  await skyShown(page);
  assert.deepEqual([inLink(page, "lat"), inLink(page, "lon")].map(Number), [latitude_deg, longitude_deg]);
  assert.match(await page.locator("[data-value=zenith_mag]").textContent(), /^\d\d,\d\d$/);
  assert.equal(await page.locator("#lamp option[value=hps]").textContent(), "Natriumdampf-Hochdruck, 2000 K");
  await page.locator(".sky-overlay").hover({ position: { x: 300, y: 60 } });
  assert.match(await page.locator("#sky-readout").textContent(), /Leuchtdichte/);
  assert.ok(Number(await page.getAttribute("#sky-readout", "data-seen")) > 0, "scripts read numbers with a point");
  await shot(page, "german_sky");
  assertNoFaults(opened);
  await context.close();
});

/** Another language is chosen, stays after a reload, and shows the same place. */
test("another language stays after a reload", async () => {
  const opened = await openPage(browser, fragment(here.beside), GERMAN);
  const { page, context } = opened;
  await skyShown(page);
  const link = page.url();
  const reloaded = page.waitForEvent("load");
  await page.getByLabel("Sprache").selectOption({ label: "English" });
  await reloaded;
  await skyShown(page);
  assert.equal(await language(page), "en");
  assert.equal(page.url(), link);
  await page.reload();
  await skyShown(page);
  assert.equal(await language(page), "en");
  assert.equal(await welcome(page), "How bright is the night there?");
  assert.equal(await page.getByLabel("Language").inputValue(), "en");
  assert.equal(page.url(), link);
  assertNoFaults(opened);
  await context.close();
});

/** What the server says is German too: the titles of problems, what is wrong with a value, and what an answer had to do without. */
test("the server's words are German too", async () => {
  const opened = await openPage(browser, fragment(here.beside), GERMAN);
  const { page, context } = opened;
  await skyShown(page);
  for (const warning of await page.locator("[data-value=warning]").all()) assert.equal(await warning.getAttribute("lang"), null);
  const lost = "s-00000000000000000000";
  await page.evaluate((id) => {
    location.hash += `&scenario=${id}`;
  }, lost);
  const notice = page.locator("#notice");
  await notice.getByText("Dieses Szenario oder diesen Plan gibt es nicht").waitFor();
  assert.match(await notice.textContent(), new RegExp(`Ein Szenario oder einen Plan „${lost}“ gibt es nicht`));
  assert.equal(await notice.locator("[lang=en]").count(), 0);
  await shot(page, "german_problem");
  await context.close();
});

/** English serves where the language's file does not come, and for languages that nobody has written. */
test("English serves where a language fails", async () => {
  const context = await browser.newContext({ ...GERMAN, serviceWorkers: "block" });
  const page = await context.newPage();
  await page.route(/german/, (route) => route.abort());
  await page.goto(`${SERVER}/`);
  await page.waitForSelector("#map[data-basemap]");
  assert.deepEqual([await language(page), await welcome(page)], ["en", "How bright is the night there?"]);
  await context.close();
  const other = await openPage(browser, "", { ...DESKTOP, locale: "fi-FI" });
  assert.deepEqual([await language(other.page), await welcome(other.page)], ["en", "How bright is the night there?"]);
  assertNoFaults(other);
  await other.context.close();
});
