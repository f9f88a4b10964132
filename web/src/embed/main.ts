// The view for other people's pages: the sky of one place as a picture and a sentence, and the way to the viewer.

import { api } from "../api/client.ts";
import { problemLine } from "../api/problem.ts";
import { chooseLanguage, loadWords, placeWords, words } from "../language/words.ts";
import { type AppState, coordinatesOf, initialState, sceneFor, sharesQuery, skyConditions } from "../state/app-state.ts";
import { stateFromFragment } from "../state/fragment.ts";
import { byId, make, told } from "../ui/dom.ts";
import { placeName } from "../ui/nearby.ts";
import { pictureUrl } from "../ui/picture-url.ts";
import { glowSentence, summaryOf } from "../ui/summary.ts";
import { embeddedLook, pictureSize, pictureWidthPx, viewerUrl } from "./embedded.ts";

/** Towns that the sentence may name. */
const LISTED_TOWNS = 2;
const { signal } = new AbortController();

async function show(): Promise<void> {
  const view = initialState(stateFromFragment(location.hash));
  const open = byId("open", HTMLAnchorElement);
  open.href = viewerUrl(location.href);
  const scenes = await api.scenes(signal);
  const { place } = view;
  // A link to no place is one to the viewer.
  if (place === null) throw new Error(words().layers.placeFirst);
  const scene = sceneFor({ scenes, scene: view.scene }, place);
  if (scene === null) throw new Error(words().top.notCovered);
  const state: AppState = { ...view, scenes, scene: scene.id };
  const parameters = { ...coordinatesOf(place), ...skyConditions(state) };
  const [answer, places] = await Promise.all([api.sky(scene.id, parameters, signal), api.places(scene.id, signal)]);
  const name = placeName(place, places);
  const say = placeWords();
  const [first = "", ...others] = summaryOf(answer);
  const glow = make("span", "");
  byId("place", HTMLElement).textContent = name;
  byId("sentence", HTMLElement).replaceChildren(make("strong", "", first), ...others.map((sentence) => ` ${sentence}`), glow);
  document.title = `${name} – Skyglow`;
  open.textContent = say.downloads.openViewer;
  const illustrative = scene.illustrative ? [words().scene.illustrative] : [scene.title, scene.attribution ?? ""];
  byId("credit", HTMLElement).textContent = ["", ...illustrative].filter((part, i) => i === 0 || part !== "").join(" · ");

  const look = embeddedLook(state, answer);
  const picture = byId("picture", HTMLImageElement);
  const widthPx = pictureWidthPx(document.documentElement.clientWidth, devicePixelRatio);
  picture.classList.toggle("whole", look.projection === "fisheye");
  picture.alt = say.compare.skyOver(name);
  picture.src = pictureUrl(scene.id, parameters, look, { ...pictureSize(look, widthPx), legend: "off" }, "webp");
  const sky = byId("sky", HTMLAnchorElement);
  sky.href = open.href;
  sky.title = say.downloads.openViewer;
  sky.hidden = false;
  document.querySelector("main")?.setAttribute("aria-busy", "false");

  const { region: _, ...query } = sharesQuery({ ...state, region: null }, place);
  const shares = await api.shares(scene.id, { ...query, limit: LISTED_TOWNS }, signal);
  const sentence = glowSentence(answer, shares);
  glow.textContent = sentence === "" ? "" : ` ${sentence}`;
}

function fail(reason: unknown): void {
  byId("sentence", HTMLElement).replaceChildren(told("span", "", problemLine(reason)));
  document.querySelector("main")?.setAttribute("aria-busy", "false");
}

// Whoever changes the frame's address wants another place.
addEventListener("hashchange", () => location.reload());
try {
  await chooseLanguage();
  await loadWords("place");
  await show();
} catch (reason) {
  fail(reason);
}
