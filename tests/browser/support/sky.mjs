// What the API says of a place, to hold the viewer's display against.
import { getJson } from "./browser.mjs";

/** The demo scene, its largest town, and a place 30 km or so beside it that lies inside the scene. */
export async function demo() {
  const scenes = await getJson("scenes");
  const scene = scenes.find(({ id }) => id === (process.env.SKYGLOW_SCENE ?? "demo")) ?? scenes[0];
  const places = await getJson(`scenes/${scene.id}/places`);
  const town = [...places].sort((a, b) => (b.population ?? 0) - (a.population ?? 0))[0];
  const [west, south, east, north] = scene.bounds;
  const middle = { latitude_deg: (south + north) / 2, longitude_deg: (west + east) / 2 };
  const towards = (from, to) => from + Math.sign(to - from || 1) * 0.25;
  const beside = {
    latitude_deg: +towards(town.latitude_deg, middle.latitude_deg).toFixed(4),
    longitude_deg: +towards(town.longitude_deg, middle.longitude_deg).toFixed(4),
  };
  const outside = { latitude_deg: north > 80 ? south - 2 : north + 2, longitude_deg: middle.longitude_deg };
  return { scenes, scene, places, town, beside, outside };
}

export function skyPath(scene, kind, { latitude_deg, longitude_deg }, more = "") {
  return `scenes/${scene.id}/${kind}?lat=${latitude_deg}&lon=${longitude_deg}${more}`;
}

/** What is seen of artificial light at the sample nearest to a direction, with that sample's direction. */
export function sample(panorama, azimuthDeg, elevationDeg) {
  const { grid, values } = panorama;
  const column =
    Math.round((azimuthDeg - grid.azimuth_first_deg) / grid.azimuth_step_deg + grid.azimuth_count) % grid.azimuth_count;
  const wanted = Math.round((elevationDeg - grid.elevation_first_deg) / grid.elevation_step_deg);
  const row = Math.min(Math.max(wanted, 0), grid.elevation_count - 1);
  return {
    azimuth_deg: grid.azimuth_first_deg + column * grid.azimuth_step_deg,
    elevation_deg: grid.elevation_first_deg + row * grid.elevation_step_deg,
    luminance_cd_m2: values[row][column],
  };
}

/** The viewer reads the compact panorama, which keeps each value to this part of itself. */
export const COMPACT_ERROR = 2.5e-4;
