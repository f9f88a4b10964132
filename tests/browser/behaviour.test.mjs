// What a person relies on around the main job: links, errors, keyboard, phones, closed networks.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  assertNoFaults,
  canvasColours,
  getJson,
  openPage,
  PHONE,
  SERVER,
  screenColours,
  shot,
  skyShown,
} from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const text = (page, key) => page.locator(`[data-value=${key}]`).textContent();
const zenithOf = async (place, more = "") =>
  (await getJson(skyPath(here.scene, "sky", place, more))).sky.zenith_brightness_mag_arcsec2.toFixed(2);

/** A link restores place, map, air, lamp, projection, light and layers, and so does a reload. */
test("a link and a reload restore the whole view", async () => {
  const { beside } = here;
  const link = fragment(
    beside,
    `&map=7.5/${beside.latitude_deg}/${beside.longitude_deg}&turbidity=3.4&lamp=hps&projection=fisheye&sky=artificial&colours=cividis&radiance=0.4&elevation=0.5`,
  );
  const opened = await openPage(browser, link);
  const { page, context } = opened;
  const look = async () => {
    await skyShown(page);
    return {
      hash: new URL(page.url()).hash,
      zenith: await text(page, "zenith_mag"),
      turbidity: await page.locator("#turbidity").inputValue(),
      lamp: await page.locator("#lamp").inputValue(),
      fisheye: await page.getByRole("radio", { name: "Fisheye" }).getAttribute("aria-checked"),
      total: await page.getByRole("radio", { name: "With natural sky" }).getAttribute("aria-checked"),
      colours: await page.locator("#colours").inputValue(),
      opacity: await page.locator("#opacity-radiance").inputValue(),
      pins: await page.locator(".pin").count(),
    };
  };
  const seen = await look();
  const { sky } = await getJson(skyPath(here.scene, "sky", beside, "&turbidity=3.4&lamp=hps"));
  assert.deepEqual(seen, {
    hash: link,
    zenith: sky.zenith_brightness_mag_arcsec2.toFixed(2),
    turbidity: "3.4",
    lamp: "hps",
    fisheye: "true",
    total: "false",
    colours: "cividis",
    opacity: "0.4",
    pins: 1,
  });
  await page.reload();
  assert.deepEqual(await look(), seen);
  assertNoFaults(opened);
  await context.close();
});

/** The browser's back button returns to the place before. */
test("the back button returns to the place before", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  const first = await text(page, "zenith_mag");
  await page.locator("#search").fill(here.town.name);
  await page.keyboard.press("Enter");
  const there = await zenithOf(here.town);
  await page.waitForFunction((value) => document.querySelector("[data-value=zenith_mag]")?.textContent === value, there);
  await page.waitForTimeout(1000);
  await page.goBack();
  await page.waitForFunction((value) => document.querySelector("[data-value=zenith_mag]")?.textContent === value, first);
  assertNoFaults(opened);
  await context.close();
});

/** The search box finds a town by the beginning of its name and shows its sky. */
test("the search box finds a town and shows its sky", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  const search = page.getByRole("combobox", { name: /search/i });
  await search.fill(here.town.name.slice(0, 4).toLowerCase());
  await page.getByRole("option").filter({ hasText: here.town.name }).first().click();
  await skyShown(page);
  assert.equal(await page.locator("#place-title").evaluate((title) => title.firstChild.textContent), here.town.name);
  assert.equal(await text(page, "zenith_mag"), await zenithOf(here.town));
  await search.fill("no such town");
  await page.getByText("No place of that name here").waitFor();
  assertNoFaults(opened);
  await context.close();
});

/** A sky over ground that the terrain does not have says so among its numbers. */
test("missing terrain is a warning", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  const said = "the terrain has no data within 5 km of this place: the ground is taken at sea level";
  await page.route("**/api/v1/scenes/*/sky?*", async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, json: { ...(await response.json()), warnings: [said] } });
  });
  await page.evaluate((hash) => (location.hash = hash), fragment(here.town));
  await skyShown(page);
  assert.equal(await text(page, "warning"), `T${said.slice(1)}.`);
  await page.unroute("**/api/v1/scenes/*/sky?*");
  await page.evaluate((hash) => (location.hash = hash), fragment(here.beside));
  const there = await zenithOf(here.beside);
  await page.waitForFunction((value) => document.querySelector("[data-value=zenith_mag]")?.textContent === value, there);
  assert.equal(await page.locator("[data-value=warning]").count(), 0);
  assertNoFaults(opened);
  await context.close();
});

