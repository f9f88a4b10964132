// A stand-in for the Skyglow server, to work on the viewer without one: `npm run mock`, then http://127.0.0.1:8090.
// It speaks the API's form with made-up physics, under the same strict content security policy.
import { createReadStream, existsSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { compact } from "./compact.mjs";
import { nightOf, nightSkyAt } from "./night.mjs";
import { darkerThan, hoursOf, sharesOf, worldPlaces } from "./places.mjs";
import { COLUMNS, LAMPS, NATURAL, quantities, RESPONSES, ROWS, radiance, TOWNS } from "./sky.mjs";
import { tile } from "./tiles.mjs";

const dist = join(dirname(fileURLToPath(import.meta.url)), "../../../web/dist");
const port = Number(process.env.PORT ?? 8090);
const bounds = [33.5, -5, 42, 5];
const scene = {
  id: "demo",
  title: "Kenya, made up",
  bounds,
  date: "2023",
  attribution: "Skyglow mock",
  illustrative: true,
  terrain: true,
  version: "0",
  calibration: 1,
};
const TYPES = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".css": "text/css",
  ".json": "application/json",
  ".svg": "image/svg+xml",
};

function problem(response, status, title, detail, errors = []) {
  response.writeHead(status, { "content-type": "application/problem+json" });
  response.end(JSON.stringify({ type: "about:blank", title, status, detail, errors }));
}

/** The terrain of the mock has a gap in the far south. */
const GAP_NORTH_DEG = -4;
function warnings({ latitude_deg }) {
  return latitude_deg < GAP_NORTH_DEG
    ? ["the terrain has no data within 5 km of this place: the ground is taken at sea level"]
    : [];
}

function answer(query) {
  const place = { latitude_deg: Number(query.get("lat")), longitude_deg: Number(query.get("lon")) };
  const turbidity = Number(query.get("turbidity") ?? 2.5);
  const lamp = LAMPS[query.get("lamp") ?? "mixed"];
  if (lamp === undefined)
    return {
      errors: [{ parameter: "lamp", value: query.get("lamp"), allowed: Object.keys(LAMPS).join(", "), message: "is not allowed" }],
    };
  const response = query.get("response") ?? "photopic";
  if (RESPONSES[response] === undefined)
    return {
      errors: [{ parameter: "response", value: response, allowed: Object.keys(RESPONSES).join(", "), message: "is not allowed" }],
    };
  if (!(turbidity >= 1.5 && turbidity <= 6))
    return { errors: [{ parameter: "turbidity", value: String(turbidity), allowed: "1.5 to 6", message: "is out of range" }] };
  const scattering = query.get("scattering") ?? "multiple";
  const brighter = scattering === "multiple" ? 1.3 : 1;
  const sky = radiance(
    place,
    turbidity,
    lamp.map((flux) => flux * brighter),
  );
  return {
    sky,
    common: {
      observer: { ...place, altitude_m: 1702, terrain_altitude_m: 1700 },
      sky: quantities(sky),
      coverage: 0.87,
      calibration: 1,
      turbidity,
      lamp: { preset: query.get("lamp") ?? "mixed", scotopic_photopic_ratio: 1.18, colour_temperature_k: 2769 },
      response: { name: response, unit: RESPONSES[response].unit },
      scattering,
      clouds: "none",
      ground_albedo: scattering === "multiple" ? 0.15 : null,
      local_optical_depth: [0.06, 0.12, 0.19, 0.31],
      dark_reference: { luminance_cd_m2: NATURAL, value: RESPONSES[response].natural, chromaticity: [0.36, 0.37] },
      warnings: warnings(place),
      ...(query.has("time") ? { night_sky: nightSkyAt(query.get("time"), place) } : {}),
    },
  };
}

