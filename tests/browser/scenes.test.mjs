// Which scene is shown: that of the place, real data before the demo.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, DESKTOP, getJson, openPage, PHONE, shot, skyShown } from "./support/browser.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

/** A server with a measured scene of the north besides the demo, which answers for both. */
async function withNorth(context) {
  const [west, , east, north] = here.scene.bounds;
  const bounds = [west, north - 1, east, north + 8];
  const measured = { ...here.scene, id: "north", title: "The measured north", illustrative: false, bounds };
  await context.route("**/api/v1/scenes", (route) => route.fulfill({ json: [here.scene, measured] }));
  const inNorth = { name: "Nordheim", latitude_deg: north + 4, longitude_deg: (west + east) / 2, population: 12_000 };
  await context.route("**/api/v1/scenes/north/**", async (route) => {
    const url = new URL(route.request().url());
    if (url.pathname.endsWith("/places")) return route.fulfill({ json: [inNorth] });
    // The demo's sky serves.
    url.pathname = url.pathname.replace("/north/", `/${here.scene.id}/`);
    url.searchParams.set("lat", String(here.beside.latitude_deg));
    return route.fulfill({ response: await route.fetch({ url: url.href }) });
  });
  return inNorth;
}

/** Measured data is shown first, and a place outside it in the scene that has it. */
test("real data comes before the demo", async () => {
  const context = await browser.newContext(DESKTOP);
  await withNorth(context);
  const page = await context.newPage();
  await page.goto(`${process.env.SKYGLOW_URL}/`);
  await page.waitForSelector("#map[data-basemap]");
  await page.waitForFunction(() => document.querySelector("#scene").value === "north");
  const { latitude_deg, longitude_deg } = here.beside;
  await page.fill("#search", `${latitude_deg}, ${longitude_deg}`);
  await page.press("#search", "Enter");
  await skyShown(page);
  assert.equal(inLink(page, "scene"), here.scene.id);
  await page.goto("about:blank");
  await page.goto(`${process.env.SKYGLOW_URL}/#lat=${latitude_deg}&lon=${longitude_deg}`);
  await skyShown(page);
  assert.equal(inLink(page, "scene"), here.scene.id);
  await context.close();
});

/** The search finds places of every scene, and the browser's own place finds its scene. */
test("search and my place know every scene", async () => {
  const context = await browser.newContext({ ...DESKTOP, permissions: ["geolocation"] });
  const nordheim = await withNorth(context);
  await context.setGeolocation({ latitude: nordheim.latitude_deg, longitude: nordheim.longitude_deg });
  const page = await context.newPage();
  await page.goto(`${process.env.SKYGLOW_URL}/${fragment(here.town)}`);
  await skyShown(page);
  assert.equal(inLink(page, "scene"), here.scene.id);
  await page.fill("#search", "nord");
  const option = page.getByRole("option").filter({ hasText: "Nordheim" });
  assert.match(await option.textContent(), /The measured north/);
  await option.click();
  await page.waitForFunction(() => location.hash.includes("scene=north"));
  await skyShown(page);
  assert.equal(await page.title(), "Nordheim – Skyglow");
  await page.goto("about:blank");
  await page.goto(`${process.env.SKYGLOW_URL}/${fragment(here.town)}`);
  await skyShown(page);
  await page.click("#locate");
  await page.waitForFunction(() => location.hash.includes("scene=north"));
  await skyShown(page);
  await context.close();
});

/** A server with a scene of an earlier year, in which the demo's lights are half as bright at the zenith. */
async function withEarlierYear(page) {
  const now = { ...here.scene, date: "2023" };
  const earlier = { ...here.scene, id: "demo-2012", date: "2012" };
  await page.route("**/api/v1/scenes", (route) => route.fulfill({ json: [now, earlier] }));
  await page.route("**/api/v1/scenes/demo-2012/**", async (route) => {
    const url = new URL(route.request().url());
    const isNumbers = url.pathname.endsWith("/sky");
    url.pathname = url.pathname.replace("/demo-2012/", `/${here.scene.id}/`);
    const response = await route.fetch({ url: url.href });
    if (!isNumbers) return route.fulfill({ response });
    const answer = await response.json();
    answer.sky.zenith_luminance_cd_m2 /= 2;
    return route.fulfill({ response, json: answer });
  });
}

