// How fast the sky is drawn while one looks around, on a page of 1440 × 900: node frame-rate.mjs [fragment]
import { launch, openPage, SERVER, skyShown } from "./support/browser.mjs";
import { demo, skyPath } from "./support/sky.mjs";

const FRAMES = 120;
const browser = await launch();
const { scene, beside } = await demo();
const more = process.argv[2] ?? "&colours=eye&sky=total";
const fragment = `#scene=${scene.id}&lat=${beside.latitude_deg}&lon=${beside.longitude_deg}&projection=perspective${more}`;
const { page } = await openPage(browser, fragment, { viewport: { width: 1440, height: 900 }, reducedMotion: "reduce" });
await skyShown(page);
await page.click("#enlarge");
await page.waitForTimeout(500);
const box = await page.locator(".sky-overlay").boundingBox();
await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
await page.mouse.down();
const seconds = await page.evaluate(
  ({ frames, x, y }) =>
    new Promise((resolve) => {
      const overlay = document.querySelector(".sky-overlay");
      const started = performance.now();
      let frame = 0;
      const next = () => {
        const at = { clientX: x + 200 * Math.sin(frame / 10), clientY: y + 40 * Math.cos(frame / 10), buttons: 1, bubbles: true };
        overlay.dispatchEvent(new PointerEvent("pointermove", at));
        frame++;
        if (frame < frames) requestAnimationFrame(next);
        else resolve((performance.now() - started) / 1000);
      };
      requestAnimationFrame(next);
    }),
  { frames: FRAMES, x: box.x + box.width / 2, y: box.y + box.height / 2 },
);
await page.mouse.up();
const answer = await fetch(`${SERVER}/api/v1/${skyPath(scene, "panorama.sky", beside)}`, {
  headers: { "accept-encoding": "gzip" },
});
const bytes = answer.headers.get("content-length") ?? (await answer.arrayBuffer()).byteLength;
console.log(
  `${(FRAMES / seconds).toFixed(1)} frames a second, a picture of ${Math.round(box.width)} × ${Math.round(box.height)}; panorama.sky ${bytes} bytes`,
);
await browser.close();
