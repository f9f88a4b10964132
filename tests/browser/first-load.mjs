// The first visit over a slow line: bytes, when something is seen, when the page can be used, and when the map is there.
//   scripts/browser_tests.sh node first-load.mjs [kbit/s] [latency, ms]
import { launch, PHONE, SERVER } from "./support/browser.mjs";

const kbitS = Number(process.argv[2] ?? 400);
const latency = Number(process.argv[3] ?? 400);
const browser = await launch();
try {
  const context = await browser.newContext({ ...PHONE, serviceWorkers: "block" });
  const page = await context.newPage();
  const session = await context.newCDPSession(page);
  await session.send("Network.enable");
  const bytesPerS = (1000 * kbitS) / 8;
  await session.send("Network.emulateNetworkConditions", {
    offline: false,
    latency,
    downloadThroughput: bytesPerS,
    uploadThroughput: bytesPerS,
  });
  const files = new Map();
  let bytes = 0;
  session.on("Network.responseReceived", ({ requestId, response }) => files.set(requestId, response.url));
  const arrived = [];
  const start = Date.now();
  session.on("Network.loadingFinished", ({ requestId, encodedDataLength }) => {
    bytes += encodedDataLength;
    arrived.push([Date.now() - start, encodedDataLength, new URL(files.get(requestId) ?? "about:blank").pathname]);
  });
  const tell = (what) => console.log(`${what}: ${((Date.now() - start) / 1000).toFixed(2)} s, ${Math.round(bytes / 1000)} kB`);
  await page.goto(`${SERVER}/`, { waitUntil: "commit" });
  await page.waitForFunction(() => performance.getEntriesByName("first-contentful-paint").length > 0);
  const paintedMs = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime);
  console.log(`first contentful paint: ${(paintedMs / 1000).toFixed(2)} s`);
  tell("told of it");
  await page.waitForSelector("#scene-note:not(:empty), #map[data-basemap]", { timeout: 120_000 });
  tell("scene or map there");
  await page.waitForSelector("#map[data-basemap]", { timeout: 120_000 });
  tell("map there");
  for (const [ms, length, path] of arrived) console.log(`${String(ms).padStart(7)} ms ${String(length).padStart(8)} bytes ${path}`);
} finally {
  await browser.close();
}
