// The orders of scattering: said with every sky, and chosen where the server has tables of both kinds.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { assertNoFaults, getJson, openPage, SERVER, skyShown } from "./support/browser.mjs";
import { browser, here } from "./support/stage.mjs";

const TITLES = { multiple: "any number of times", single: "once only" };

let packs;
let best;

before(async () => {
  packs = await getJson("atmospheres");
  best = packs.some(({ scattering }) => scattering === "multiple") ? "multiple" : "single";
});

const fragment = (more = "") => `#scene=${here.scene.id}&lat=${here.beside.latitude_deg}&lon=${here.beside.longitude_deg}${more}`;
const said = (page) => page.locator("[data-value=scattering] b").textContent();

/** Makes the server look as if it had these packs: whatever is asked for, it renders what it has. */
async function pretend(page, pretended) {
  const asked = [];
  await page.route("**/api/v1/atmospheres", (route) => route.fulfill({ json: pretended }));
  await page.route(/scenes\/[^/]+\/(sky|panorama\.sky|shares|night)\?/, async (route) => {
    const url = new URL(route.request().url());
    const wanted = url.searchParams.get("scattering");
    asked.push(wanted);
    url.searchParams.delete("scattering");
    const response = await fetch(url);
    if (url.pathname.endsWith(".sky")) {
      await route.fulfill({ body: Buffer.from(await response.arrayBuffer()) });
      return;
    }
    const scattering = wanted ?? "multiple";
    const json = { ...(await response.json()), scattering, ground_albedo: scattering === "multiple" ? 0.15 : null };
    await route.fulfill({ json });
  });
  return asked;
}

/** The scattering of a sky is among its numbers, and a choice of one is none. */
test("the scattering of a sky is among its numbers", async () => {
  const opened = await openPage(browser, fragment());
  const { page, context } = opened;
  await skyShown(page);
  assert.equal(await said(page), TITLES[best]);
  const kinds = new Set(packs.map(({ scattering }) => scattering));
  const select = page.getByLabel("Scattering");
  assert.equal(await select.inputValue(), best);
  assert.equal(await select.isDisabled(), kinds.size === 1);
  assertNoFaults(opened);
  await context.close();
});

/** First-order light can be chosen, with its own turbidities, and a link restores it. */
test("first-order light can be chosen", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  const both = [
    ["single", 2],
    ["single", 3],
    ["multiple", 2],
    ["multiple", 4],
  ].map(([scattering, turbidity]) => ({ ...packs[0], scattering, turbidity }));
  const asked = await pretend(page, both);
  await page.goto(`${SERVER}/${fragment("&turbidity=3.6")}`);
  await page.reload();
  await skyShown(page);
  assert.equal(await said(page), TITLES.multiple);
  assert.match(await page.locator("[data-value=scattering]").textContent(), /albedo 0\.15/);
  assert.equal(await page.locator("#turbidity").getAttribute("max"), "4");
  await page.getByLabel("Scattering").selectOption("once only");
  await page.waitForFunction((title) => document.querySelector("[data-value=scattering] b")?.textContent === title, TITLES.single);
  assert.ok(asked.includes(null) && asked.includes("single"), `${asked}`);
  assert.match(page.url(), /turbidity=3&scattering=single/, "3.6 is beyond the packs of the first order");
  assert.equal(await page.locator("#turbidity").getAttribute("max"), "3");
  await page.reload();
  await skyShown(page);
  assert.equal(await said(page), TITLES.single);
  assert.equal(await page.getByLabel("Scattering").inputValue(), "single");
  await page.getByLabel("Scattering").selectOption("any number of times");
  await page.waitForFunction(
    (title) => document.querySelector("[data-value=scattering] b")?.textContent === title,
    TITLES.multiple,
  );
  assert.doesNotMatch(page.url(), /scattering/, "the best is what a link without it means");
  assertNoFaults(opened);
  await context.close();
});

/** A link to scattering that the server has no tables for shows what it has and says so. */
test("a link to absent scattering shows the best", async () => {
  const opened = await openPage(browser);
  const { page, context } = opened;
  await page.route("**/api/v1/atmospheres", (route) =>
    route.fulfill({ json: packs.filter(({ scattering }) => scattering === best) }),
  );
  const absent = best === "single" ? "multiple" : "single";
  // From another page: within the viewer the link would be put right at once, before the tables are asked for.
  await page.goto("about:blank");
  await page.goto(`${SERVER}/${fragment(`&scattering=${absent}`)}`);
  const alert = page.getByRole("alert").filter({ hasText: `no tables for scattering “${TITLES[absent]}”` });
  await alert.waitFor();
  await skyShown(page);
  assert.equal(await said(page), TITLES[best]);
  assert.doesNotMatch(page.url(), /scattering/);
  assertNoFaults(opened);
  await context.close();
});
