// The time line: the night over a place, and the sky at one of its hours.
import assert from "node:assert/strict";
import { test } from "node:test";
import { assertNoFaults, DESKTOP, getJson, openPage, PHONE, shot, skyShown } from "./support/browser.mjs";
import { skyPath } from "./support/sky.mjs";
import { browser, fragment, here, inLink } from "./support/stage.mjs";

const text = (page, key) => page.locator(`[data-value=${key}]`).textContent();
const told = (page) => page.locator("#time-told").textContent();
/** A place that lies two hours from UTC by the Sun would be told in another clock than the browser's. */
const IN_UTC = { ...DESKTOP, timezoneId: "UTC" };
const NEW_MOON = "2026-08-12T23:00:00Z";

async function totalShown(page, { sky }) {
  const expected = sky.zenith_total_brightness_mag_arcsec2.toFixed(2);
  await page.waitForFunction((value) => document.querySelector("[data-value=zenith_total_mag]")?.textContent === value, expected);
}

/** A link with a time shows the API's numbers for it, all light first, and its components in a fold. */
test("a time shows the sky of that time", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&time=2026-08-12T23:00Z"), IN_UTC);
  const { page, context, asked } = opened;
  await skyShown(page);
  const answer = await getJson(skyPath(here.scene, "sky", here.beside, `&time=${NEW_MOON}`));
  await totalShown(page, answer);
  assert.equal(await text(page, "zenith_mag"), answer.sky.zenith_brightness_mag_arcsec2.toFixed(2));
  assert.match(await text(page, "stars"), new RegExp(`^${answer.night_sky.stars.visible.toLocaleString("en")} of `));
  await page.locator("#night-sky summary").click();
  const airglow = answer.night_sky.components.find(({ component }) => component === "airglow");
  assert.match(await text(page, "component_airglow"), new RegExp(`^${airglow.zenith_brightness_mag_arcsec2.toFixed(2)} `));
  assert.equal(await told(page), "23:00 UTC: night");
  assert.equal(await page.inputValue("#night-date"), "2026-08-12");
  // The picture is of the time too.
  const pictures = () => asked.filter((path) => /panorama\.sky/.test(path)).length;
  const before = pictures();
  await page.getByRole("button", { name: "No time" }).click();
  await totalShown(page, await getJson(skyPath(here.scene, "sky", here.beside)));
  assert.equal(inLink(page, "time"), null);
  assert.equal(await page.locator("#night-sky").count(), 0);
  await skyShown(page);
  assert.equal(pictures(), before + 1);
  await shot(page, "time");
  assertNoFaults(opened);
  await context.close();
});

/** The Sun's light is no matter of lamps: by day there is no class and no star. */
test("by day there is no class of the sky", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&time=2026-08-12T11:00Z"), IN_UTC);
  const { page, context } = opened;
  await skyShown(page);
  assert.equal(await text(page, "bortle_class"), "–");
  assert.match(await page.locator(".bortle-name").textContent(), /by day/);
  assert.doesNotMatch(await page.locator("#numbers").textContent(), /naked eye/);
  assertNoFaults(opened);
  await context.close();
});

/** The line reaches from sunset to sunrise, and keys move the time along it. */
test("the time moves along the night by keys", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&time=2026-08-12T23:00Z"), IN_UTC);
  const { page, context } = opened;
  await skyShown(page);
  const { latitude_deg, longitude_deg } = here.beside;
  const night = await getJson(`night?lat=${latitude_deg}&lon=${longitude_deg}&date=2026-08-12`);
  const slider = page.getByRole("slider", { name: "Time of the night" });
  const minutes = (utc) => Date.parse(utc) / 60_000;
  assert.equal(Number(await slider.getAttribute("min")), Math.ceil(minutes(night.sun.set_utc)));
  assert.equal(Number(await slider.getAttribute("max")), Math.floor(minutes(night.sun.rise_utc)));
  await slider.focus();
  await page.keyboard.press("Home");
  await page.waitForFunction(() => /civil twilight/.test(document.querySelector("#time-told").textContent));
  assert.match(await slider.getAttribute("aria-valuetext"), /UTC: civil twilight/);
  await page.waitForFunction(() => !location.hash.includes("T23:00Z"));
  const sunset = inLink(page, "time");
  assert.ok(Math.abs(minutes(sunset) - minutes(night.sun.set_utc)) <= 1);
  for (let i = 0; i < 6; i++) await page.keyboard.press("ArrowRight");
  await page.waitForFunction(
    (from) => (Date.parse(new URLSearchParams(location.hash.slice(1)).get("time")) - Date.parse(from)) / 60_000 === 30,
    sunset,
  );
  assertNoFaults(opened);
  await context.close();
});