/** A place outside the scene is told in the server's words, and the viewer goes on. */
test("a place outside the scene is a problem", async () => {
  const opened = await openPage(browser, fragment(here.outside));
  const { page, context, faults } = opened;
  const notice = page.getByRole("alert");
  await notice.waitFor();
  const answer = await fetch(`${SERVER}/api/v1/${skyPath(here.scene, "site", here.outside)}`);
  assert.equal(answer.status, 404);
  assert.match(answer.headers.get("content-type"), /problem\+json/);
  const problem = await answer.json();
  const words = await notice.textContent();
  assert.ok(words.includes(problem.title), `${words} should say ${problem.title}`);
  // Sentences begin with a capital letter.
  const said = words.toLowerCase().includes(problem.detail.toLowerCase());
  assert.ok(said, `${words} should say ${problem.detail}`);
  assert.equal(await page.locator("body").getAttribute("data-sky"), "none");
  await shot(page, "outside");

  const box = await page.locator("#map").boundingBox();
  await page.evaluate((hash) => (location.hash = hash), fragment(here.town));
  await skyShown(page);
  assert.equal(await text(page, "zenith_mag"), await zenithOf(here.town));
  assert.ok(box.height > 0);
  // Chromium itself notes the 404; nothing else may be amiss.
  const own = faults.filter((fault) => !/status of 404/.test(fault));
  assert.deepEqual(own, []);
  await context.close();
});

/** Coordinates that no scene has are told so, and all that was shown stays; a link's place that another scene has is shown there. */
test("a place that no scene has loses nothing", async () => {
  const { latitude_deg, longitude_deg } = here.beside;
  const opened = await openPage(browser, `#scene=gone&lat=${latitude_deg}&lon=${longitude_deg}`);
  const { page, context } = opened;
  await skyShown(page);
  assert.equal(inLink(page, "scene"), here.scene.id);
  await page.getByRole("alert").getByText("gone").waitFor();
  const before = await text(page, "zenith_mag");
  await page.fill("#search", "-52.5, -13.4");
  await page.press("#search", "Enter");
  await page.getByRole("alert").getByText("No scene of this server covers").waitFor();
  assert.equal(await text(page, "zenith_mag"), before);
  assert.equal(Number(inLink(page, "lat")), Number(latitude_deg.toFixed(5)));
  assertNoFaults(opened);
  await context.close();
});

/** A newer pick overtakes an older one whose answer is late. */
test("a newer pick overtakes an older one", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  let cancelled = 0;
  page.on("requestfailed", (request) => {
    if (/sky\?/.test(request.url())) cancelled++;
  });
  let held = true;
  await page.route("**/sky?**", async (route) => {
    if (held) {
      held = false;
      await new Promise((resolve) => setTimeout(resolve, 3000));
    }
    await route.continue().catch(() => undefined);
  });
  const first = page.waitForRequest("**/sky?**");
  await page.evaluate((hash) => (location.hash = hash), fragment(here.beside));
  await first;
  await page.evaluate((hash) => (location.hash = hash), fragment(here.town));
  await skyShown(page);
  const expected = await zenithOf(here.town);
  assert.equal(await text(page, "zenith_mag"), expected);
  assert.equal(cancelled, 1, "the older request is cancelled");
  await page.waitForTimeout(3200);
  assert.equal(await text(page, "zenith_mag"), expected, "the late answer changes nothing");
  assertNoFaults(opened);
  await context.close();
});

/** A busy server is asked again after the time it names. */
test("a busy server is asked again", async () => {
  const opened = await openPage(browser);
  const { page, context, faults } = opened;
  let refused = 0;
  await page.route("**/sky?**", (route) => {
    if (refused++ > 0) return route.continue();
    return route.fulfill({
      status: 503,
      headers: { "retry-after": "1", "content-type": "application/problem+json" },
      body: '{"title":"Busy"}',
    });
  });
  await page.evaluate((hash) => (location.hash = hash), fragment(here.town));
  await skyShown(page);
  assert.equal(refused, 2);
  assert.equal(await page.getByRole("alert").count(), 0);
  assert.deepEqual(
    faults.filter((fault) => !/status of 503/.test(fault)),
    [],
  );
  await context.close();
});

