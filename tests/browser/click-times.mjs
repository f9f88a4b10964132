// How long after a click the place, the numbers and the picture of its sky are there, each time at another place.
//   scripts/browser_tests.sh node click-times.mjs [clicks]
import { launch, openPage, skyShown } from "./support/browser.mjs";
import { demo } from "./support/sky.mjs";

const clicks = Number(process.argv[2] ?? 30);
const browser = await launch();
try {
  const { scene, beside } = await demo();
  const { page } = await openPage(browser, `#scene=${scene.id}&map=8/${beside.latitude_deg}/${beside.longitude_deg}`);
  const box = await page.locator("#map").boundingBox();
  const steps = { site: [], numbers: [], picture: [] };
  for (let i = 0; i <= clicks; i++) {
    await page.evaluate(() => performance.clearMeasures());
    // A spiral around the middle of what stays of the map when the sky takes its half, below the panel of layers.
    const [angle, radius] = [2.4 * i, 8 * Math.sqrt(i)];
    await page.mouse.click(box.x + box.width / 4 + radius * Math.cos(angle), box.y + 430 + radius * Math.sin(angle));
    await page.waitForFunction(() => performance.getEntriesByName("sky:picture").length > 0);
    await skyShown(page);
    const times = await page.evaluate(() =>
      performance.getEntriesByType("measure").map(({ name, duration }) => [name.slice("sky:".length), duration]),
    );
    // The first brings the sky's part of the page.
    if (i > 0) for (const [name, durationMs] of times) steps[name]?.push(durationMs);
    // Tiles of the last move are none of this click's.
    await page.waitForTimeout(400);
  }
  for (const [name, timesMs] of Object.entries(steps)) {
    const sorted = timesMs.toSorted((a, b) => a - b);
    const at = (part) => Math.round(sorted[Math.floor(part * (sorted.length - 1))]);
    console.log(`${name.padEnd(8)} median ${at(0.5)} ms, 90 % ${at(0.9)} ms, slowest ${at(1)} ms of ${sorted.length}`);
  }
} finally {
  await browser.close();
}
