// The notebook's widget (python/src/skyglow/widget.js) on a page of its own. What Python does in a notebook, a model here does with
// answers of the server.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { after, before, test } from "node:test";
import { DESKTOP, PHONE, SERVER, shot } from "./support/browser.mjs";
import { browser, here } from "./support/stage.mjs";

const SOURCES = new URL("../../python/src/skyglow/", import.meta.url);
const PAGE = `<!doctype html><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<link rel="icon" href="data:,"><link rel="stylesheet" href="widget.css"><body style="margin:8px"><div id="cell"></div>`;

let pages;
before(async () => {
  pages = createServer(async (request, response) => {
    const file = /^\/(widget\.(?:js|css))$/.exec(request.url)?.[1];
    const type = { js: "text/javascript", css: "text/css" }[file?.split(".")[1]] ?? "text/html";
    response.writeHead(200, { "content-type": type });
    response.end(file ? await readFile(new URL(file, SOURCES)) : PAGE);
  });
  await new Promise((resolve) => pages.listen(0, "127.0.0.1", resolve));
});
after(() => pages?.close());

/** In the page: a model with what Python would know and do. `window.said` has what the widget sent. */
async function renderWidget({ server, scene, place }) {
  const traits = {
    lat: null,
    lon: null,
    sky: null,
    problem: "",
    picture: null,
    is_busy: false,
    bounds: scene.bounds,
    title: scene.title,
  };
  const listeners = new Map();
  const tell = (name, ...what) => {
    for (const listener of listeners.get(name) ?? []) listener(...what);
  };
  const put = (name, value) => {
    traits[name] = value;
    tell(`change:${name}`);
  };
  const bytes = async (url) => {
    let answer = await fetch(url);
    // A map of brightness is made first.
    while (answer.status === 503) {
      await new Promise((resolve) => setTimeout(resolve, 500));
      answer = await fetch(url);
    }
    if (!answer.ok) throw new Error((await answer.json()).detail);
    return new DataView(await answer.arrayBuffer());
  };
  const go = async ({ lat, lon }) => {
    put("lat", lat);
    put("lon", lon);
    put("is_busy", true);
    try {
      const asked = `${server}/api/v1/scenes/${scene.id}`;
      const picture = await bytes(`${asked}/panorama.png?lat=${lat}&lon=${lon}&projection=fisheye&width=560&height_px=560`);
      const sky = await (await fetch(`${asked}/sky?lat=${lat}&lon=${lon}`)).json();
      put("picture", picture);
      put("problem", "");
      put("sky", sky);
    } catch (error) {
      put("sky", null);
      put("picture", null);
      put("problem", error.message);
    }
    put("is_busy", false);
  };
  const draw = async ({ bounds, size_px }) => {
    const [width, height] = size_px;
    const url = `${server}/api/ogc/collections/${scene.id}/map?bbox=${bounds}&width=${width}&height=${height}`;
    const places = await (await fetch(`${server}/api/v1/scenes/${scene.id}/places`)).json();
    places.sort((a, b) => (b.population ?? 0) - (a.population ?? 0));
    const [west, south, east, north] = bounds;
    const isWithin = (at) => at.lat > south && at.lat < north && at.lon > west && at.lon < east;
    const names = places.map(({ name, latitude_deg: lat, longitude_deg: lon }) => ({ name, lat, lon }));
    const picture = await bytes(url);
    tell("msg:custom", { kind: "map", bounds, places: names.filter(isWithin).slice(0, 40) }, [picture]);
  };
  window.said = [];
  const model = {
    get: (name) => traits[name],
    on: (name, listener) => listeners.set(name, [...(listeners.get(name) ?? []), listener]),
    off: (name, listener) =>
      listeners.set(
        name,
        (listeners.get(name) ?? []).filter((one) => one !== listener),
      ),
    send: (message) => {
      window.said.push(message);
      if (message.kind === "place") go(message);
      else draw(message);
    },
  };
  const { default: widget } = await import("./widget.js");
  window.end = widget.render({ model, el: document.querySelector("#cell") });
  window.listening = () => [...listeners.values()].flat().length;
  if (place) go({ lat: place.latitude_deg, lon: place.longitude_deg });
}

async function openWidget(device, place) {
  const context = await browser.newContext(device);
  const page = await context.newPage();
  const faults = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && faults.push(message.text()));
  page.on("pageerror", ({ message }) => faults.push(message));
  await page.goto(`http://127.0.0.1:${pages.address().port}/`);
  await page.evaluate(renderWidget, { server: SERVER, scene: here.scene, place });
  await page.waitForSelector(".area:not([aria-busy]) .chart[src]");
  return { page, context, faults };
}

const skyOf = (page) => page.waitForSelector(".picture:not(.busy) img[src]");
const lastPlace = (page) => page.evaluate(() => window.said.filter(({ kind }) => kind === "place").at(-1));
const texts = (page, selector) => page.$$eval(selector, (all) => all.map(({ textContent }) => textContent));

