import assert from "node:assert/strict";
import { test } from "node:test";
import { sharedLink } from "./shared-link.ts";

/** A link to a place is one that previews can read, behind a path prefix too; a link to no place stays. */
test("links to a place have a page for previews", () => {
  const view = "scene=demo&lat=46.17&lon=8.79&time=2026-08-12T22%3A30Z";
  assert.equal(sharedLink(`https://a.example/glow/#${view}`, 210.4), `https://a.example/glow/at?${view}&towards=210`);
  assert.equal(sharedLink(`http://127.0.0.1:8080/#${view}`, null), `http://127.0.0.1:8080/at?${view}`);
  assert.equal(sharedLink("https://a.example/#map=7/46/8", 3), "https://a.example/#map=7/46/8");
});
