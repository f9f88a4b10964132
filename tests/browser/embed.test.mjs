// The view for other people's pages: what it shows, how one gets it, and that no other page may be framed by others.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import { after, before, test } from "node:test";
import { DESKTOP, PHONE, SERVER, shot, skyShown } from "./support/browser.mjs";
import { browser, fragment, here } from "./support/stage.mjs";

let other;
let otherPage = "";
before(async () => {
  other = createServer((_, response) => {
    response.writeHead(200, { "content-type": "text/html" });
    response.end(otherPage);
  });
  await new Promise((resolve) => other.listen(0, "127.0.0.1", resolve));
});
after(() => other?.close());
/** Another host's address: 127.0.0.1 and localhost are two sites. */
const otherSite = () => `http://localhost:${other.address().port}/`;

async function embedShown(frame) {
  await frame.waitForFunction(() => {
    const picture = document.querySelector("#picture");
    return picture?.complete && picture.naturalWidth > 0 && /%/.test(document.querySelector("#sentence")?.textContent ?? "");
  });
}

/** It says what the viewer says of the place, shows its picture, and leads to it; in the reader's language. */
test("the embedded view shows a place", async () => {
  for (const device of [DESKTOP, { ...PHONE, locale: "de-DE" }]) {
    const context = await browser.newContext(device);
    const page = await context.newPage();
    const faults = [];
    page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
    page.on("pageerror", ({ message }) => faults.push(message));
    await page.goto(`${SERVER}/embed${fragment(here.beside)}`);
    await embedShown(page);
    const [sentence, href, target] = await page.evaluate(() => {
      const link = document.querySelector("#open");
      return [document.querySelector("#sentence").textContent, link.href, link.target];
    });
    assert.equal(href, `${SERVER}/${fragment(here.beside)}`);
    assert.equal(target, "_blank");
    assert.match(await page.getAttribute("#picture", "src"), /panorama\.webp\?/);
    assert.notEqual((await page.getAttribute("meta[name=description]", "content")) ?? "", "");
    await shot(page, device === DESKTOP ? "embed" : "embed-phone");
    const viewer = await context.newPage();
    await viewer.goto(href);
    await skyShown(viewer);
    await viewer.waitForFunction(() => /%/.test(document.querySelector("#summary")?.textContent ?? ""));
    assert.equal(sentence, await viewer.locator("#summary").textContent());
    assert.deepEqual(faults, []);
    await context.close();
  }
});

/** A place that no scene has is told, and the way to the viewer stays. */
test("an embedded view without a scene says so", async () => {
  const context = await browser.newContext(DESKTOP);
  const page = await context.newPage();
  await page.goto(`${SERVER}/embed#lat=-80&lon=170`);
  await page.waitForFunction(() => /no scene covers it/.test(document.querySelector("#sentence")?.textContent ?? ""));
  assert.ok(await page.locator("#open").isVisible());
  await context.close();
});

/** Other sites may frame the embedded view; the viewer and the page of the interface stay empty there. */
test("other sites frame the embedded view alone", async () => {
  const context = await browser.newContext(DESKTOP);
  const page = await context.newPage();
  otherPage = ["embed", "", "api/docs"]
    .map(
      (path) => `<iframe name="frame-${path}" width="640" height="480" src="${SERVER}/${path}${fragment(here.beside)}"></iframe>`,
    )
    .join("");
  await page.goto(otherSite());
  await embedShown(page.frame("frame-embed"));
  assert.match(await page.frame("frame-embed").title(), /Skyglow/);
  for (const name of ["frame-", "frame-api/docs"]) assert.match(page.frame(name).url(), /^chrome-error:/, name);
  await shot(page, "embed-framed");
  await context.close();
});

/** The code is copied, and works where it is pasted. */
test("embed code is copied and works", async () => {
  const context = await browser.newContext({ ...DESKTOP, permissions: ["clipboard-read", "clipboard-write"] });
  const page = await context.newPage();
  await page.goto(`${SERVER}/${fragment(here.beside)}`);
  await skyShown(page);
  await page.getByRole("button", { name: "Copy embed code" }).click();
  await page.waitForFunction(() => document.querySelector("#embed-told")?.textContent !== "");
  assert.equal(await page.locator("#embed-told").textContent(), "The code is copied.");
  otherPage = await page.evaluate(() => navigator.clipboard.readText());
  assert.equal(await page.locator("#embed-code").inputValue(), otherPage);
  await page.locator("#downloads").scrollIntoViewIfNeeded();
  await shot(page, "embed-code");
  const pasted = await context.newPage();
  await pasted.goto(otherSite());
  await embedShown(pasted.frames()[1]);
  await context.close();
});
