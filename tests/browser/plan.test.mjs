// What to dim: a plan is found for the picked place, its sky is shown beside today's, and a link brings both back.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, getJson, numbersShown, openPage, PHONE, setSlider, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

async function findPlan(page) {
  await page.click("#plan-find");
  await page.waitForSelector("#plan-status .plan-reached");
}

/** At a time the plan's card has the numbers of the picture, before and after. */
test("a plan at a time has that time's numbers", async () => {
  const time = "&time=2026-08-12T23:00:00Z";
  const opened = await openPage(browser, fragment(here.beside, time));
  const { page, context } = opened;
  await skyShown(page);
  await findPlan(page);
  const lights = `&lamp=mixed&emission=modern_city${time}`;
  const of = async (more) => (await getJson(skyPath(here.scene, "sky", here.beside, `${lights}${more}`))).sky;
  const [before, after] = [await of(""), await of(`&scenario=${inLink(page, "scenario")}`)];
  const limits = [before, after].map((sky) => sky.naked_eye_limit_mag.toFixed(2));
  await page.waitForFunction(
    (limits) => limits.every((limit) => document.querySelector("#plan-answer")?.textContent.includes(limit)),
    limits,
  );
  assertNoFaults(opened);
  await context.close();
});

/** A plan makes the zenith as much darker as wished, says whose light goes, and can be left again. */
test("a plan makes the zenith darker", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context, asked } = opened;
  await skyShown(page);
  assert.ok(await page.locator("#lights").isHidden(), "there is nothing to compare yet");
  await setSlider(page, "plan-reduction", 40);
  assert.equal(await page.locator("#plan-reduction-value").textContent(), "40 %");
  await findPlan(page);
  const id = inLink(page, "scenario");
  const plan = await getJson(`plans/${id}?limit=5000`);
  const [site] = plan.sites;
  assert.ok(Math.abs(site.reduced_by - 0.4) < 1e-3, `${site.reduced_by}`);
  assert.equal(Number(await page.locator(".plan-reached").getAttribute("data-reduced-by")), site.reduced_by);
  // The sky is the plan's, then today's, then the plan's again.
  await numbersShown(page, site.sky_after);
  await skyShown(page);
  const names = here.places.map(({ name }) => name);
  const towns = await page.locator("#plan-answer .towns li span").allTextContents();
  assert.ok(towns.length > 0 && towns.slice(0, 6).every((town) => names.includes(town)), `${towns}`);
  const parts = (await page.locator("#plan-answer .towns li b").allTextContents()).map((part) =>
    Number.parseFloat(part.replace("<", "")),
  );
  const listed = plan.pixels.reduce((sum, { effect }) => sum + effect, 0);
  assert.ok(Math.abs(parts.reduce((a, b) => a + b) - 100 * listed) < 3, `${parts} of ${listed}`);
  await shot(page, "plan");
  await page.click("#lights button[value=today]");
  const today = (await getJson(skyPath(here.scene, "sky", here.beside, "&lamp=mixed&emission=modern_city"))).sky;
  await numbersShown(page, today);
  assert.match(page.url(), /lights=today/);
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  await numbersShown(page, site.sky_after);
  // Both side by side: left of the split is today's sky, right of it the plan's.
  const strip = () =>
    page.$eval(".sky-picture", (canvas) => {
      const context = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
      context.drawImage(canvas, 0, 0);
      const column = (part) => [
        ...context.getImageData(Math.round(part * canvas.width), Math.round(0.3 * canvas.height), 1, 1).data,
      ];
      return [column(0.27), column(0.73)];
    });
  const [, right] = await strip();
  await page.click("#lights button[value=both]");
  await page.waitForSelector("#split-field:not([hidden])");
  await skyShown(page);
  const half = await strip();
  await shot(page, "plan-both");
  // So does the map, by a line of its own.
  const maps = () => page.locator("#map canvas.maplibregl-canvas").count();
  assert.equal(await maps(), 2);
  // Whose light it is, is asked of both.
  await page.locator("#layer-influence").check();
  await page.waitForSelector("#layer-note-influence[data-state=shown]");
  const influences = () =>
    asked.filter((path) => /tiles\/influence\/tilejson/.test(path)).map((path) => path.includes(`scenario=${id}`));
  for (let tries = 0; influences().length < 2; tries++) {
    assert.ok(tries < 50, `${influences()}`);
    await page.waitForTimeout(100);
  }
  assert.deepEqual(new Set(influences()), new Set([true, false]));
  await page.locator("#layer-influence").uncheck();
  await page.waitForLoadState("networkidle");
  const line = await page.locator(".swipe-handle").boundingBox();
  await page.mouse.move(line.x + line.width / 2, line.y + line.height / 2);
  await page.mouse.down();
  await page.mouse.move(line.x + line.width / 2 + 60, line.y + line.height / 2, { steps: 4 });
  await page.mouse.up();
  assert.ok(Number(await page.locator("#split").inputValue()) > 60);
  assert.equal(
    await page.$eval(".swipe-map", ({ style }) => Math.round(100 - Number.parseFloat(style.clipPath.split(" ")[1]))),
    Number(await page.locator("#split").inputValue()),
  );
  await page.waitForFunction(() => /split=0\.[67]/.test(location.hash));
  await setSlider(page, "split", 100);
  // The picture that is read is drawn when the split rests.
  let whole = await strip();
  for (let tries = 0; tries < 40 && `${whole[1]}` === `${right}`; tries++) {
    await page.waitForTimeout(50);
    whole = await strip();
  }
  assert.deepEqual(half[1], right);
  assert.deepEqual(half[0], whole[0]);
  assert.notDeepEqual(whole[1], right, "today's sky is no brighter than the plan's");
  await page.click("#lights button[value=changed]");
  await skyShown(page);
  assert.equal(await maps(), 1);
  // A link or a reload has it all, the wish too.
  await setSlider(page, "plan-reduction", 10);
  await page.reload();
  await page.waitForSelector("#plan-status .plan-reached");
  await numbersShown(page, site.sky_after);
  assert.equal(await page.locator("#plan-reduction").inputValue(), "40");
  const files = await page.locator("#plan-answer .links a").evaluateAll((links) => links.map(({ href }) => href));
  assert.equal(files.length, 4);
  for (const file of files) assert.equal((await fetch(file)).status, 200, file);
  await page.click("#plan-drop");
  await numbersShown(page, today);
  assert.ok(!page.url().includes("scenario"));
  assert.equal(await page.locator("#plan-answer").textContent(), "");
  assertNoFaults(opened);
  await context.close();
});

