// Pictures to be passed on, each with its caption: what the page shows, and a change before and after in one file.

import { api } from "../api/client.ts";
import type { SkyAnswer } from "../api/types.ts";
import { eyeOfBoth } from "../data/both-skies.ts";
import { words } from "../language/words.ts";
import { type AppState, coordinatesOf, landOf, sceneOf, skyConditions } from "../state/app-state.ts";
import { animated } from "./apng.ts";
import { captioned, captionLines } from "./captioned.ts";
import { saveFile } from "./dom.ts";
import { placeName } from "./nearby.ts";
import { pictureUrl } from "./picture-url.ts";
import { type SavedSize, savedSizePx } from "./saved-size.ts";

/** Each picture of a change is seen for so long. */
const EACH_MS = 2000;

function fileName(name: string, more = "", ending = "png"): string {
  return `skyglow ${name.replaceAll(/[\\/:*?"<>|]/g, " ")}${more}.${ending}`;
}

/** The picture that the page shows, with its caption. */
export async function savePicture(state: Readonly<AppState>, size: SavedSize): Promise<void> {
  const { place, places, answer, shares, projection, skyAspect } = state;
  const scene = sceneOf(state);
  if (scene === null || place === null || answer === null) return;
  const parameters = { ...coordinatesOf(place), ...skyConditions(state) };
  const url = pictureUrl(scene.id, parameters, state, savedSizePx(projection, skyAspect, size));
  const name = placeName(place, places);
  const lines = captionLines({ place, name, scene, answer, shares }, { ...state, land: landOf(state) });
  const picture = await api.picture(url, new AbortController().signal);
  const [saved] = await captioned([{ picture, lines, label: "" }]);
  if (saved !== undefined) saveFile(saved, fileName(name));
}

/** Files of several pictures: an animated PNG has all colours, a GIF is played everywhere. */
export type MovingFormat = "png" | "gif";

/** The sky of today and with the changed lights, one after the other in one file, seen by one eye. */
export async function saveBeforeAfter(state: Readonly<AppState>, format: MovingFormat): Promise<void> {
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
        { ...state, scenario: lights, lights: "changed", land: landOf(state) },
      ),
      label,
    })),
  );
  const pictures = await captioned(frames);
  const file = format === "gif" ? await gifFile(pictures) : await pngFile(pictures);
  if (file === null) throw new Error(words().problems.headline);
  saveFile(new Blob([file], { type: `image/${format}` }), fileName(name, ` ${sky.today} - ${after}`, format));
}

async function pngFile(pictures: readonly Blob[]): Promise<Uint8Array<ArrayBuffer> | null> {
  return animated(await Promise.all(pictures.map(async (picture) => new Uint8Array(await picture.arrayBuffer()))), EACH_MS);
}

async function gifFile(pictures: readonly Blob[]): Promise<Uint8Array<ArrayBuffer> | null> {
  const { gifOf } = await import("./gif.ts");
  return gifOf(await Promise.all(pictures.map(pixelsOf)), EACH_MS);
}

async function pixelsOf(picture: Blob): Promise<ImageData> {
  const image = await createImageBitmap(picture);
  const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
  if (context === null) throw new Error(words().problems.headline);
  context.drawImage(image, 0, 0);
  return context.getImageData(0, 0, image.width, image.height);
}
