// What four kinds of people come for, as few steps as it takes them: a step is a click, a key that is pressed, a text that is typed or a
// drag. Tells the steps and how long the answers took, and keeps a picture of every end in the folder of SKYGLOW_SHOTS.
//   SKYGLOW_SHOTS=shots scripts/browser_tests.sh node journeys.mjs
import { launch, openPage, PHONE, setSlider, shot, skyShown } from "./support/browser.mjs";
import { demo } from "./support/sky.mjs";

const browser = await launch();
const { scene, town, beside } = await demo();
const still = { reducedMotion: "reduce" };
const report = [];

/** One journey: `act` gets what counts steps, each with what waits for its answer. */
async function journey(name, device, act) {
  const { page, context, faults } = await openPage(browser, "", { isTonight: true, ...device });
  const ends = [];
  let steps = 0;
  const step = async (what, then) => {
    steps += 1;
    const start = performance.now();
    await what();
    await then?.();
    return performance.now() - start;
  };
  const end = async (what, ms) => {
    await page.waitForTimeout(600);
    await shot(page, `${name}-${ends.length + 1}`);
    ends.push(`${what}: ${steps}${ms === undefined ? "" : ` (last ${Math.round(ms)} ms)`}`);
  };
  await act(page, step, end);
  report.push(`${name}: ${ends.join("; ")}${faults.length > 0 ? `; FAULTS ${faults.join(" | ")}` : ""}`);
  await context.close();
}

/** Takes a step that sets the time, to another than the one before. */
function atOtherTime(page, step, act) {
  const timeOf = () => new URLSearchParams(location.hash.slice(1)).get("time");
  return step(async () => {
    const before = await page.evaluate(timeOf);
    await act();
    // The best hour may be the one that is shown.
    await page
      .waitForFunction((before) => new URLSearchParams(location.hash.slice(1)).get("time") !== before, before, { timeout: 4000 })
      .catch(() => {});
  });
}

/** Types a town's name and takes the first that is found. */
async function search(page, step, name) {
  await step(
    () => page.fill("#search", name),
    () => page.waitForSelector("#search-list li"),
  );
  return step(
    () => page.press("#search", "Enter"),
    () => skyShown(page),
  );
}

await journey("public", PHONE, async (page, step, end) => {
  const ms = await search(page, step, town.name);
  await page.waitForFunction(() => /%/.test(document.querySelector("#summary").textContent));
  await end("how dark is it at home", ms);
  await page.waitForSelector("#shares-list button");
  await page.locator("#shares").scrollIntoViewIfNeeded();
  await end("whose light");
  await page.waitForSelector("#night-best:not(:empty)");
  await atOtherTime(page, step, () => page.locator("#time-best").tap());
  await skyShown(page);
  await page.locator("#time-line").scrollIntoViewIfNeeded();
  await end("when tonight");
  const found = await step(
    () => page.locator("#darker summary").tap(),
    () => page.waitForSelector("#darker-list li", { timeout: 60_000 }),
  );
  await page.locator("#darker-list").scrollIntoViewIfNeeded();
  await end("where is it darker", found);
});

await journey("planner", { viewport: { width: 1366, height: 650 }, ...still }, async (page, step, end) => {
  await search(page, step, town.name);
  await page.waitForSelector("#bench-where input:checked");
  await end("whose light our sky is");
  await step(() => page.selectOption("#bench-to", "pc_amber"));
  await step(() => page.selectOption("#bench-shielding", "full_cutoff"));
  await step(() => setSlider(page, "bench-dimmed", 30));
  const ms = await step(
    () => page.click("#bench-apply"),
    () => page.waitForSelector("#bench-answer table"),
  );
  await skyShown(page);
  await page.locator("#bench-card").scrollIntoViewIfNeeded();
  await end("other lamps, before and after", ms);
  await step(
    () => page.click("#report-open"),
    () => page.waitForSelector("#report .paper"),
  );
  await page.waitForFunction(() => [...document.querySelectorAll("#report img")].every(({ complete }) => complete));
  await end("a report for the council");
});

await journey("observatory", { viewport: { width: 1440, height: 900 }, ...still }, async (page, step, end) => {
  const { latitude_deg, longitude_deg } = beside;
  await step(
    () => page.fill("#search", `${latitude_deg}, ${longitude_deg}`),
    () => page.waitForSelector("#search-list li"),
  );
  await step(
    () => page.press("#search", "Enter"),
    () => skyShown(page),
  );
  await atOtherTime(page, step, () => page.click("#time-weekend"));
  await skyShown(page);
  await end("the next dark weekend");
  await step(() => page.click("#mark"));
  const box = await page.locator(".sky-overlay").boundingBox();
  const ms = await step(
    async () => {
      const at = (x, y) => [box.x + x * box.width, box.y + y * box.height];
      await page.mouse.move(...at(0.3, 0.5));
      await page.mouse.down();
      for (const [x, y] of [
        [0.45, 0.5],
        [0.45, 0.8],
        [0.3, 0.8],
        [0.3, 0.5],
      ])
        await page.mouse.move(...at(x, y), { steps: 4 });
      await page.mouse.up();
    },
    () => page.waitForFunction(() => location.hash.includes("region=")),
  );
  await page.waitForFunction(() => document.querySelector("#shares-waiting").textContent === "");
  await end("whose light in that part of the sky", ms);
  await step(() => page.click("#pin"));
  await search(page, step, town.name);
  await step(
    () => page.click("#pin"),
    () => page.waitForFunction(() => document.querySelectorAll("#compare img").length >= 2),
  );
  await page.waitForFunction(() => [...document.querySelectorAll("#compare img")].every(({ complete }) => complete));
  await page.locator("#compare").scrollIntoViewIfNeeded();
  await end("two sites side by side");
});

await journey("newsroom", { viewport: { width: 3840, height: 2160 }, ...still }, async (page, step, end) => {
  await search(page, step, town.name);
  await page.waitForSelector("#night-best:not(:empty)");
  await atOtherTime(page, step, () => page.click("#time-best"));
  await skyShown(page);
  await end("tonight's sky");
  await step(
    () => page.click("#plan-find"),
    () => page.waitForSelector("#plan-status .plan-reached"),
  );
  await skyShown(page);
  await end("what would make it a third darker");
  await step(() => page.selectOption("#save-size", "4k"));
  const [, picture] = await Promise.all([page.waitForEvent("download"), step(() => page.click("#save-picture"))]);
  const both = await Promise.all([page.waitForEvent("download"), step(() => page.click("#save-both"))]);
  await end("a 4K picture and before and after", Math.max(picture, both[1]));
});

console.log(`scene ${scene.id}`);
console.log(report.join("\n"));
await browser.close();
