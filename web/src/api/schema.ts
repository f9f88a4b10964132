// Made from server/http/openapi.json by scripts/generate_api_types.mjs; do not edit.

export type Assumptions = {
  scene: SceneReference;
  observer: ObserverAnswer;
  /** Covered share of the disc of 300 km around the place; light outside the raster is unknown, not absent. */
  coverage: number;
  /** Factor on the raster's radiances. */
  calibration: number;
  /** Turbidity at sea level. */
  turbidity: number;
  /** Vertical optical depth above the observer in R, G, B. */
  local_optical_depth: [number, number, number];
  /** `single` or `multiple`. */
  scattering: string;
  lamp: LampAnswer;
  emission: EmissionAnswer;
  /** `none`: clouds are not modelled yet. */
  clouds: string;
  /** Whether terrain hides lights and sky: not yet. */
  terrain_occlusion: boolean;
  /** Upward flux within 300 km, DNB watts, calibration included. */
  flux_dnb_w: number;
  /** Basis functions used. */
  basis_count: number;
  /** What rendered: `gpu`, `lavapipe` or `cpu`. */
  executor: string;
};

export type AtmosphereAnswer = {
  /** Its turbidity. */
  turbidity: number;
  /** `single` or `multiple`. */
  scattering: string;
  /** Wavelengths of the bands, nm. */
  bands_nm: number[];
  /** Lowest and highest observer altitude, metres. */
  observer_altitude_m: [number, number];
  /** Lowest and highest source altitude, metres. */
  source_altitude_m: [number, number];
  /** Nearest and farthest source, metres. */
  distance_m: [number, number];
  /** Basis functions. */
  basis_count: number;
  /** Checksum of the pack. */
  checksum: string;
  /** Measured relative error of the images of single sources. */
  measured_error?: Record<string, unknown> | null;
};

export type EmissionAnswer = {
  /** cos ψ / π. */
  lambert: number;
  /** Garstang's low-angle term. */
  horizon: number;
  /** Falchi's third function. */
  oblique: number;
};

export type FieldError = {
  /** Its name. */
  parameter: string;
  /** Its value as it came; absent where the parameter is missing. */
  value?: string | null;
  /** What is allowed. */
  allowed: string;
  /** What is wrong with it. */
  message: string;
  code: Mistake;
};

export type GridAnswer = {
  /** Columns. */
  width: number;
  /** Rows. */
  height: number;
  /** GDAL's six coefficients. */
  geotransform: [number, number, number, number, number, number];
  /** The CRS as WKT. */
  crs_wkt: string;
};

export type HealthAnswer = {
  /** `ok`, or `starting` while tables or device are not ready. */
  status: string;
  /** What renders: `gpu`, `lavapipe` or `cpu`. */
  executor?: string | null;
};

export type LampAnswer = {
  /** The preset's name, or null for a custom lamp. */
  preset?: string | null;
  /** Flux in R, G, B per flux weighted by the satellite's response. A satellite sees no blue: the lamp is an assumption. */
  flux_per_dnb_flux: [number, number, number];
};

export type Light = "artificial" | "total";

export type Mistake = "unknown_parameter" | "missing" | "repeated" | "malformed" | "not_allowed" | "conflict" | "out_of_range" | "not_resident" | "not_supported_yet";

export type ObserverAnswer = {
  /** Degrees north. */
  latitude_deg: number;
  /** Degrees east. */
  longitude_deg: number;
  /** Altitude of the eye above sea level, metres. */
  altitude_m: number;
  /** Altitude of the ground, metres; null without terrain. */
  terrain_altitude_m?: number | null;
};

export type PanoramaAnswer = Assumptions & {
  grid: PanoramaGrid;
  /** Wavelengths of the bands R, G, B, nm. */
  bands_nm: [number, number, number];
  /** Unit of the samples. */
  unit: string;
  light: Light;
  /** `radiance[band][row][column]`. */
  radiance: number[][][];
  /** Elevation below which the terrain hides the sky, by column, degrees: 0 everywhere while `terrain_occlusion` is false. */
  horizon_deg: number[];
  sky: QuantitiesAnswer;
};

export type PanoramaGrid = {
  /** Columns. */
  azimuth_count: number;
  /** Rows. */
  elevation_count: number;
  /** Azimuth of column 0, degrees clockwise from north. */
  azimuth_first_deg: number;
  /** Degrees from column to column. */
  azimuth_step_deg: number;
  /** Elevation of row 0, the lowest, degrees. */
  elevation_first_deg: number;
  /** Degrees from row to row. */
  elevation_step_deg: number;
};

export type PlaceAnswer = {
  /** Its name. */
  name: string;
  /** Degrees north. */
  latitude_deg: number;
  /** Degrees east, −180..180. */
  longitude_deg: number;
  /** Inhabitants, where known. */
  population?: number | null;
};

