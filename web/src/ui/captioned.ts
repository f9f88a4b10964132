// The picture of the sky to be passed on: below it stand the place, the time, what was assumed, and whose data it is.

import type { Scene, Shares, SkyAnswer } from "../api/types.ts";
import { placeWords, words } from "../language/words.ts";
import { clockAt, clockTime } from "../night/time.ts";
import type { Place, ViewState } from "../state/view-state.ts";
import { cloudsTitle } from "./clouds.ts";
import { coordinates, fixed, magnitude } from "./format.ts";
import { lampTitle } from "./lamps.ts";
import { glowSentence, summaryOf } from "./summary.ts";

export interface Captioned {
  place: Place;
  name: string;
  scene: Pick<Scene, "title" | "attribution" | "date" | "illustrative">;
  answer: SkyAnswer;
  shares: Shares | null;
}

/** The time with its date and clock; without one, that there is none. */
export function timeWithClock(time: string | null, { longitude_deg }: Place): string {
  if (time === null) return placeWords().time.noneTold;
  const atMs = Date.parse(time);
  const clock = clockAt(atMs, longitude_deg);
  const date = new Date(atMs + clock.offsetMinutes * 60_000).toISOString().slice(0, 10);
  return `${date} ${clockTime(atMs, clock)} ${clock.name}`;
}

/** The lines below the picture; the first names the place. */
export function captionLines(
  { place, name, scene, answer, shares }: Captioned,
  {
    time,
    lamp,
    clouds,
    cloudCover,
    scenario,
    lights,
    land,
  }: Pick<ViewState, "time" | "lamp" | "clouds" | "cloudCover" | "scenario" | "lights" | "land">,
): string[] {
  const say = { ...words(), ...placeWords() };
  const at = coordinates(place.latitude_deg, place.longitude_deg);
  const { sky } = answer;
  const bortle = sky.bortle_class == null ? [] : [`${say.numbers.bortleClass} ${sky.bortle_class}`];
  const total = `${say.numbers.zenithTotal} ${magnitude(sky.zenith_total_brightness_mag_arcsec2 ?? null)} mag/arcsec²`;
  const changed = scenario?.startsWith("p-") === true ? say.sky.withPlan : say.sky.asPainted;
  const assumed = [
    ...(scenario === null || lights === "today" ? [] : [changed]),
    `${say.assumptions.turbidity} ${fixed(answer.turbidity, 1)}`,
    `${say.assumptions.lamps}: ${lampTitle(lamp)}`,
    `${say.assumptions.clouds}: ${cloudsTitle(clouds, cloudCover / 100)}`,
    ...(land === "snow" ? [`${say.sky.land}: ${say.sky.landSnow}`] : []),
    ...(land === "water" ? [`${say.sky.land}: ${say.sky.landWater}`] : []),
  ];
  const illustrative = scene.illustrative && !/illustrative/i.test(scene.attribution ?? "") ? say.scene.illustrative : "";
  const credit = ["Skyglow", scene.title, scene.date ?? "", scene.attribution ?? "", illustrative];
  return [
    name === at ? at : `${name} · ${at}`,
    `${timeWithClock(time, place)} · ${[total, ...bortle].join(" · ")}`,
    [...summaryOf(answer), shares === null ? "" : glowSentence(answer, shares)].join(" ").trim(),
    assumed.join(" · "),
    credit.filter((part) => part !== "").join(" · "),
  ].filter((line) => line !== "");
}

/** The words of a text in lines that are no wider than this. */
export function wrapped(text: string, maxPx: number, widthPx: (text: string) => number): string[] {
  const lines: string[] = [];
  for (const word of text.split(" ")) {
    const longer = `${lines.at(-1) ?? ""} ${word}`.trim();
    if (lines.length > 0 && widthPx(longer) <= maxPx) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

const MARGIN_PX = 24;

/** A picture, the lines below it, and what stands upon it; "" is nothing. */
export interface Frame {
  picture: Blob;
  lines: readonly string[];
  label: string;
}

/** Pictures with their captions, as PNGs of one size. */
export async function captioned(frames: readonly Frame[]): Promise<Blob[]> {
  const drawn = await Promise.all(frames.map(drawing));
  const heightPx = Math.max(...drawn.map(({ heightPx }) => heightPx));
  return Promise.all(drawn.map(({ draw }) => draw(heightPx)));
}

async function drawing({ picture, lines, label }: Frame): Promise<{ heightPx: number; draw: (heightPx: number) => Promise<Blob> }> {
  const image = await createImageBitmap(picture);
  const { width } = image;
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d");
  if (context === null) throw new Error(words().problems.headline);
  const sizePx = Math.max(Math.round(width / 72), 13);
  const fontOf = (i: number) => `${i === 0 ? 650 : 450} ${i === 0 ? Math.round(1.35 * sizePx) : sizePx}px system-ui, sans-serif`;
  const rows = lines.flatMap((line, i) => {
    context.font = fontOf(i);
    return wrapped(line, width - 2 * MARGIN_PX, (text) => context.measureText(text).width).map((text) => ({ text, i }));
  });
  const rowPx = Math.round(1.6 * sizePx);
  const draw = (heightPx: number) => {
    canvas.width = width;
    canvas.height = heightPx;
    context.fillStyle = "#0c1120";
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(image, 0, 0);
    context.textBaseline = "middle";
    rows.forEach(({ text, i }, row) => {
      context.font = fontOf(i);
      context.fillStyle = i === 0 ? "#ffffff" : i === lines.length - 1 ? "#93a0c0" : "#dde4f5";
      context.fillText(text, MARGIN_PX, image.height + MARGIN_PX + (row + 0.5) * rowPx);
    });
    if (label !== "") drawLabel(context, label, Math.round(1.6 * sizePx));
    return new Promise<Blob>((resolve, reject) => {
      canvas.toBlob((blob) => (blob === null ? reject(new Error(words().problems.headline)) : resolve(blob)), "image/png");
    });
  };
  return { heightPx: image.height + rows.length * rowPx + 2 * MARGIN_PX, draw };
}

/** A plate in the upper left corner that says what the picture shows. */
function drawLabel(context: CanvasRenderingContext2D, label: string, sizePx: number): void {
  context.font = `650 ${sizePx}px system-ui, sans-serif`;
  const [paddingPx, heightPx] = [0.7 * sizePx, 2 * sizePx];
  context.fillStyle = "#0c1120cc";
  context.beginPath();
  context.roundRect(MARGIN_PX, MARGIN_PX, context.measureText(label).width + 2 * paddingPx, heightPx, 0.4 * sizePx);
  context.fill();
  context.fillStyle = "#ffffff";
  context.fillText(label, MARGIN_PX + paddingPx, MARGIN_PX + 0.5 * heightPx);
}
