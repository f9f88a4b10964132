// What an embedded view shows of a state: a picture towards the brightest light, and where its words come from.

import type { SkyAnswer } from "../api/types.ts";
import type { AppState } from "../state/app-state.ts";
import type { PictureMore } from "../ui/picture-url.ts";

/** Shape of the frame that is offered. */
export const FRAME = { widthPx: 640, heightPx: 480 } as const;
/** Wide, with the ground along the lower edge. */
const GAZE = { elevationDeg: 22, fieldDeg: 58 } as const;
/** Shape of the picture; what the frame has no room for is cut off. */
const ASPECT = 16 / 9;
const WIDTHS_PX = [640, 1280, 1920] as const;

/** How wide a picture is asked for: of few widths, so that caches have it. */
export function pictureWidthPx(cssWidthPx: number, pixelRatio: number): number {
  const wantedPx = cssWidthPx * pixelRatio;
  return WIDTHS_PX.find((widthPx) => widthPx >= wantedPx) ?? WIDTHS_PX[WIDTHS_PX.length - 1] ?? 640;
}

/** The look of its picture: a strip all around would be too low for a frame. */
export function embeddedLook(state: Readonly<AppState>, { sky }: Pick<SkyAnswer, "sky">): AppState {
  if (state.projection === "fisheye") return state;
  const gaze = state.projection === "perspective" ? state.gaze : null;
  return {
    ...state,
    projection: "perspective",
    skyAspect: ASPECT,
    gaze: gaze ?? { azimuthDeg: sky.brightest_azimuth_deg, ...GAZE },
  };
}

/** Size of that picture. */
export function pictureSize({ projection }: Pick<AppState, "projection">, widthPx: number): PictureMore {
  return projection === "fisheye" ? { width: widthPx } : { width: widthPx, height_px: Math.round(widthPx / ASPECT) };
}

/** The full viewer at the same place, from the address of the embedded one. */
export function viewerUrl(embedUrl: string): string {
  const url = new URL("./", embedUrl);
  url.hash = new URL(embedUrl).hash;
  return url.href;
}

/** The embedded view of what the viewer shows, from its address. */
export function embedUrl(viewerAddress: string): string {
  const { hash } = new URL(viewerAddress);
  const url = new URL("./embed", viewerAddress);
  // What the frame has no use for.
  url.hash = hash.replace(/&(map|pins|report|measure|surface|region|split|radiance|brightness|influence|elevation)=[^&]*/g, "");
  return url.href;
}

function escaped(text: string): string {
  return text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

/** What to paste into a page. */
export function embedCode(viewerAddress: string, title: string): string {
  const source = escaped(embedUrl(viewerAddress));
  return `<iframe src="${source}" title="${escaped(title)}" width="${FRAME.widthPx}" height="${FRAME.heightPx}" style="border:0;max-width:100%" loading="lazy"></iframe>`;
}
