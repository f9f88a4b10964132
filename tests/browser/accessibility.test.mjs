// WCAG 2.2 AA as far as axe can tell, in every state that a person meets, on a desktop and on a phone.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";
import { DESKTOP, openPage, PHONE, skyShown } from "./support/browser.mjs";
import { browser, here } from "./support/stage.mjs";

const axeSource = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];

/** What axe finds wrong, a line each. */
async function violations(page) {
  await page.evaluate(axeSource);
  const found = await page.evaluate((values) => globalThis.axe.run(document, { runOnly: { type: "tag", values } }), RULES);
  assert.ok(found.passes.length > 20, `axe looked at ${found.passes.length} rules alone`);
  return found.violations.flatMap(({ id, help, nodes }) =>
    nodes.map(({ target, failureSummary }) => `${id}: ${help}: ${target.join(" ")}: ${failureSummary}`),
  );
}

for (const [name, device] of [
  ["desktop", DESKTOP],
  ["phone", PHONE],
]) {
  test(`axe finds nothing wrong on a ${name}`, async () => {
    const opened = await openPage(browser, "", device);
    const { page, context } = opened;
    assert.deepEqual(await violations(page), [], "the map alone");
    const { latitude_deg, longitude_deg } = here.beside;
    await page.fill("#search", `${latitude_deg}, ${longitude_deg}`);
    await page.press("#search", "Enter");
    await skyShown(page);
    await page.waitForSelector("#shares-list button");
    await page.click("#shares summary");
    await page.click("#darker summary");
    await page.waitForSelector("#darker-list button");
    await page.waitForSelector("#night-curve svg");
    await page.click("#pin");
    await page.waitForSelector("#compare dd");
    assert.deepEqual(await violations(page), [], "a sky with its numbers, lights and darker places");
    await page.click("#plan-find");
    await page.waitForSelector("#plan-status .plan-reached");
    await page.click("#paint-draw");
    await page.click("#mark");
    await page.click("#projection button[value=fisheye]");
    await skyShown(page);
    assert.deepEqual(await violations(page), [], "a plan, painting and marking");
    await page.click("#report-open");
    await page.waitForSelector("#report .change .lead");
    assert.deepEqual(await violations(page), [], "a report");
    await page.keyboard.press("Escape");
    await page.waitForSelector("#report", { state: "hidden" });
    await page.evaluate(() => {
      location.hash = location.hash.replace(/lat=[^&]*/, "lat=-80");
    });
    await page.waitForSelector("#notice:not([hidden])");
    assert.deepEqual(await violations(page), [], "an error");
    // And it would find something.
    await page.$eval(".language-field", (label) => label.replaceWith(...label.querySelectorAll("select")));
    assert.equal((await violations(page)).length, 1);
    await context.close();
  });
}