/** Another scene of the place lies left of the split, on the map and in the sky, and a sentence says what changed. */
test("another year is compared beside this one", async () => {
  for (const device of [DESKTOP, { ...PHONE, locale: "de-DE" }]) {
    const opened = await openPage(browser, "", device);
    const { page, context, asked } = opened;
    await withEarlierYear(page);
    await page.goto("about:blank");
    await page.goto(`${process.env.SKYGLOW_URL}/${fragment(here.beside)}`);
    await skyShown(page);
    assert.ok(await page.locator("#split-field").isHidden());
    await page.selectOption("#beside", "demo-2012");
    await page.waitForSelector("#beside-told:not([hidden])");
    await skyShown(page);
    const told = await page.locator("#beside-told").textContent();
    assert.match(told, device === DESKTOP ? /brighter by 100 % than in “2012”/ : /um 100 % heller als in „2012“/);
    assert.ok(await page.locator("#split-field").isVisible());
    const labels = await page.locator("#split-field span").allTextContents();
    assert.deepEqual(labels, ["2012", "2023"]);
    assert.equal(inLink(page, "beside"), "demo-2012");
    for (const path of ["panorama.sky", "tiles/radiance/tilejson.json"])
      assert.ok(
        asked.some((url) => url.startsWith(`scenes/demo-2012/${path}`)),
        path,
      );
    await page.waitForSelector(".swipe-map");
    await page.waitForTimeout(1000);
    await shot(page, device === DESKTOP ? "years" : "years-phone");
    await page.reload();
    await page.waitForSelector("#beside-told:not([hidden])");
    await skyShown(page);
    assert.equal(await page.inputValue("#beside"), "demo-2012");
    await page.selectOption("#beside", "");
    await skyShown(page);
    assert.ok(await page.locator("#split-field").isHidden());
    assert.equal(inLink(page, "beside"), null);
    assertNoFaults(opened);
    await context.close();
  }
});

test("one scene needs no choice of scenes", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  const scenes = await getJson("scenes");
  assert.equal(await page.locator(".scene-field").isVisible(), scenes.length > 1);
  assertNoFaults(opened);
  await context.close();
});

/** A server without scenes says how one is added, and offers no place, plan or paint. */
test("an empty server offers no place", async () => {
  const context = await browser.newContext(DESKTOP);
  await context.route("**/api/v1/scenes", (route) => route.fulfill({ json: [] }));
  const page = await context.newPage();
  await page.goto(`${process.env.SKYGLOW_URL}/`);
  await page.waitForSelector("#map[data-basemap]");
  await page.getByRole("button", { name: "Close this message" }).click();
  await page.fill("#search", "46, 8");
  await page.press("#search", "Enter");
  await page.getByRole("alert").getByText("no scene yet").waitFor();
  assert.equal(await page.locator(".pin").count(), 0);
  assert.ok((await page.locator("#plan-card").isHidden()) && (await page.locator("#paint-card").isHidden()));
  await context.close();
});

/** The search asks for the world's places when typing rests, says which scene has each, and one that none has is told so. */
test("the search finds places of the world", async () => {
  const context = await browser.newContext(DESKTOP);
  const nordheim = await withNorth(context);
  const [west, south] = here.scene.bounds;
  const found = [
    { ...nordheim, name: "Worldham", country: "NO", scene: "north", latitude_deg: nordheim.latitude_deg - 1 },
    { name: "World's End", country: "AU", scene: null, latitude_deg: south - 20, longitude_deg: west, population: 1200 },
  ];
  const asked = [];
  await context.route("**/api/v1/places?*", (route) => {
    asked.push(new URL(route.request().url()).searchParams.get("name"));
    return route.fulfill({ json: found });
  });
  const page = await context.newPage();
  await page.goto(`${process.env.SKYGLOW_URL}/${fragment(here.town)}`);
  await skyShown(page);
  // All letters before the viewer can ask, however slow the machine.
  await page.locator("#search").evaluate((search) => {
    search.focus();
    for (const letters of ["w", "wo", "wor", "worl", "world"]) {
      search.value = letters;
      search.dispatchEvent(new InputEvent("input", { bubbles: true }));
    }
  });
  const options = page.locator("#search-list").getByRole("option");
  await options.filter({ hasText: "World's End" }).waitFor();
  assert.deepEqual(await options.allTextContents(), [
    "WorldhamNorway · The measured north",
    "World's EndAustralia · no scene covers it",
  ]);
  assert.deepEqual(asked, ["world"]);
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  assert.match(await page.locator("#notice").textContent(), /No scene of this server covers World's End/);
  assert.equal(inLink(page, "scene"), here.scene.id);
  await page.fill("#search", "worldh");
  await options.filter({ hasText: "Worldham" }).click();
  await page.waitForFunction(() => location.hash.includes("scene=north"));
  await skyShown(page);
  await context.close();
});
