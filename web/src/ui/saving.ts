// Pictures to be passed on, each with its caption: what the page shows, and a change before and after in one file.

import { api } from "../api/client.ts";
import type { SkyAnswer } from "../api/types.ts";
import { eyeOfBoth } from "../data/both-skies.ts";
import { words } from "../language/words.ts";
import { type AppState, coordinatesOf, sceneOf, skyConditions } from "../state/app-state.ts";
import { animated } from "./apng.ts";
import { captioned, captionLines } from "./captioned.ts";
import { saveFile } from "./dom.ts";
import { placeName } from "./nearby.ts";
import { pictureUrl } from "./picture-url.ts";
import { type SavedSize, savedSizePx } from "./saved-size.ts";

/** Each picture of a change is seen for so long. */
const EACH_MS = 2000;

function fileName(name: string, more = ""): string {
  return `skyglow ${name.replaceAll(/[\\/:*?"<>|]/g, " ")}${more}.png`;
}

/** The picture that the page shows, with its caption. */
export async function savePicture(state: Readonly<AppState>, size: SavedSize): Promise<void> {
  const { place, places, answer, shares, projection, skyAspect } = state;
  const scene = sceneOf(state);
  if (scene === null || place === null || answer === null) return;
  const parameters = { ...coordinatesOf(place), ...skyConditions(state) };
  const url = pictureUrl(scene.id, parameters, state, savedSizePx(projection, skyAspect, size));
  const name = placeName(place, places);
  const lines = captionLines({ place, name, scene, answer, shares }, state);
  const picture = await api.picture(url, new AbortController().signal);
  const [saved] = await captioned([{ picture, lines, label: "" }]);
  if (saved !== undefined) saveFile(saved, fileName(name));
}

/** The sky of today and with the changed lights, one after the other in one file, seen by one eye. */
export async function saveBeforeAfter(state: Readonly<AppState>): Promise<void> {
  const { place, places, projection, skyAspect, scenario } = state;
  const scene = sceneOf(state);
  if (scene === null || place === null || scenario === null) return;
  const { signal } = new AbortController();
  const { scenario: _, ...today } = { ...coordinatesOf(place), ...skyConditions(state) };
  const changed = { ...today, scenario };
  const answers = [today, changed].map((parameters) => api.sky(scene.id, parameters, signal)) as [
    Promise<SkyAnswer>,
    Promise<SkyAnswer>,
  ];
  const adaptation = await eyeOfBoth(scene.id, { parameters: today, answer: answers[0] }, state, signal);
  const look = { ...savedSizePx(projection, skyAspect, "moving"), ...(adaptation === null ? {} : { adaptation }) };
  const name = placeName(place, places);
  const { sky } = words();
  const after = scenario.startsWith("p-") ? sky.withPlan : sky.asPainted;
  const frames = await Promise.all(
    (
      [
        [today, answers[0], sky.today, null],
        [changed, answers[1], after, scenario],
      ] as const
    ).map(async ([parameters, answer, label, lights]) => ({
      picture: await api.picture(pictureUrl(scene.id, parameters, state, look), signal),
      lines: captionLines(
        { place, name, scene, answer: await answer, shares: null },
        { ...state, scenario: lights, lights: "changed" },
      ),
      label,
    })),
  );
  const pictures = await captioned(frames);
  const bytes = await Promise.all(pictures.map(async (picture) => new Uint8Array(await picture.arrayBuffer())));
  const file = animated(bytes, EACH_MS);
  if (file === null) throw new Error(words().problems.headline);
  saveFile(new Blob([file], { type: "image/png" }), fileName(name, ` ${sky.today} - ${after}`));
}
