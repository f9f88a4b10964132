import assert from "node:assert/strict";
import { test } from "node:test";
import { initialState } from "../state/app-state.ts";
import { DEFAULT_STATE } from "../state/view-state.ts";
import { embedCode, embeddedLook, embedUrl, pictureSize, pictureWidthPx, viewerUrl } from "./embedded.ts";

const VIEWER = "https://host.example/sky/#scene=demo&lat=46.17&lon=8.95&map=6/46/9&time=2026-12-05T22:00Z&report=on";

/** The frame's address keeps the place, the time and a server's prefix, and leaves out what only the viewer has; and back. */
test("an embedded view has the viewer's place", () => {
  const url = embedUrl(VIEWER);
  assert.equal(url, "https://host.example/sky/embed#scene=demo&lat=46.17&lon=8.95&time=2026-12-05T22:00Z");
  assert.equal(viewerUrl(url), "https://host.example/sky/#scene=demo&lat=46.17&lon=8.95&time=2026-12-05T22:00Z");
});

/** Names of places cannot end the attribute that they stand in. */
test("embed code is safe to paste", () => {
  const code = embedCode(VIEWER, `"><script>&`);
  assert.match(code, /^<iframe src="https:\/\/host\.example\/sky\/embed#scene=demo&#38;lat=46\.17/);
  assert.equal(code.split("<").length, 3);
  assert.match(code, /title="&#34;&#62;&#60;script&#62;&#38;"/);
});

/** It looks at the brightest light unless the link looks elsewhere; a fisheye stays one. */
test("an embedded view looks at the brightest light", () => {
  const state = initialState({ ...DEFAULT_STATE });
  const answer = { sky: { brightest_azimuth_deg: 70 } } as Parameters<typeof embeddedLook>[1];
  const look = embeddedLook(state, answer);
  assert.deepEqual([look.projection, look.gaze?.azimuthDeg], ["perspective", 70]);
  assert.deepEqual(pictureSize(look, 640), { width: 640, height_px: 360 });
  const gaze = { azimuthDeg: 200, elevationDeg: 30, fieldDeg: 40 };
  assert.equal(embeddedLook({ ...state, projection: "perspective", gaze }, answer).gaze, gaze);
  const fisheye = embeddedLook({ ...state, projection: "fisheye" }, answer);
  assert.deepEqual(pictureSize(fisheye, 640), { width: 640 });
});

test("pictures come in few widths", () => {
  assert.deepEqual(
    [300, 641, 900, 4000].map((cssPx) => pictureWidthPx(cssPx, 1)),
    [640, 1280, 1280, 1920],
  );
  assert.equal(pictureWidthPx(390, 3), 1280);
});