export type Problem = {
  /** Stable name of the kind of problem, such as `/problems/unknown-parameter`. */
  type: string;
  /** The kind in words. */
  title: string;
  /** The status code. */
  status: number;
  /** What is wrong with this request, and what would help. */
  detail: string;
  /** Every bad parameter. */
  errors: FieldError[];
  /** West, south, east, north of the scene, degrees, where the place lies outside it. */
  bounds?: [number, number, number, number] | null;
};

export type QuantitiesAnswer = {
  /** Mean within 5° of the zenith, cd m⁻². */
  zenith_luminance_cd_m2: number;
  /** The same, mag arcsec⁻². */
  zenith_brightness_mag_arcsec2?: number | null;
  /** With the natural sky, cd m⁻². */
  zenith_total_luminance_cd_m2: number;
  /** With the natural sky, mag arcsec⁻². */
  zenith_total_brightness_mag_arcsec2: number;
  /** Artificial over natural luminance at the zenith. */
  ratio_to_natural: number;
  /** As a Sky Quality Meter at the zenith sees it (Gaussian, FWHM 20°), cd m⁻². */
  sqm_luminance_cd_m2: number;
  /** What such a meter reads with the natural sky, mag arcsec⁻². */
  sqm_total_brightness_mag_arcsec2: number;
  /** Mean over the upper hemisphere, cd m⁻². */
  mean_luminance_cd_m2: number;
  /** Horizontal illuminance, lx. */
  horizontal_illuminance_lx: number;
  /** With the natural sky, lx. */
  horizontal_total_illuminance_lx: number;
  /** Largest luminance, cd m⁻². */
  brightest_luminance_cd_m2: number;
  /** Its azimuth, degrees clockwise from north. */
  brightest_azimuth_deg: number;
  /** Its elevation, degrees. */
  brightest_elevation_deg: number;
  /** Bortle class of the total at the zenith, 1..=9. */
  bortle_class: number;
  /** Naked-eye limiting magnitude at the zenith (Crumey 2014, F = 2). */
  naked_eye_limit_mag: number;
  /** Radiance at the zenith in R, G, B, W m⁻² sr⁻¹. */
  zenith_radiance_w_m2_sr: [number, number, number];
};

export type SceneAnswer = {
  /** Its name in URLs. */
  id: string;
  /** Its name for people. */
  title: string;
  /** West, south, east, north, degrees; west > east across the antimeridian. */
  bounds: [number, number, number, number];
  grid: GridAnswer;
  /** Short name of the CRS. */
  crs: string;
  /** Factor on the raster's radiances. */
  calibration: number;
  /** What the ingest saw: counts of lit, zero, negative, NaN, no-data and capped pixels with examples, the range, terrain under the lights, warnings. */
  report: Record<string, unknown>;
  /** Side of a square with the area of the middle pixel, metres. */
  pixel_size_m: number;
  /** Pixels with light. */
  lit_pixels: number;
  /** When the radiances were taken. */
  date?: string | null;
  /** Whom to credit. */
  attribution?: string | null;
  /** True for made-up light that only shows what the program does. */
  illustrative: boolean;
  /** Whether the scene has terrain. */
  terrain: boolean;
  /** Number of named places. */
  places_count: number;
  /** Hash over all that the scene holds. */
  version: string;
};

export type SceneReference = {
  /** Its name in URLs. */
  id: string;
  /** Hash over all that it holds. */
  version: string;
  /** True for made-up light. */
  illustrative: boolean;
  /** Whom to credit. */
  attribution?: string | null;
};

export type SiteAnswer = {
  scene: SceneReference;
  /** Degrees north. */
  latitude_deg: number;
  /** Degrees east. */
  longitude_deg: number;
  /** Altitude of the ground, metres, at least 0; null without terrain. */
  terrain_altitude_m?: number | null;
  /** Radiance of the raster's pixel there, nW cm⁻² sr⁻¹; 0 where dark, null without data. */
  radiance_nw_cm2_sr?: number | null;
  /** Factor on the raster's radiances (not in `radiance_nw_cm2_sr`). */
  calibration: number;
  /** West, south, east, north of the scene, degrees. */
  bounds: [number, number, number, number];
};

export type SkyAnswer = Assumptions & {
  sky: QuantitiesAnswer;
};

export type TileJson = {
  /** `3.0.0`. */
  tilejson: string;
  /** The layer. */
  name: string;
  /** What the colours mean. */
  description: string;
  /** Whom to credit. */
  attribution?: string | null;
  /** The scene's version. */
  version: string;
  /** `xyz`. */
  scheme: string;
  /** URL templates with `{z}`, `{x}`, `{y}`. */
  tiles: string[];
  /** Lowest zoom level. */
  minzoom: number;
  /** Highest zoom level with detail of its own. */
  maxzoom: number;
  /** West, south, east, north, degrees. */
  bounds: [number, number, number, number];
  /** Longitude, latitude and zoom level to start at. */
  center: [number, number, number];
};