/** What is found for the first time is waited for, however often one is told to come again, and said meanwhile. */
test("what is being found is said and waited for", async () => {
  const opened = await openPage(browser);
  const { page, context, faults } = opened;
  let refused = 0;
  await page.route("**/sky?**", (route) => {
    refused += 1;
    if (refused > 6) return route.continue();
    const body = { type: "/problems/being-made", title: "This is being made", status: 503, progress: refused / 10 };
    return route.fulfill({
      status: 503,
      headers: { "retry-after": "1", "content-type": "application/problem+json" },
      body: JSON.stringify(body),
    });
  });
  await page.evaluate((hash) => (location.hash = hash), fragment(here.town));
  await page.getByRole("status").getByText("40 % are there").waitFor();
  await skyShown(page);
  assert.equal(refused, 7);
  assert.equal(await page.locator("#finding").isVisible(), false);
  assert.equal(await page.getByRole("alert").count(), 0);
  assert.deepEqual(
    faults.filter((fault) => !/status of 503/.test(fault)),
    [],
  );
  await context.close();
});

test("a server that has gone away is said so", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  await page.route("**/site?**", (route) => route.abort());
  await page.evaluate((hash) => (location.hash = hash), fragment(here.town));
  await page.getByRole("alert").getByText("The server does not answer").waitFor();
  await context.close();
});

/** The keyboard alone picks the place in the middle, reads the sky and switches the projection. */
test("the keyboard alone picks a place and reads", async () => {
  const { town } = here;
  const opened = await openPage(browser, `#scene=${here.scene.id}&map=9/${town.latitude_deg}/${town.longitude_deg}`);
  const { page, context } = opened;
  await page.locator("#map canvas").focus();
  await page.locator(".crosshair").waitFor();
  await page.keyboard.press("Enter");
  await skyShown(page);
  await page.locator(".sky-overlay").focus();
  await page.keyboard.press("ArrowRight");
  const azimuth = () => page.locator("#sky-readout").evaluate(({ dataset }) => Number(dataset.azimuthDeg));
  const from = await azimuth();
  await page.keyboard.press("ArrowRight");
  assert.ok(Math.abs((await azimuth()) - from - 360 / 256) < 1e-9);
  await page.getByRole("radio", { name: "Panorama" }).focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.locator("body").getAttribute("data-projection"), "fisheye");
  // Everything that can be pressed or moved has a name for those who hear the page.
  const nameless = await page.$$eval("button, input, select, canvas[tabindex]", (elements) =>
    elements
      .filter((element) => element.checkVisibility())
      .filter(
        (element) =>
          !(
            element.textContent?.trim() ||
            element.getAttribute("aria-label") ||
            element.title ||
            element.labels?.[0]?.textContent?.trim()
          ),
      )
      .map((element) => element.outerHTML),
  );
  assert.deepEqual(nameless, []);
  assertNoFaults(opened);
  await context.close();
});

/** A phone shows everything without scrolling sideways. */
test("a phone needs no scrolling sideways", async () => {
  const opened = await openPage(browser, fragment(here.beside), PHONE);
  const { page, context } = opened;
  await skyShown(page);
  const { wide, screen } = await page.evaluate(() => ({ wide: document.documentElement.scrollWidth, screen: innerWidth }));
  assert.ok(wide <= screen, `${wide} px wide on a screen of ${screen}`);
  assert.ok((await canvasColours(page, ".sky-picture")) > 60);
  await page.locator(".sky-overlay").tap({ position: { x: 150, y: 60 } });
  assert.match((await page.locator("#sky-readout").textContent()) ?? "", /mag\/arcsec²/);
  await shot(page, "phone");
  await page.getByRole("radio", { name: "Fisheye" }).tap();
  await page.locator("#sky-area").scrollIntoViewIfNeeded();
  await shot(page, "phone-fisheye");
  assertNoFaults(opened);
  await context.close();
});