/** Until the link names other lights than these; which. */
async function changedFrom(page, known) {
  await page.waitForFunction(
    (known) => /scenario=p-/.test(location.hash) && !known.some((id) => location.hash.includes(id)),
    known,
  );
  return page.evaluate(() => new URLSearchParams(location.hash.slice(1)).get("scenario"));
}

/** Ids of the plans that a page had kept, as they come. */
function keptBy(page) {
  const kept = [];
  page.on("response", async (response) => {
    if (response.request().method() === "POST" && /plans\?.*keep=on/.test(response.url()) && response.status() === 201)
      kept.push((await response.json()).id);
  });
  return kept;
}

async function until(isSo, why) {
  for (let tries = 0; !isSo(); tries++) {
    assert.ok(tries < 100, why);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

/** Sliders of influence change the sky as they move, and what they rest on is kept. */
test("sliders of influence change the sky live", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context, asked } = opened;
  const kept = keptBy(page);
  await skyShown(page);
  const steps = await page.evaluate(() => history.length);
  await page.getByRole("radio", { name: "By influence" }).click();
  assert.ok(await page.locator("#plan-target").isHidden());
  const shown = [];
  for (const gamma of [40, 60, 80]) {
    await setSlider(page, "plan-gamma", gamma);
    shown.push(await changedFrom(page, shown));
    await skyShown(page);
  }
  assert.ok(asked.filter((path) => /plans\?.*keep=off/.test(path)).length >= 3);
  // The last is kept after a while, and whatever the sliders rested on; what they went through is not: that is no
  // step of the way back either.
  const last = shown.at(-1);
  await until(() => kept.includes(last), "it is never kept");
  assert.ok(
    kept.every((id) => shown.includes(id)),
    `${kept}`,
  );
  assert.equal((await page.evaluate(() => history.length)) - steps, kept.length);
  const plan = await getJson(`plans/${last}?limit=0`);
  assert.deepEqual(plan.threshold_levels, ["p90", "p98"]);
  await numbersShown(page, plan.sites[0].sky_after);
  await shot(page, "plan-threshold");
  // Neither slider goes past the other, and a reload has them again.
  await setSlider(page, "plan-least", 99.5);
  assert.equal(await page.locator("#plan-most").inputValue(), "99.5");
  const finer = await changedFrom(page, shown);
  await until(() => kept.includes(finer), "it is never kept");
  await page.reload();
  await page.waitForSelector("#plan-status .plan-reached");
  assert.deepEqual(await page.$$eval("#plan-least, #plan-most, #plan-gamma", (sliders) => sliders.map(({ value }) => value)), [
    "99.5",
    "99.5",
    "80",
  ]);
  assertNoFaults(opened);
  await context.close();
});