function api(path, query, response) {
  const json = (body) => {
    response.writeHead(200, { "content-type": "application/json" });
    response.end(JSON.stringify(body));
  };
  const within = () => {
    const [lat, lon] = [Number(query.get("lat")), Number(query.get("lon"))];
    if (lon >= bounds[0] && lon <= bounds[2] && lat >= bounds[1] && lat <= bounds[3]) return true;
    problem(
      response,
      404,
      "The place lies outside the scene",
      `The scene reaches from ${bounds[0]}° to ${bounds[2]}° east and ${bounds[1]}° to ${bounds[3]}° north.`,
    );
    return false;
  };
  if (path === "night") return json(nightOf(query.get("date"), Number(query.get("lat")), Number(query.get("lon"))));
  if (path === "scenes") return json([scene]);
  if (path === "basemap")
    return json({ tilejson: "3.0.0", tiles: [], attribution: "", minzoom: 0, maxzoom: 0, bounds: [0, 0, 0, 0], layers: [] });
  if (path === "atmospheres")
    return json(
      ["single", "multiple"].flatMap((scattering) => [1.5, 6].map((turbidity) => ({ scattering, turbidity, cloud_base_m: null }))),
    );
  if (path === "scenes/demo/places") return json(TOWNS);
  if (path === "places") return json(worldPlaces(query.get("name")));
  const about = { latitude_deg: Number(query.get("lat")), longitude_deg: Number(query.get("lon")) };
  if (path === "scenes/demo/shares") return json(sharesOf(about, query.get("measure"), Number(query.get("limit") ?? 10)));
  if (path === "scenes/demo/darker") return json(darkerThan(about));
  if (path === "scenes/demo/night") return json(hoursOf(about, query.get("date")));
  if (path === "scenes/demo/site") {
    const place = { latitude_deg: Number(query.get("lat")) };
    if (within()) json({ terrain_altitude_m: 1700, radiance_nw_cm2_sr: 12.3, warnings: warnings(place) });
    return undefined;
  }
  if (path === "scenes/demo/sky" || path === "scenes/demo/panorama.sky") {
    if (!within()) return undefined;
    const { errors, sky, common } = answer(query);
    if (errors !== undefined) return problem(response, 422, "A parameter is out of range", "See errors.", errors);
    if (path.endsWith("/sky")) return json(common);
    const grid = {
      azimuth_count: COLUMNS,
      elevation_count: ROWS,
      azimuth_first_deg: 0,
      azimuth_step_deg: 360 / COLUMNS,
      elevation_first_deg: 45 / ROWS,
      elevation_step_deg: 90 / ROWS,
    };
    response.writeHead(200, { "content-type": "application/vnd.skyglow.sky" });
    return response.end(compact({ ...common, grid }, sky));
  }
  const tiles =
    /^scenes\/demo\/tiles\/(radiance|elevation|brightness|influence)\/(?:(\d+)\/(\d+)\/(\d+)(?:@2x)?\.png|tilejson\.json)$/.exec(
      path,
    );
  if (tiles?.[2] === undefined && tiles !== null) {
    const [range, unit] = {
      radiance: [[0.2, 200], "nW cm-2 sr-1"],
      elevation: [null, "m"],
      brightness: [[1.71e-6, 6.84e-3], "cd m-2"],
      influence: [[1e-10, 1e-6], "cd m-2"],
    }[tiles[1]];
    return json({
      tilejson: "3.0.0",
      description: tiles[1],
      range,
      unit,
      ...(tiles[1] === "brightness" ? { natural: NATURAL } : {}),
      ready: true,
      tiles: [`/api/v1/scenes/demo/tiles/${tiles[1]}/{z}/{x}/{y}.png`],
      tileSize: 256,
      minzoom: 0,
      maxzoom: 9,
      bounds,
    });
  }
  if (tiles !== null) {
    response.writeHead(200, { "content-type": "image/png" });
    return response.end(tile(tiles[1], Number(tiles[2]), Number(tiles[3]), Number(tiles[4])));
  }
  return problem(response, 404, "Nothing is here", path);
}

createServer((request, response) => {
  const url = new URL(request.url ?? "/", "http://127.0.0.1");
  response.setHeader(
    "content-security-policy",
    "default-src 'self'; worker-src 'self' blob:; img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; frame-ancestors 'none'",
  );
  if (url.pathname.startsWith("/api/v1/")) return api(url.pathname.slice(8), url.searchParams, response);
  const path = join(dist, normalize(url.pathname === "/" ? "/index.html" : url.pathname));
  if (!path.startsWith(dist) || !existsSync(path) || !statSync(path).isFile())
    return problem(response, 404, "No such page", url.pathname);
  response.setHeader("content-type", TYPES[extname(path)] ?? "application/octet-stream");
  return createReadStream(path).pipe(response);
}).listen(port, "127.0.0.1", () => console.log(`http://127.0.0.1:${port}`));