/** Everything that GET answers: by path, what it takes and what comes back. */
export interface Gets {
  "/api/docs": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: Blob;
  };
  "/api/v1/atmospheres": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: AtmosphereAnswer[];
  };
  "/api/v1/scenes": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: SceneAnswer[];
  };
  "/api/v1/scenes/{scene}/panorama.exr": {
    path: {
      scene: string;
    };
    query: {
      lat: number;
      lon: number;
      height?: number;
      altitude?: number;
      turbidity?: number;
      scattering?: "single" | "multiple";
      lamp?: string;
      emission?: string;
      basis?: number;
      clouds?: string;
      terrain?: "on" | "off";
      tolerance?: string;
      sky?: "artificial" | "total";
      scenario?: string;
      projection?: "equirectangular" | "fisheye" | "perspective";
      azimuth?: number;
      elevation?: number;
      fov?: number;
      style?: "false_colour" | "realistic";
      colormap?: "inferno" | "magma" | "plasma" | "viridis" | "cividis" | "grey";
      scale?: "luminance" | "magnitude";
      min?: string;
      max?: string;
      exposure?: number;
      width?: number;
      height_px?: number;
      legend?: "on" | "off";
    };
    answer: Blob;
  };
  "/api/v1/scenes/{scene}/panorama.json": {
    path: {
      scene: string;
    };
    query: {
      lat: number;
      lon: number;
      height?: number;
      altitude?: number;
      turbidity?: number;
      scattering?: "single" | "multiple";
      lamp?: string;
      emission?: string;
      basis?: number;
      clouds?: string;
      terrain?: "on" | "off";
      tolerance?: string;
      sky?: "artificial" | "total";
      scenario?: string;
      projection?: "equirectangular" | "fisheye" | "perspective";
      azimuth?: number;
      elevation?: number;
      fov?: number;
      style?: "false_colour" | "realistic";
      colormap?: "inferno" | "magma" | "plasma" | "viridis" | "cividis" | "grey";
      scale?: "luminance" | "magnitude";
      min?: string;
      max?: string;
      exposure?: number;
      width?: number;
      height_px?: number;
      legend?: "on" | "off";
    };
    answer: PanoramaAnswer;
  };
  "/api/v1/scenes/{scene}/panorama.png": {
    path: {
      scene: string;
    };
    query: {
      lat: number;
      lon: number;
      height?: number;
      altitude?: number;
      turbidity?: number;
      scattering?: "single" | "multiple";
      lamp?: string;
      emission?: string;
      basis?: number;
      clouds?: string;
      terrain?: "on" | "off";
      tolerance?: string;
      sky?: "artificial" | "total";
      scenario?: string;
      projection?: "equirectangular" | "fisheye" | "perspective";
      azimuth?: number;
      elevation?: number;
      fov?: number;
      style?: "false_colour" | "realistic";
      colormap?: "inferno" | "magma" | "plasma" | "viridis" | "cividis" | "grey";
      scale?: "luminance" | "magnitude";
      min?: string;
      max?: string;
      exposure?: number;
      width?: number;
      height_px?: number;
      legend?: "on" | "off";
    };
    answer: Blob;
  };
  "/api/v1/scenes/{scene}/panorama.tif": {
    path: {
      scene: string;
    };
    query: {
      lat: number;
      lon: number;
      height?: number;
      altitude?: number;
      turbidity?: number;
      scattering?: "single" | "multiple";
      lamp?: string;
      emission?: string;
      basis?: number;
      clouds?: string;
      terrain?: "on" | "off";
      tolerance?: string;
      sky?: "artificial" | "total";
      scenario?: string;
      projection?: "equirectangular" | "fisheye" | "perspective";
      azimuth?: number;
      elevation?: number;
      fov?: number;
      style?: "false_colour" | "realistic";
      colormap?: "inferno" | "magma" | "plasma" | "viridis" | "cividis" | "grey";
      scale?: "luminance" | "magnitude";
      min?: string;
      max?: string;
      exposure?: number;
      width?: number;
      height_px?: number;
      legend?: "on" | "off";
    };
    answer: Blob;
  };
  "/api/v1/scenes/{scene}/places": {
    path: {
      scene: string;
    };
    query: Record<string, never>;
    answer: PlaceAnswer[];
  };
  "/api/v1/scenes/{scene}/site": {
    path: {
      scene: string;
    };
    query: {
      lat: number;
      lon: number;
    };
    answer: SiteAnswer;
  };
  "/api/v1/scenes/{scene}/sky": {
    path: {
      scene: string;
    };
    query: {
      lat: number;
      lon: number;
      height?: number;
      altitude?: number;
      turbidity?: number;
      scattering?: "single" | "multiple";
      lamp?: string;
      emission?: string;
      basis?: number;
      clouds?: string;
      terrain?: "on" | "off";
      tolerance?: string;
      sky?: "artificial" | "total";
      scenario?: string;
    };
    answer: SkyAnswer;
  };
  "/api/v1/scenes/{scene}/tiles/{layer}/tilejson.json": {
    path: {
      scene: string;
      layer: string;
    };
    query: Record<string, never>;
    answer: TileJson;
  };
}
