// What every test file stands on: one Chromium, and the demo with a place beside its largest town. Importing it sets both up.
import { after, before } from "node:test";
import { launch } from "./browser.mjs";
import { demo } from "./sky.mjs";

export let browser;
export let here;

before(async () => {
  browser = await launch();
  here = await demo();
});
after(() => browser?.close());

/** The link to a place of the demo. */
export const fragment = (place, more = "") => `#scene=${here.scene.id}&lat=${place.latitude_deg}&lon=${place.longitude_deg}${more}`;
/** What the page's address says of a name; null for nothing. */
export const inLink = (page, name) => new URLSearchParams(new URL(page.url()).hash.slice(1)).get(name);