/** Where a place lies on the map, pixels of the page. */
async function pixelOf(page, { latitude_deg, longitude_deg }) {
  const [west, south, east, north] = await page.evaluate(() => window.said.filter(({ kind }) => kind === "map").at(-1).bounds);
  const box = await page.locator(".area").boundingBox();
  return [
    box.x + (box.width * (longitude_deg - west)) / (east - west),
    box.y + (box.height * (north - latitude_deg)) / (north - south),
  ];
}

test("a click gives the sky of the place", async () => {
  const { page, context, faults } = await openWidget(DESKTOP);
  assert.deepEqual(await texts(page, "dd"), []);
  await page.mouse.click(...(await pixelOf(page, here.town)));
  await skyOf(page);
  const { lat, lon } = await lastPlace(page);
  assert.ok(Math.abs(lat - here.town.latitude_deg) < 0.03 && Math.abs(lon - here.town.longitude_deg) < 0.03, `${lat}, ${lon}`);
  const sky = await (await fetch(`${SERVER}/api/v1/scenes/${here.scene.id}/sky?lat=${lat}&lon=${lon}`)).json();
  const numbers = await texts(page, "dd");
  assert.equal(numbers[0], `${sky.sky.zenith_total_brightness_mag_arcsec2.toFixed(2)} mag/arcsec²`);
  assert.equal(numbers[3], String(sky.sky.bortle_class));
  assert.equal(await page.inputValue("input[name=lat]"), String(lat));
  assert.ok((await texts(page, ".names span:not([hidden])")).includes(here.town.name));
  await shot(page, "widget");
  // A drag moves the map and chooses nothing.
  const before = await page.evaluate(() => window.said.length);
  await page.mouse.move(300, 300);
  await page.mouse.down();
  await page.mouse.move(360, 320, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction((before) => window.said.length > before, before);
  assert.deepEqual(await lastPlace(page), { kind: "place", lat, lon });
  assert.deepEqual(faults, []);
  await context.close();
});

test("keys choose a place and zoom", async () => {
  const { page, context, faults } = await openWidget(DESKTOP, here.town);
  await skyOf(page);
  await page.locator(".area").focus();
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("Shift+ArrowRight");
  // Keys in quick succession say one place, on a busy machine two.
  await page.waitForFunction((lon) => window.said.some((said) => said.kind === "place" && said.lon > lon), here.town.longitude_deg);
  const { lat, lon } = await lastPlace(page);
  assert.ok(lat > here.town.latitude_deg && lon > here.town.longitude_deg, `${lat}, ${lon}`);
  const span = () =>
    page.evaluate(() => window.said.filter(({ kind }) => kind === "map").at(-1).bounds).then(([, s, , n]) => n - s);
  const before = await span();
  await page.keyboard.press("+");
  await page.waitForFunction((before) => {
    const [, south, , north] = window.said.filter(({ kind }) => kind === "map").at(-1).bounds;
    return north - south < before;
  }, before);
  assert.ok(Math.abs((await span()) - before / 2) < 1e-6);
  await page.fill("input[name=lat]", "0");
  await page.fill("input[name=lon]", "0");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".status.problem");
  assert.match(await page.locator(".status").textContent(), /outside|scene/i);
  assert.deepEqual(await texts(page, "dd"), []);
  // The browser itself says that the server refused.
  assert.deepEqual(
    faults.filter((fault) => !fault.startsWith("Failed to load resource")),
    [],
  );
  assert.equal(await page.evaluate(() => [window.end(), window.listening()][1]), 0);
  await context.close();
});

test("it fits a phone", async () => {
  const { page, context, faults } = await openWidget(PHONE, here.town);
  await skyOf(page);
  const [width, wide] = await page.evaluate(() => [document.documentElement.clientWidth, document.documentElement.scrollWidth]);
  assert.ok(wide <= width, `${wide} of ${width}`);
  const names = await page.$$eval(".names span:not([hidden])", (all) =>
    all.map((label) => ({ box: label.getBoundingClientRect().toJSON(), size: parseFloat(getComputedStyle(label).fontSize) })),
  );
  assert.ok(names.length > 2);
  const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  for (const [at, { box, size }] of names.entries()) {
    assert.ok(size >= 12);
    for (const other of names.slice(at + 1)) assert.ok(!overlap(box, other.box), JSON.stringify([box, other.box]));
  }
  await page.touchscreen.tap(...(await pixelOf(page, here.beside)));
  await page.waitForFunction(() => window.said.some(({ kind }) => kind === "place"));
  await page.waitForTimeout(50);
  await skyOf(page);
  await page.screenshot({
    fullPage: true,
    path: process.env.SKYGLOW_SHOTS ? `${process.env.SKYGLOW_SHOTS}/widget-phone.png` : undefined,
  });
  assert.deepEqual(faults, []);
  await context.close();
});
