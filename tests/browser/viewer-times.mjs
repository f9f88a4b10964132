// All that the viewer is measured by, in one table: frames while looking around, from a click to the numbers and the picture, the first
// load over a slow line, Lighthouse, and the steps of journeys. scripts/viewer_times.sh runs it; the machine should do nothing else.
import { spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { loadavg, tmpdir } from "node:os";
import { join } from "node:path";
import { SERVER } from "./support/browser.mjs";
import { demo } from "./support/sky.mjs";

const LIGHTHOUSE = "lighthouse@13.5.0";
const FLAGS = "--headless=new --no-sandbox --enable-unsafe-swiftshader --use-angle=swiftshader";
const folder = process.env.SKYGLOW_TIMES ?? mkdtempSync(join(tmpdir(), "viewer-times-"));
mkdirSync(folder, { recursive: true });
/** A try: fewer frames and clicks. */
const isQuick = process.env.QUICK === "1";
const rows = [];
const [load] = loadavg();

/** Runs a command, keeps what it says, and returns it. */
function told(name, command, args, env = {}) {
  console.error(`${name} …`);
  const { stdout, stderr, status } = spawnSync(command, args, { encoding: "utf8", env: { ...process.env, ...env } });
  writeFileSync(join(folder, `${name}.txt`), `${stdout}\n${stderr}`);
  if (status !== 0) rows.push([name, "failed", `${name}.txt`]);
  return stdout;
}

/** The middle one of what a text says of a kind. */
function median(text, pattern) {
  const all = [...text.matchAll(pattern)].map(([, number]) => Number(number)).sort((a, b) => a - b);
  return all.length === 0 ? "?" : all[Math.floor((all.length - 1) / 2)];
}

for (const [size, wanted] of [
  ["1440x900", "30"],
  ["3840x2160", "usable"],
]) {
  const text = told(`frames-${size}`, "node", ["frame-rate.mjs"], {
    SIZE: size,
    ...(isQuick ? { FRAMES: "15", ROUNDS: "1" } : {}),
  });
  const [rate, late] = [/([\d.]+) frames a second/g, /95th percentile (\d+) ms/g].map((pattern) => median(text, pattern));
  rows.push([`frames a second looking around, ${size}, software GL`, `${rate} (95 % within ${late} ms)`, wanted]);
}

const clicks = told("clicks", "node", ["click-times.mjs", isQuick ? "5" : "30"]);
for (const [step, what, wanted] of [
  ["numbers", "a click → numbers", "100 ms"],
  ["picture", "a click → picture", "200 ms"],
]) {
  const [, middle, most] = new RegExp(`${step} +median (\\d+) ms, 90 % (\\d+) ms`).exec(clicks) ?? [];
  rows.push([what, `${middle} ms (90 % within ${most} ms)`, wanted]);
}

const first = told("first-load", "node", ["first-load.mjs", "400", "400"]);
rows.push(["first paint at 400 kbit/s, 400 ms", `${median(first, /first contentful paint: ([\d.]+) s/g)} s`, "2 s"]);
const [, mapS, mapKb] = /map there: ([\d.]+) s, (\d+) kB/.exec(first) ?? [];
rows.push(["the map there, on that line", `${mapS} s, ${mapKb} kB`, ""]);

const { scene, beside } = await demo();
const place = `#scene=${scene.id}&lat=${beside.latitude_deg}&lon=${beside.longitude_deg}`;
for (const [name, page, preset] of [
  ["phone", "/", []],
  ["phone-place", `/${place}`, []],
  ["desktop", "/", ["--preset=desktop"]],
  ["embed", `/embed${place}`, []],
]) {
  const file = join(folder, `lighthouse-${name}.json`);
  const only = "--only-categories=performance,accessibility,best-practices,seo";
  const args = ["--yes", LIGHTHOUSE, `${SERVER}${page}`, "--quiet", only, "--output=json", `--output-path=${file}`];
  told(`lighthouse-${name}`, "npx", [...args, `--chrome-flags=${FLAGS}`, ...preset], {
    CHROME_PATH: process.env.SKYGLOW_CHROMIUM ?? "/usr/bin/chromium",
  });
  try {
    const { categories } = JSON.parse(readFileSync(file, "utf8"));
    const scores = Object.values(categories).map(({ title, score }) => `${title} ${Math.round(100 * score)}`);
    rows.push([`Lighthouse, ${name}`, scores.join(", "), ""]);
  } catch {
    rows.push([`Lighthouse, ${name}`, "no result", ""]);
  }
}

const journeys = told("journeys", "node", ["journeys.mjs"], { SKYGLOW_SHOTS: join(folder, "shots") });
for (const line of journeys.trim().split("\n").slice(1)) {
  const at = line.indexOf(":");
  rows.push([`steps, ${line.slice(0, at)}`, line.slice(at + 1).trim(), ""]);
}

console.log(`Load average at the start ${load.toFixed(1)}; what each said, and pictures: ${folder}\n`);
console.log("| what | measured | wanted |\n|---|---|---|");
for (const row of rows) console.log(`| ${row.join(" | ")} |`);
