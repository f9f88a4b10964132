// Addresses of pictures of the sky, as the page shows it.

import { type SkyParameters, urlOf } from "../api/client.ts";
import { isOfLight } from "../sky/colour-maps.ts";
import { gazeOf, viewedPart } from "../sky/gaze.ts";
import { scaleEndsIn } from "../sky/scale.ts";
import { unitFor } from "../sky/units.ts";
import { type AppState, landOf, seenOf, withCloudPattern } from "../state/app-state.ts";

type PictureQuery = Parameters<typeof urlOf<"/api/v1/scenes/{scene}/panorama.png">>[2];
/** How it differs from what the page shows. */
export type PictureMore = Partial<Pick<PictureQuery, "width" | "height_px" | "legend" | "adaptation" | "dynamic_range">>;
/** Both without loss; WebP in fewer bytes, PNG for every program. */
type Format = "png" | "webp";

/** A sky as it is shown here, as a picture from the API. */
export function pictureUrl(
  scene: string,
  parameters: SkyParameters,
  state: Readonly<AppState>,
  more: PictureMore = {},
  format: Format = "png",
): string {
  const view = state.projection === "perspective" ? viewedPart(gazeOf(state.gaze, state.panorama), state.skyAspect) : null;
  const { projection, sky, colours, exposureEv } = state;
  const seen = seenOf(state);
  const [faintest, brightest] = scaleEndsIn(seen.unit);
  const byValue = unitFor(state.unit, seen) === "luminance" || !seen.hasMagnitude;
  const scale = byValue
    ? ({ scale: "luminance", min: String(faintest), max: String(brightest) } as const)
    : ({ scale: "magnitude" } as const);
  const kept = colours === "eye" && state.adaptationCdM2 !== null ? { adaptation: state.adaptationCdM2 } : {};
  const land = landOf(state, state.scenes.find(({ id }) => id === scene) ?? null);
  const ground = land === "dark" ? {} : { ground: land };
  const style = isOfLight(colours)
    ? ({ style: colours, exposure: exposureEv, ...kept, ...ground } as const)
    : { colormap: colours, ...scale };
  const picture = { ...withCloudPattern(parameters), projection, ...view, sky, ...style, ...more } as const;
  return urlOf(`/api/v1/scenes/{scene}/panorama.${format}`, { scene }, picture);
}
