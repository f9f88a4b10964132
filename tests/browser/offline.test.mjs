// The installed viewer without a network: what was seen is shown again, and says of when it is.
import assert from "node:assert/strict";
import { test } from "node:test";
import { DESKTOP, SERVER, shot, skyShown } from "./support/browser.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

/** Waits until the worker has the page and this many of its files. */
async function shellKept(page) {
  await page.waitForFunction(async () => {
    const names = performance
      .getEntriesByType("resource")
      .map(({ name }) => name)
      .filter((name) => name.includes("/assets/"));
    const cache = await caches.open("skyglow-shell-1");
    const kept = await Promise.all([...names, "./"].map((name) => cache.match(name)));
    return navigator.serviceWorker.controller !== null && kept.every((response) => response !== undefined);
  });
}

/** A place that was seen comes back without a network, marked with its date; another one is refused in words; online all is new. */
test("a seen place comes back without a network", async () => {
  const context = await browser.newContext(DESKTOP);
  const page = await context.newPage();
  await page.goto(`${SERVER}/${fragment(here.beside)}`);
  await page.waitForSelector("#map[data-basemap=fine]");
  await skyShown(page);
  await shellKept(page);
  // From here on the worker hears every answer.
  await page.reload();
  await page.waitForSelector("#map[data-basemap=fine]");
  await skyShown(page);
  await page.waitForSelector("#shares-list button");
  assert.ok(await page.locator("#stored").isHidden());
  const zenith = await page.locator("[data-value=zenith_mag]").textContent();
  const sentence = await page.locator("#summary").textContent();

  await context.setOffline(true);
  await page.reload();
  await skyShown(page);
  assert.equal(await page.locator("[data-value=zenith_mag]").textContent(), zenith);
  await page.waitForFunction((told) => document.querySelector("#summary")?.textContent === told, sentence);
  const told = await page.locator("#stored").textContent();
  assert.match(told, /was kept, the oldest of/);
  assert.match(told, new RegExp(String(new Date().getFullYear())));
  await shot(page, "offline");

  // A place that nobody looked at is not made up.
  await page.evaluate((lat) => {
    location.hash = location.hash.replace(/lat=[^&]*/, `lat=${lat}`);
  }, here.beside.latitude_deg + 0.1);
  await page.getByText("The server does not answer", { exact: false }).first().waitFor();
  await page.waitForSelector("body[data-sky=none]");

  // The viewer alone offers the places that it has.
  await page.goto(`${SERVER}/`);
  await page.locator("#stored a").first().click();
  await skyShown(page);
  assert.equal(await page.locator("[data-value=zenith_mag]").textContent(), zenith);

  await context.setOffline(false);
  await page.locator("#stored").getByRole("button", { name: "Load anew" }).click();
  await page.waitForFunction(() => document.querySelector("#stored")?.hidden);
  await skyShown(page);
  await context.close();
});

/** What a browser wants before it offers to install the viewer. */
test("the viewer can be installed", async () => {
  const context = await browser.newContext(DESKTOP);
  const page = await context.newPage();
  await page.goto(`${SERVER}/`);
  const client = await context.newCDPSession(page);
  const { errors, data } = await client.send("Page.getAppManifest");
  assert.deepEqual(errors, []);
  const manifest = JSON.parse(data);
  assert.deepEqual([manifest.display, manifest.start_url], ["standalone", "./"]);
  const icon = await fetch(`${SERVER}/${manifest.icons[0].src}`);
  assert.equal(icon.headers.get("content-type"), "image/png");
  await context.close();
});
