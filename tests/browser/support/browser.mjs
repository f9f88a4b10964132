// One Chromium for a test file, and pages that note everything a good viewer never does.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { chromium } from "playwright-core";

/** Where the server under test listens, without a slash at its end. */
export const SERVER = (process.env.SKYGLOW_URL ?? "").replace(/\/+$/, "");
if (SERVER === "") {
  throw new Error("SKYGLOW_URL is not set: start `skyglow serve` (or `npm run mock`) and set it to the server's address");
}

const EXECUTABLE = process.env.SKYGLOW_CHROMIUM ?? "/usr/bin/chromium";
const FLAGS = [
  "--no-sandbox",
  "--no-first-run",
  "--disable-quic",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  // WebGL2 without a graphics card.
  "--enable-unsafe-swiftshader",
  "--use-angle=swiftshader",
];

// Less motion: every frame of a fading map costs the processor, which draws it, a tenth of a second.
const STILL = { reducedMotion: "reduce" };
export const DESKTOP = { viewport: { width: 1180, height: 760 }, ...STILL };
export const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true, ...STILL };

/** A browser whose contexts close without faults of answers that a test was still changing on their way. */
export async function launch() {
  const browser = await chromium.launch({ executablePath: EXECUTABLE, headless: true, args: FLAGS });
  const newContext = browser.newContext.bind(browser);
  browser.newContext = async (options) => {
    const context = await newContext(options);
    const close = context.close.bind(context);
    context.close = async () => {
      for (const routed of [context, ...context.pages()]) await routed.unrouteAll({ behavior: "ignoreErrors" });
      await close();
    };
    return context;
  };
  return browser;
}

function wantNoTime() {
  // A page without an address has no storage.
  if (location.protocol.startsWith("http")) localStorage.setItem("skyglow.time", "none");
}

/** A page of its own context, with `faults` (console errors, exceptions, requests to other hosts) and `asked`. */
export async function openPage(browser, fragment = "", { isTonight = false, ...device } = DESKTOP) {
  // Pictures of the viewer may be taken in another language and at another clock.
  const { SKYGLOW_LOCALE: locale, SKYGLOW_CLOCK: timezoneId } = process.env;
  const told = { ...(locale === undefined ? {} : { locale }), ...(timezoneId === undefined ? {} : { timezoneId }) };
  const context = await browser.newContext({ ...told, ...device, serviceWorkers: "block" });
  // Most tests hold a sky against the API's of no time; what comes without a choice is tonight's (time.test.mjs).
  if (!isTonight) await context.addInitScript(wantNoTime);
  const page = await context.newPage();
  // A busy machine may be given more time.
  page.setDefaultTimeout(Number(process.env.SKYGLOW_WAIT_MS ?? 30_000));
  const faults = [];
  const asked = [];
  page.on("console", (message) => {
    // These tests go without the worker that keeps answers: it has its own.
    if (message.text().startsWith("Service Worker registration blocked by Playwright")) return;
    if (message.type() === "error" || message.type() === "warning")
      faults.push(`${message.type()}: ${message.text()} (${message.location().url})`);
  });
  page.on("pageerror", (error) => faults.push(`exception: ${error.message}`));
  context.on("request", (request) => {
    const url = new URL(request.url());
    if (url.protocol.startsWith("http") && url.origin !== new URL(SERVER).origin) faults.push(`outside request: ${request.url()}`);
    if (url.pathname.includes("/api/v1/")) asked.push(url.pathname.split("/api/v1/")[1] + url.search);
  });
  await page.goto(`${SERVER}/${fragment}`);
  await page.waitForSelector("#map[data-basemap]");
  return { page, context, faults, asked };
}

export function assertNoFaults({ faults }) {
  assert.deepEqual(faults, []);
}

export async function getJson(path) {
  const response = await fetch(`${SERVER}/api/v1/${path}`);
  assert.equal(response.status, 200, `${path}: ${response.status}`);
  return response.json();
}

/** Saves a screenshot where SKYGLOW_SHOTS names a folder. */
export async function shot(page, name) {
  const folder = process.env.SKYGLOW_SHOTS;
  if (folder === undefined || folder === "") return;
  mkdirSync(folder, { recursive: true });
  await page.screenshot({ path: join(folder, `${name}.png`) });
}

export async function skyShown(page) {
  await page.waitForSelector("body[data-sky=picture]:not(.busy)");
}

/** Waits until the shown numbers are those of an answer. */
export async function numbersShown(page, expected) {
  await page.waitForFunction(
    (text) => document.querySelector("[data-value=zenith_mag]")?.textContent === text && !document.body.classList.contains("busy"),
    expected.zenith_brightness_mag_arcsec2.toFixed(2),
  );
}

/** How many colours a canvas or a picture has, transparent pixels left out. */
export function canvasColours(page, selector) {
  return page.$eval(selector, (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const colours = new Set();
    for (let i = 0; i < data.length; i += 4)
      if (data[i + 3] === 255) colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return colours.size;
  });
}

/** A part of the page as the screen shows it (a WebGL canvas cannot be read later): how many colours, and the
 * largest value of red, green and blue. */
export async function screenColours(browser, page, selector) {
  const png = await page.locator(selector).screenshot();
  const scratch = await browser.newPage();
  try {
    return await scratch.evaluate(async (base64) => {
      const image = new Image();
      image.src = `data:image/png;base64,${base64}`;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext("2d");
      context.drawImage(image, 0, 0);
      const { data } = context.getImageData(0, 0, image.width, image.height);
      const colours = new Set();
      const most = [0, 0, 0];
      for (let i = 0; i < data.length; i += 4) {
        colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
        for (let c = 0; c < 3; c++) most[c] = Math.max(most[c], data[i + c]);
      }
      return { count: colours.size, most };
    }, png.toString("base64"));
  } finally {
    await scratch.close();
  }
}

/** Moves a slider as a person does. */
export function setSlider(page, id, value) {
  return page.$eval(
    `#${id}`,
    (slider, value) => {
      slider.value = value;
      slider.dispatchEvent(new Event("input", { bubbles: true }));
    },
    String(value),
  );
}