/** Red light leaves no green and no blue on the screen. */
test("red light leaves no green and no blue", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await page.getByRole("button", { name: "Red light" }).click();
  assert.equal(await page.getByRole("button", { name: "Red light" }).getAttribute("aria-pressed"), "true");
  await page.reload();
  await skyShown(page);
  assert.ok(await page.evaluate(() => document.documentElement.classList.contains("red-light")), "it lasts over a reload");
  const { most } = await screenColours(browser, page, "body");
  assert.ok(most[0] > 200 && most[1] < 40 && most[2] < 40, `brightest red, green, blue: ${most}`);
  await shot(page, "red-light");
  assertNoFaults(opened);
  await context.close();
});

/** The viewer works under a policy that allows nothing but its own server. */
test("the viewer works under a strict policy", async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  const violations = [];
  page.on("console", (message) => {
    if (/Content Security Policy/i.test(message.text())) violations.push(message.text());
  });
  const policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; worker-src 'self'; img-src 'self' data: blob:; base-uri 'none'";
  await page.route(`${SERVER}/`, async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, headers: { ...response.headers(), "content-security-policy": policy } });
  });
  await page.goto(`${SERVER}/${fragment(here.town)}`);
  await page.waitForSelector("#map[data-basemap]");
  await skyShown(page);
  assert.deepEqual(violations, []);
  await context.close();
});

/** Without WebGL the viewer says so, and the search box still shows skies. */
test("without WebGL the search still shows skies", async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.addInitScript(() => {
    const own = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind.startsWith("webgl") ? null : own.call(this, kind, ...rest);
    };
  });
  await page.goto(`${SERVER}/#scene=${here.scene.id}`);
  await page.getByRole("alert").getByText("The map cannot be drawn here").waitFor();
  const { latitude_deg, longitude_deg } = here.beside;
  await page.locator("#search").fill(`${latitude_deg}, ${longitude_deg}`);
  await page.keyboard.press("Enter");
  await skyShown(page);
  assert.equal(await text(page, "zenith_mag"), await zenithOf(here.beside));
  await shot(page, "no-webgl");
  await context.close();
});

/** The page's own files are less than 500 kB on the way until the map is there. */
test("the page's files are less than 500 kB", async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto(`${SERVER}/#scene=${here.scene.id}`);
  await page.waitForSelector("#map[data-basemap]");
  // What comes once the fine outlines are there is for a place that nobody picked yet.
  const files = await page.evaluate(() => {
    const all = [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")];
    const fine = all.find(({ name }) => name.includes("countries-50m"))?.responseEnd || Number.POSITIVE_INFINITY;
    return all
      .filter(({ name, startTime }) => !name.includes("/api/") && !name.includes("countries-50m") && startTime <= fine)
      .map(({ name, encodedBodySize, decodedBodySize }) => ({ name, encodedBodySize, decodedBodySize }));
  });
  // The icon is asked for twice and comes once.
  const once = new Map(files.map(({ name, encodedBodySize }) => [name, encodedBodySize]));
  const sum = [...once.values()].reduce((bytes, size) => bytes + size, 0);
  assert.ok(files.length >= 6 && files.some(({ name }) => name.includes("countries-110m")), JSON.stringify(files));
  assert.ok(sum > 300_000 && sum < 500_000, `${sum} bytes: ${JSON.stringify(files)}`);
  await page.waitForSelector("#map[data-basemap=fine]");
  await context.close();
});

/** The browser's own place is picked when it is asked for, and a refusal is said in plain words. */
test("the browser's own place is picked", async () => {
  const { latitude_deg: latitude, longitude_deg: longitude } = here.beside;
  const context = await browser.newContext({ geolocation: { latitude, longitude }, permissions: ["geolocation"] });
  const page = await context.newPage();
  await page.goto(`${SERVER}/#scene=${here.scene.id}`);
  await page.click("#locate");
  await skyShown(page);
  assert.equal(await text(page, "zenith_mag"), await zenithOf(here.beside));
  await context.clearPermissions();
  await page.click("#locate");
  await page.getByRole("alert").getByText("may not tell where you are").waitFor();
  await context.close();
});