/** Another date keeps the hour; without a time it is the middle of the night. The best hour is in the server's dark part. */
test("another night keeps the hour", async () => {
  const opened = await openPage(browser, fragment(here.beside), IN_UTC);
  const { page, context } = opened;
  await skyShown(page);
  assert.match(await told(page), /^No time/);
  assert.equal(await page.getByRole("button", { name: "No time" }).getAttribute("aria-pressed"), "true");
  await page.fill("#night-date", "2026-12-08");
  await page.waitForFunction(() => location.hash.includes("time=2026-12-08T23:"));
  await page.fill("#night-date", "2026-12-10");
  await page.waitForFunction(() => location.hash.includes("time=2026-12-10T23:"));
  const { latitude_deg, longitude_deg } = here.beside;
  const night = await getJson(`night?lat=${latitude_deg}&lon=${longitude_deg}&date=2026-12-10`);
  await page.getByText(`Dark for ${Math.floor(night.dark_hours)} h`).waitFor();
  await page.getByRole("button", { name: "Best hour" }).click();
  await page.waitForFunction(
    (dark) =>
      dark.some(([from, until]) => {
        const time = Date.parse(new URLSearchParams(location.hash.slice(1)).get("time"));
        return time > from && time < until;
      }),
    night.dark_intervals.map(({ from_utc, until_utc }) => [Date.parse(from_utc), Date.parse(until_utc)]),
  );
  await page.getByRole("button", { name: "Now" }).click();
  await page.waitForFunction(
    () => Math.abs(Date.parse(new URLSearchParams(location.hash.slice(1)).get("time")) - Date.now()) < 120_000,
  );
  await skyShown(page);
  assertNoFaults(opened);
  await context.close();
});

/** Times are told by a clock that can be that of the place, in the words of the page's language. */
test("times are told by a clock of the place", async () => {
  const german = { ...DESKTOP, locale: "de-DE", timezoneId: "America/Los_Angeles" };
  const opened = await openPage(browser, fragment(here.beside, "&time=2026-08-12T23:00Z"), german);
  const { page, context } = opened;
  await skyShown(page);
  const offset = Math.round(here.beside.longitude_deg / 15);
  assert.equal(
    await told(page),
    `${String(23 + offset)
      .padStart(2, "0")
      .replace("24", "00")}:00 UTC+${offset}: Nacht`,
  );
  assert.match(await page.locator("#summary").textContent(), /Man sieht etwa/);
  assertNoFaults(opened);
  await context.close();
});

/** A finger on the line sets the time, without scrolling sideways. */
test("a finger sets the time", async () => {
  const opened = await openPage(browser, fragment(here.beside, "&time=2026-08-12T23:00Z"), { ...PHONE, timezoneId: "UTC" });
  const { page, context } = opened;
  await skyShown(page);
  const slider = page.locator("#time");
  await slider.scrollIntoViewIfNeeded();
  const { width, height } = await slider.boundingBox();
  assert.ok(height >= 32, `${height} px high`);
  await slider.tap({ position: { x: width * 0.97, y: height / 2 } });
  await page.waitForFunction(() => /twilight/.test(document.querySelector("#time-told").textContent));
  await page.waitForFunction(() => /time=2026-08-13T0[34]:/.test(location.hash));
  await skyShown(page);
  assert.match(await page.locator("#summary").textContent(), /^Twilight: the Sun is \d+° below the horizon/);
  await shot(page, "time-phone");
  assertNoFaults(opened);
  await context.close();
});

/** The curve of the night comes after the sky, with the best hour that the API has; its button goes there. */
test("the best hour of the night is shown", async () => {
  for (const device of [IN_UTC, { ...PHONE, timezoneId: "UTC" }]) {
    const opened = await openPage(browser, fragment(here.beside, "&time=2026-08-12T20:30Z"), device);
    const { page, context, asked } = opened;
    await page.waitForSelector("#night-curve .curve-best");
    const { best_hour, hours } = await getJson(skyPath(here.scene, "night", here.beside, "&date=2026-08-12"));
    const best = hours.find(({ time }) => time === best_hour);
    const clock = best_hour.slice(11, 16);
    const mag = best.zenith_total_brightness_mag_arcsec2.toFixed(1);
    assert.equal(
      await page.locator("#night-best").textContent(),
      `Best at ${clock}: ${mag} mag/arcsec² overhead under a clear sky.`,
    );
    await page.getByRole("button", { name: "Best hour" }).click();
    await page.waitForFunction((time) => location.hash.includes(`time=${time}`), best_hour.slice(0, 16));
    await skyShown(page);
    // The mark of the best hour stands over the slider's thumb.
    const mark = await page.locator(".curve-best").boundingBox();
    const track = await page.locator("#night-parts").boundingBox();
    const { min, max, value } = await page.$eval("#time", ({ min, max, value }) => ({ min, max, value }));
    const thumb = track.x + (track.width * (value - min)) / (max - min);
    assert.ok(Math.abs(mark.x + mark.width / 2 - thumb) < 4, `${mark.x} for ${thumb}`);
    const order = (part) => asked.findIndex((path) => path.includes(part));
    assert.ok(order(`${here.scene.id}/night?`) > order("/panorama.sky?"));
    // Another hour of the same night asks for nothing new.
    assert.equal(asked.filter((path) => path.includes(`${here.scene.id}/night?`)).length, 1);
    await shot(page, device === IN_UTC ? "night-hours" : "night-hours-phone");
    assertNoFaults(opened);
    await context.close();
  }
});
