// How fast the sky is drawn while one looks around, on a page of 1440 × 900, or of SIZE=3840x2160, with the enlarged sky:
//   node frame-rate.mjs [URL …]
// Several viewers may be named, to compare them in one run: every one is measured in turn, three times. FRAGMENT is added to the link.
// Beside frames a second, which depend on what else the machine does, it tells what processor time a frame takes.
import { readdirSync, readFileSync } from "node:fs";
import { launch, openPage, SERVER, skyShown } from "./support/browser.mjs";
import { demo } from "./support/sky.mjs";

const FRAMES = Number(process.env.FRAMES ?? 120);
const ROUNDS = Number(process.env.ROUNDS ?? 3);
/** Of a clock tick of /proc. */
const TICK_MS = 10;
const [WIDTH_PX, PAGE_HEIGHT_PX] = (process.env.SIZE ?? "1440x900").split("x").map(Number);
/** The same picture of every viewer, whatever its page leaves to the sky. */
const HEIGHT_PX = Math.round(0.7112 * PAGE_HEIGHT_PX);

/** Processor time of this process's children and theirs so far, ms. */
function childrenMs() {
  const processes = readdirSync("/proc")
    .filter((name) => /^\d+$/.test(name))
    .flatMap((pid) => {
      try {
        const fields = readFileSync(`/proc/${pid}/stat`, "utf8")
          .replace(/^.*\) /s, "")
          .split(" ");
        return [{ pid: Number(pid), parent: Number(fields[1]), ms: (Number(fields[11]) + Number(fields[12])) * TICK_MS }];
      } catch {
        // It has ended.
        return [];
      }
    });
  const own = new Set([process.pid]);
  for (let before = 0; before < own.size; ) {
    before = own.size;
    for (const { pid, parent } of processes) if (own.has(parent)) own.add(pid);
  }
  return processes.reduce((sum, { pid, ms }) => (pid !== process.pid && own.has(pid) ? sum + ms : sum), 0);
}

async function measure(browser, viewer, fragment) {
  // The height of the sky is set by a style that the page's own policy would refuse.
  const device = { viewport: { width: WIDTH_PX, height: PAGE_HEIGHT_PX }, reducedMotion: "reduce", bypassCSP: true };
  const { page, context } = await openPage(browser, "", device);
  await page.goto("about:blank");
  await page.goto(`${viewer}/${fragment}`);
  await skyShown(page);
  await page.click("#enlarge");
  await page.addStyleTag({ content: `body .sky-view { height: ${HEIGHT_PX}px !important; flex: none !important; }` });
  await page.waitForTimeout(1000);
  const box = await page.locator(".sky-overlay").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  const before = childrenMs();
  const times = await page.evaluate(
    ({ frames, x, y }) =>
      new Promise((resolve) => {
        const overlay = document.querySelector(".sky-overlay");
        const times = [];
        const next = () => {
          times.push(performance.now());
          const i = times.length;
          const at = { clientX: x + 200 * Math.sin(i / 10), clientY: y + 40 * Math.cos(i / 10), buttons: 1, bubbles: true };
          overlay.dispatchEvent(new PointerEvent("pointermove", at));
          if (i <= frames) requestAnimationFrame(next);
          else resolve(times);
        };
        requestAnimationFrame(next);
      }),
    { frames: FRAMES, x: box.x + box.width / 2, y: box.y + box.height / 2 },
  );
  const processorMs = (childrenMs() - before) / FRAMES;
  await page.mouse.up();
  await context.close();
  const steps = times.slice(1).map((time, i) => time - times[i]);
  steps.sort((a, b) => a - b);
  const quantile = (part) => steps[Math.floor(part * (steps.length - 1))].toFixed(0);
  const rate = (1000 * FRAMES) / (times[FRAMES] - times[0]);
  console.log(
    `${viewer}: ${rate.toFixed(1)} frames a second, median ${quantile(0.5)} ms, 95th percentile ${quantile(0.95)} ms, ` +
      `processor ${processorMs.toFixed(0)} ms a frame, picture of ${Math.round(box.width)} × ${Math.round(box.height)}`,
  );
}

const browser = await launch();
const { scene, beside } = await demo();
const place = `#scene=${scene.id}&lat=${beside.latitude_deg}&lon=${beside.longitude_deg}`;
const look = process.env.FRAGMENT ?? "&time=2026-08-12T22:00Z&look=180/35/70";
const viewers = process.argv.length > 2 ? process.argv.slice(2) : [SERVER];
for (let round = 0; round < ROUNDS; round++)
  for (const viewer of viewers) await measure(browser, viewer, `${place}&projection=perspective${look}`);
await browser.close();