/** What is only tried is kept before anything goes on from it, and never comes back over what was chosen since. */
test("a trial plan is stored before it is used", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  const kept = keptBy(page);
  await skyShown(page);
  await page.getByRole("radio", { name: "By influence" }).click();
  // Another lamp, at once: the plan that the link names is kept.
  await setSlider(page, "plan-gamma", 35);
  const first = await changedFrom(page, []);
  await page.selectOption("#lamp", "hps");
  await until(() => kept.includes(first), "it is never kept");
  await skyShown(page);
  assert.equal(await page.evaluate(() => new URLSearchParams(location.hash.slice(1)).get("scenario")), first);
  // Today's lights, at once: they stay.
  await setSlider(page, "plan-gamma", 40);
  const tried = await changedFrom(page, [first]);
  await page.click("#lights button[value=today]");
  await until(() => kept.includes(tried), "it is never kept");
  await page.waitForTimeout(300);
  assert.match(await page.evaluate(() => location.hash), /lights=today/);
  await page.click("#lights button[value=changed]");
  // A stroke, at once, goes on from it.
  await setSlider(page, "plan-gamma", 45);
  const second = await changedFrom(page, [first, tried]);
  await page.click("#paint-draw");
  await page.focus("#map canvas");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => location.hash.includes("scenario=s-"));
  assert.equal((await getJson(`scenarios/${inLink(page, "scenario")}`)).base, second);
  await page.click("#paint-draw");
  // Back to today, at once: no plan comes after that.
  await skyShown(page);
  await setSlider(page, "plan-gamma", 55);
  await changedFrom(page, [first, tried, second]);
  await setSlider(page, "plan-gamma", 65);
  await page.click("#plan-drop");
  await page.waitForTimeout(2500);
  assert.ok(!(await page.evaluate(() => location.hash)).includes("scenario="), page.url());
  assertNoFaults(opened);
  await context.close();
});

/** A plan that cannot reach what is wished says why and shows the best there is. */
test("an unreachable target is explained", async () => {
  const opened = await openPage(browser, fragment(here.beside));
  const { page, context } = opened;
  await skyShown(page);
  await setSlider(page, "plan-reduction", 90);
  await setSlider(page, "plan-cut", 50);
  // What only changes how things look stops no search.
  await page.click("#plan-find");
  await page.selectOption("#colours", "viridis");
  await page.waitForSelector("#plan-status .plan-reached");
  assert.match(
    (await page.locator("#plan-status .warning").textContent()) ?? "",
    /^90 % is out of reach: .* it gets 50 % darker\.$/,
  );
  assert.ok(Math.abs(Number(await page.locator(".plan-reached").getAttribute("data-reduced-by")) - 0.5) < 1e-3);
  assertNoFaults(opened);
  await context.close();
});

/** A link to a plan that is no longer kept is said to be one, and today's sky is shown. */
test("a link to a lost plan shows today's sky", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&scenario=p-00000000000000000000"));
  const { page, context } = opened;
  await page.waitForSelector("#notice:not([hidden])");
  await page.waitForFunction(() => !location.hash.includes("scenario"));
  await skyShown(page);
  assert.ok(await page.locator("#lights").isHidden());
  await context.close();
});

test("a plan is found by keyboard on a phone's page", async () => {
  const opened = await openPage(browser, fragment(here.beside), PHONE);
  const { page, context } = opened;
  await skyShown(page);
  await page.focus("#plan-reduction");
  await page.keyboard.press("ArrowLeft");
  assert.equal(await page.locator("#plan-reduction-value").textContent(), "25 %");
  await page.focus("#plan-find");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#plan-status .plan-reached");
  await page.locator("#plan-card").scrollIntoViewIfNeeded();
  await shot(page, "plan-phone");
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= PHONE.viewport.width, `the page is ${wide} px wide`);
  assertNoFaults(opened);
  await context.close();
});
