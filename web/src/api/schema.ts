// Made from the OpenAPI document by scripts/generate_api_types.mjs; do not edit.

/** What every number depends on. */
export type Assumptions = {
  /** Basis functions used. */
  basis_count: number;
  /** With `tolerance`: the relative difference to the sky of all basis functions is at most this, in the norm over the open sky and the worst band; 0 with all of them, null without `tolerance`. */
  basis_error_bound?: number | null;
  /** Factor on the raster's radiances. */
  calibration: number;
  /** Lambertian albedo of that base from below; null where there are no clouds. */
  cloud_albedo?: number | null;
  /** `none`, or the altitude of the base of a closed layer of cloud in metres above sea level. */
  clouds: string;
  /** Covered share of the disc of 300 km around the place; light outside the raster is unknown, not absent. */
  coverage: number;
  /** The emission. */
  emission: EmissionAnswer;
  /** What rendered: `gpu`, `lavapipe` or `cpu`. */
  executor: string;
  /** Upward flux within 300 km of the place, DNB watts, calibration included; that of the whole scene is `flux_dnb_w` in its report. */
  flux_within_300_km_dnb_w: number;
  /** Lambertian albedo of that ground; null where scattering is single. */
  ground_albedo?: number | null;
  /** Whether light counts only above the skyline that its source sees towards the observer: false where `terrain_occlusion` is, and where the scene or the packs know no skylines, which `warnings` then says. */
  hidden_lights: boolean;
  /** The lamp. */
  lamp: LampAnswer;
  /** Vertical optical depth above the observer in R, G, B. */
  local_optical_depth: number[];
  /** Where the observer is. */
  observer: ObserverAnswer;
  /** `single`: first order alone; `multiple`: all orders, with light that the ground sends back. */
  scattering: string;
  /** Id of the scenario or plan that changes its lights; null for the scene as it is. */
  scenario?: string | null;
  /** The scene. */
  scene: SceneReference;
  /** Whether terrain hides the sky below the observer's horizon: false with `terrain=off` and in a scene without terrain. */
  terrain_occlusion: boolean;
  /** Turbidity at sea level. */
  turbidity: number;
  /** What the numbers had to do without, one sentence each: light outside the raster, ground that the terrain does not have, skylines that the scene or the packs do not know, the natural sky behind clouds. */
  warnings: string[];
};

/** A resident table pack. */
export type AtmosphereAnswer = {
  /** Wavelengths of the bands, nm. */
  bands_nm: number[];
  /** Basis functions. */
  basis_count: number;
  /** Checksum of the pack. */
  checksum: string;
  /** Lambertian albedo of that base from below; null under a clear sky. */
  cloud_albedo?: number | null;
  /** Base of the closed layer of cloud above sea level, metres; null under a clear sky. */
  cloud_base_m?: number | null;
  /** Nearest and farthest source, metres. */
  distance_m: number[];
  /** Lambertian albedo of that ground; null where scattering is single. */
  ground_albedo?: number | null;
  /** Measured relative error of the images of single sources. */
  measured_error?: Record<string, unknown> | null;
  /** Lowest and highest observer altitude, metres. */
  observer_altitude_m: number[];
  /** `single`: first order alone; `multiple`: all orders, with light that the ground sends back. */
  scattering: string;
  /** Lowest and highest source altitude, metres. */
  source_altitude_m: number[];
  /** Its turbidity. */
  turbidity: number;
};

/** A stroke. */
export type BrushBody = {
  /** Longitude and latitude of its points, degrees: 1 to 1000. */
  points: [number, number][];
  /** Radius, 1 to 50 000 m. The pixels right under the stroke are painted however fine it is. */
  radius_m: number;
};

/** A pixel that is dimmed. */
export type DimmedPixelAnswer = {
  /** Column on the scene's raster, from 0. */
  column: number;
  /** Parts of this pixel and all before it in the list. */
  cumulative_effect: number;
  /** Part of its light that goes, 0 to 1. */
  cut: number;
  /** Its part of what the plan takes from the sites' measures, in the mean over the sites. */
  effect: number;
  /** Its upward flux today, DNB watts, calibration included. */
  flux_dnb_w: number;
  /** What of that goes. */
  flux_removed_dnb_w: number;
  /** Centre, degrees north. */
  latitude_deg: number;
  /** Centre, degrees east. */
  longitude_deg: number;
  /** And with the plan. */
  radiance_after_nw_cm2_sr: number;
  /** Its radiance today, nW cm⁻² sr⁻¹, without the calibration. */
  radiance_before_nw_cm2_sr: number;
  /** Place in the list, from 1: by `effect`. */
  rank: number;
  /** Row, the same way. */
  row: number;
};

/** An edit as it was understood. */
export type EditAnswer = {
  /** Radiance that is added, nW cm⁻² sr⁻¹. */
  add_radiance_nw_cm2_sr?: number | null;
  /** Its area as GeoJSON: a MultiPolygon, or of a stroke the MultiPoint of its points. */
  area: Record<string, unknown>;
  /** Weights of lambert, horizon and oblique; null for as before. */
  emission?: number[] | null;
  /** Factor on the lights that are there; null where light is added. */
  factor?: number | null;
  /** What stays the same when lamps are replaced: `luminous_flux` or `dnb_flux`. */
  keep?: string | null;
  /** New lamps: a preset's name, or fluxes in R, G, B. */
  lamp?: Record<string, unknown> | null;
  /** Which lamps they replace; null for all. */
  lamp_from?: string | null;
  /** Lit pixels in its area. */
  lit_pixels: number;
  /** Radius of the brush, metres; null for polygons. */
  radius_m?: number | null;
};

/** One edit: an area, and either a change of the lights there or new light. */
export type EditBody = {
  /** Radiance added to every pixel, lit or dark, nW cm⁻² sr⁻¹: instead of `factor`. */
  add_radiance_nw_cm2_sr?: number | null;
  brush?: BrushBody | null;
  emission?: FixtureBody | null;
  /** Factor on the radiance of the lights that are there, 0 to 1000. */
  factor?: number | null;
  lamp?: LampBody | null;
  /** A GeoJSON Polygon or MultiPolygon, or a Feature or FeatureCollection of such; this or `brush`. Pixels whose centre is inside are painted. */
  polygon?: Record<string, unknown> | null;
};

/** Weights of the emission lobes; they sum to 1. */
export type EmissionAnswer = {
  /** Garstang's low-angle term. */
  horizon: number;
  /** cos ψ / π. */
  lambert: number;
  /** Falchi's third function. */
  oblique: number;
};

/** One bad parameter. */
export type FieldError = {
  /** What is allowed. */
  allowed: string;
  /** The kind of mistake. */
  code: Mistake;
  /** What is wrong with it. */
  message: string;
  /** Its name. */
  parameter: string;
  /** Its value as it came; absent where the parameter is missing. */
  value?: string | null;
};

/** A preset's name, or three numbers. */
export type FixtureBody = string | number[];

/** A raster's grid. */
export type GridAnswer = {
  /** The CRS as WKT. */
  crs_wkt: string;
  /** GDAL's six coefficients. */
  geotransform: number[];
  /** Rows. */
  height: number;
  /** Columns. */
  width: number;
};

/** Whether the server lives or is ready. */
export type HealthAnswer = {
  /** What renders: `gpu`, `lavapipe` or `cpu`. */
  executor?: string | null;
  /** `ok`, or `starting` while tables or device are not ready. */
  status: string;
};

/** Which lights within 300 km cause a measure of a sky: the most influential pixels, and all by distance and direction. */
export type InfluenceAnswer = Assumptions & ({
  boundary?: PartAnswer | null;
  /** Lit pixels within 300 km. */
  lit_pixels: number;
  /** `norm`, `zenith`, `mean`, `horizontal` or `region`. */
  measure: string;
  /** The most influential pixels, the most first. */
  pixels: InfluentialPixel[];
  /** Solid angle of the visible directions in the region, sr; null for other measures. */
  region_sr?: number | null;
  /** All lights by distance. */
  rings: RingAnswer[];
  /** What the pixels' influences were multiplied by to add up to the sky's own value, which takes far lights in cells and blocks: 1 for `norm`. */
  scale: number;
  /** All lights by azimuth. */
  sectors: SectorAnswer[];
  /** Sum over all lights. For every measure but `norm` it is the sky's own value of it. */
  total: number;
  /** Unit of influences: `cd m-2`, `lx`, or `cd m-2 sr0.5` of the norm. */
  unit: string;
});

/** What a body may say beside the query. */
export type InfluenceBody = {
  /** An area, as a GeoJSON Polygon or MultiPolygon, or a Feature or FeatureCollection of such: how much of the measure comes from inside it. */
  boundary?: Record<string, unknown> | null;
  /** A closed curve on the sky, corner by corner as `[azimuth_deg, elevation_deg]`; instead of the query's `region`. */
  region?: [number, number][] | null;
};

/** A lit pixel and its part. */
export type InfluentialPixel = {
  /** Azimuth of the centre from the observer, degrees clockwise from north. */
  azimuth_deg: number;
  /** Column on the scene's raster, from 0, as its geotransform counts. */
  column: number;
  /** Parts of this pixel and all before it in the list. */
  cumulative_share: number;
  /** Distance of the centre along the ground, metres. */
  distance_m: number;
  /** Upward flux, DNB watts, calibration included. */
  flux_dnb_w: number;
  /** What the pixel does to the measure, in `unit`. */
  influence: number;
  /** Centre, degrees north. */
  latitude_deg: number;
  /** Centre, degrees east. */
  longitude_deg: number;
  /** The raster's radiance, nW cm⁻² sr⁻¹, without the calibration. */
  radiance_nw_cm2_sr: number;
  /** Place in the list, from 1. */
  rank: number;
  /** Row, the same way. */
  row: number;
  /** Its part of `total`. */
  share: number;
};

/** A lamp. */
export type LampAnswer = {
  /** Flux in R, G, B per flux weighted by the satellite's response. A satellite sees no blue: the lamp is an assumption. */
  flux_per_dnb_flux: number[];
  /** The preset's name, or null for a custom lamp. */
  preset?: string | null;
};

/** Lamps. */
export type LampBody = FixtureBody | ReplaceBody;

/** A value of an influence. */
export type LevelBody = number | string;

/** Which light. */
export type Light = "artificial" | "total";

/** Kinds of mistakes in parameters. */
export type Mistake = "unknown_parameter" | "missing" | "repeated" | "malformed" | "not_allowed" | "conflict" | "out_of_range" | "not_resident";

/** Where the observer is. */
export type ObserverAnswer = {
  /** Altitude of the eye above sea level, metres. */
  altitude_m: number;
  /** Degrees north. */
  latitude_deg: number;
  /** Degrees east. */
  longitude_deg: number;
  /** Altitude of the ground, metres, at least 0: where the terrain has a gap, that of the nearest terrain within 5 km; null where there is none, then 0 counts. */
  terrain_altitude_m?: number | null;
};

/** A panorama's samples and numbers. */
export type PanoramaAnswer = Assumptions & {
  /** Wavelengths of the bands R, G, B, nm. */
  bands_nm: number[];
  /** Where the samples are. */
  grid: PanoramaGrid;
  /** Elevation below which the terrain hides the sky, by column, degrees, 0 to 90: 0 everywhere where `terrain_occlusion` is false. */
  horizon_deg: number[];
  /** Which light the samples hold: `artificial` or `total`. */
  light: Light;
  /** `radiance[band][row][column]`; 0 below the horizon, whichever light. */
  radiance: number[][][];
  /** The numbers. */
  sky: QuantitiesAnswer;
  /** Unit of the samples. */
  unit: string;
};

/** The grid of a panorama. */
export type PanoramaGrid = {
  /** Columns. */
  azimuth_count: number;
  /** Azimuth of column 0, degrees clockwise from north. */
  azimuth_first_deg: number;
  /** Degrees from column to column. */
  azimuth_step_deg: number;
  /** Rows. */
  elevation_count: number;
  /** Elevation of row 0, the lowest, degrees. */
  elevation_first_deg: number;
  /** Degrees from row to row. */
  elevation_step_deg: number;
};

/** Some lights together. */
export type PartAnswer = {
  /** Their upward flux, DNB watts, calibration included. */
  flux_dnb_w: number;
  /** Sum of their influences, in `unit`. */
  influence: number;
  /** Number of lit pixels. */
  pixels: number;
  /** Their part of `total`. */
  share: number;
};

/** A named place. */
export type PlaceAnswer = {
  /** Degrees north. */
  latitude_deg: number;
  /** Degrees east, −180..180. */
  longitude_deg: number;
  /** Its name. */
  name: string;
  /** Inhabitants, where known. */
  population?: number | null;
};

/** A plan. Its facts are those of the time when it was made. */
export type PlanAnswer = PlanFacts & {
  /** When it was made, RFC 3339 UTC. */
  created: string;
  /** Its id, which every query takes as `scenario`. */
  id: string;
  /** The pixels that are dimmed, those with the most effect first. */
  pixels: DimmedPixelAnswer[];
};

/** What is to be dimmed for whose sake. */
export type PlanBody = {
  /** Of `threshold`: the part of the most influential lights that goes, 0 to 1; the default is 1. */
  gamma?: number | null;
  /** Of `target`: the largest part of a light that may go, 0 to 1; the default is 1. */
  max_cut?: number | null;
  /** Of `threshold`: `norm`, `zenith`, `mean`, `horizontal` or `region`; the default is `region` where one is given, else `zenith`. */
  measure?: string | null;
  /** `threshold` or `target`. */
  method: string;
  /** Of `target`: lights in these polygons are left alone. */
  protect?: Record<string, unknown> | null;
  q_a?: LevelBody | null;
  q_b?: LevelBody | null;
  /** A closed curve on the sky, corner by corner as `[azimuth_deg, elevation_deg]`; instead of the query's `region`. */
  region?: [number, number][] | null;
  site?: SiteBody | null;
  /** Of `target`: 1 to 16 sites with what each wants. */
  sites?: SiteBody[] | null;
};

/** A plan in a list. */
export type PlanEntry = {
  /** When it was made, RFC 3339 UTC. */
  created: string;
  /** Upward flux that goes, DNB watts. */
  flux_removed_dnb_w: number;
  /** Part of the flux within reach. */
  flux_removed_share: number;
  /** Its id, which every query takes as `scenario`. */
  id: string;
  /** `threshold` or `target`. */
  method: string;
  /** Number of its sites. */
  site_count: number;
};

/** All that is said of a plan but its pixels. It is kept as it was answered first. */
export type PlanFacts = {
  /** Pixels dimmed. */
  dimmed_pixels: number;
  /** Upward flux that goes, DNB watts, calibration included. */
  flux_removed_dnb_w: number;
  /** Part of that which goes. */
  flux_removed_share: number;
  /** Upward flux of all lit pixels within 300 km of a site, DNB watts. */
  flux_within_reach_dnb_w: number;
  /** Of a threshold plan: γ. */
  gamma?: number | null;
  /** Of a target plan: no plan that brings the measures down as far takes less flux, DNB watts; by linear duality. */
  least_flux_dnb_w?: number | null;
  /** Lit pixels within 300 km of a site. */
  lit_pixels_within_reach: number;
  /** Of a target plan: the largest part of a light that may go. */
  max_cut?: number | null;
  /** `threshold` or `target`. */
  method: string;
  /** Of a target plan with `protect`: of them, those that are left alone. */
  protected_pixels?: number | null;
  /** The sites, in the order of the request. */
  sites: PlannedSite[];
  /** The same as they were asked for: values, or percentiles such as `p90`; null in plans made before this was told. */
  threshold_levels?: string[] | null;
  /** Of a threshold plan: Q_a and Q_b, in the site's `unit`. */
  thresholds?: number[] | null;
};

/** What a plan says of a site. */
export type PlannedSite = Assumptions & ({
  /** Value with the plan, by the same forward model as every sky. */
  after: number;
  /** Value of the measure today, artificial light alone; of `norm` that of the whole visible sky. */
  before: number;
  /** `norm`, `zenith`, `mean`, `horizontal` or `region`. */
  measure: string;
  /** 1 − after/before. */
  reduced_by: number;
  /** The sky with the plan. */
  sky_after: QuantitiesAnswer;
  /** The sky today. */
  sky_before: QuantitiesAnswer;
  target?: TargetAnswer | null;
  /** Unit of the values: `cd m-2`, `lx`, or `cd m-2 sr0.5` of the norm. */
  unit: string;
});

/** Why a request was not answered as asked (RFC 9457). */
export type Problem = {
  /** West, south, east, north of the scene, degrees, where the place lies outside it. */
  bounds?: number[] | null;
  /** What is wrong with this request, and what would help. */
  detail: string;
  /** Every bad parameter. */
  errors?: FieldError[];
  /** The status code. */
  status: number;
  /** The kind in words. */
  title: string;
  /** Stable name of the kind of problem, such as `/problems/unknown-parameter`. */
  type: string;
};

/** The numbers of a sky. Luminances are artificial light alone unless the name says `total`, which adds a uniform natural sky of 22.0 mag arcsec⁻². Magnitudes are null for a sky without light. Where terrain hides part of the sky, all are of the visible part. Nothing natural comes through clouds: under them totals are artificial light alone, and what speaks of stars is null. */
export type QuantitiesAnswer = {
  /** Bortle class of the total at the zenith, 1..=9; null under clouds. */
  bortle_class?: number | null;
  /** Its azimuth, degrees clockwise from north. */
  brightest_azimuth_deg: number;
  /** Its elevation, degrees. */
  brightest_elevation_deg: number;
  /** Largest visible luminance, cd m⁻². */
  brightest_luminance_cd_m2: number;
  /** Horizontal illuminance by the visible sky, lx. */
  horizontal_illuminance_lx: number;
  /** With the natural sky, lx. */
  horizontal_total_illuminance_lx: number;
  /** Mean over the visible sky, cd m⁻². */
  mean_luminance_cd_m2: number;
  /** Naked-eye limiting magnitude at the zenith (Crumey 2014, F = 2); null under clouds. */
  naked_eye_limit_mag?: number | null;
  /** Artificial luminance at the zenith over the natural one of a clear sky. */
  ratio_to_natural: number;
  /** As a Sky Quality Meter at the zenith sees it (Gaussian, FWHM 20°), cd m⁻². */
  sqm_luminance_cd_m2: number;
  /** What such a meter reads with the natural sky, mag arcsec⁻². */
  sqm_total_brightness_mag_arcsec2?: number | null;
  /** The same, mag arcsec⁻². */
  zenith_brightness_mag_arcsec2?: number | null;
  /** Mean within 5° of the zenith, cd m⁻². */
  zenith_luminance_cd_m2: number;
  /** Radiance at the zenith in R, G, B, W m⁻² sr⁻¹. */
  zenith_radiance_w_m2_sr: number[];
  /** With the natural sky, mag arcsec⁻². */
  zenith_total_brightness_mag_arcsec2?: number | null;
  /** With the natural sky, cd m⁻². */
  zenith_total_luminance_cd_m2: number;
};

/** Lamps replaced by others. */
export type ReplaceBody = {
  /** Preset of those that are replaced; all without. Of `mixed` half are `hps` and half `led_4000k`. */
  from?: string | null;
  /** What stays the same: `luminous_flux` (the default: streets are as bright as before) or `dnb_flux` (what the satellite sees). */
  keep?: string | null;
  /** The new ones. */
  to: FixtureBody;
};

/** Lights at some distance. */
export type RingAnswer = PartAnswer & {
  /** Nearest, metres. */
  distance_from_m: number;
  /** Farthest, metres. */
  distance_to_m: number;
};

/** A scenario and what it does to its scene. */
export type ScenarioAnswer = ScenarioEntry & {
  /** Pixels whose light differs from the scene's, with what the scenario goes on from. */
  changed_pixels: number;
  /** Its edits, in order. */
  edits: EditAnswer[];
  /** And after; of replaced lamps what the satellite would have to see of the old ones. */
  flux_after_dnb_w: number;
  /** Upward flux of all those before, DNB watts, calibration included. */
  flux_before_dnb_w: number;
  /** Pixels lit that were dark. */
  new_pixels: number;
  /** The scene. */
  scene: SceneReference;
};

/** What is painted over a scene. */
export type ScenarioBody = {
  /** Id of a scenario or plan that it goes on from. */
  base?: string | null;
  /** The edits, one after the other: 1 to 100. */
  edits: EditBody[];
  /** Its name for people, at most 200 characters. */
  title?: string | null;
};

/** A scenario in a list. */
export type ScenarioEntry = {
  /** The scenario or plan that it goes on from. */
  base?: string | null;
  /** When it was kept, RFC 3339 UTC. */
  created: string;
  /** Number of its edits. */
  edit_count: number;
  /** Its id, which every query takes as `scenario`. */
  id: string;
  /** Its name for people. */
  title?: string | null;
};

/** A scene. */
export type SceneAnswer = {
  /** Whom to credit. */
  attribution?: string | null;
  /** West, south, east, north, degrees; west > east across the antimeridian. */
  bounds: number[];
  /** Factor on the raster's radiances. */
  calibration: number;
  /** Short name of the CRS. */
  crs: string;
  /** When the radiances were taken. */
  date?: string | null;
  /** The raster's own grid. */
  grid: GridAnswer;
  /** Its name in URLs. */
  id: string;
  /** True for made-up light that only shows what the program does. */
  illustrative: boolean;
  /** Pixels with light. */
  lit_pixels: number;
  /** Side of a square with the area of the middle pixel, metres. */
  pixel_size_m: number;
  /** Number of named places. */
  places_count: number;
  /** What the ingest saw: counts of lit, zero, negative, NaN, infinite, no-data and capped pixels with examples, the range, terrain under the lights, warnings. */
  report: Record<string, unknown>;
  /** Whether the scene has terrain. */
  terrain: boolean;
  /** Its name for people. */
  title: string;
  /** Hash over all that the scene holds. */
  version: string;
};

/** The scene that an answer was made from. */
export type SceneReference = {
  /** Whom to credit. */
  attribution?: string | null;
  /** Its name in URLs. */
  id: string;
  /** True for made-up light. */
  illustrative: boolean;
  /** Hash over all that it holds. */
  version: string;
};

/** A scene's files and what is to be known of them, as `skyglow ingest` has it. */
export type SceneUpload = {
  /** Whom to credit. */
  attribution?: string | null;
  /** Subdataset or band to read, by name or number. */
  band?: string | null;
  /** Factor on every radiance. */
  calibration?: number | null;
  /** When the radiances were taken. */
  date?: string | null;
  /** GeoJSON or CSV with name, latitude, longitude and population. */
  places?: string | null;
  /** Upward radiance: GeoTIFF, COG, or a NASA Black Marble HDF5 granule. */
  radiance: string;
  /** Factor on the stored numbers. */
  scale?: number | null;
  /** Terrain, GeoTIFF or SRTM `.hgt`; may be given several times, the first that has a value wins. */
  terrain?: string | null;
  /** Title for people; by default the id. */
  title?: string | null;
  /** `nw-cm2-sr` or `w-m2-sr`. */
  units?: string | null;
};

/** Lights in some direction. */
export type SectorAnswer = PartAnswer & {
  /** First azimuth, degrees clockwise from north. */
  azimuth_from_deg: number;
  /** Last azimuth, degrees; below the first where the sector passes north. */
  azimuth_to_deg: number;
  /** `N`, `NE`, … `NW`. */
  name: string;
};

/** What is at a place. */
export type SiteAnswer = {
  /** West, south, east, north of the scene, degrees. */
  bounds: number[];
  /** Factor on the raster's radiances (not in `radiance_nw_cm2_sr`). */
  calibration: number;
  /** Degrees north. */
  latitude_deg: number;
  /** Degrees east. */
  longitude_deg: number;
  /** Radiance of the raster's pixel there, nW cm⁻² sr⁻¹; 0 where dark, null without data. */
  radiance_nw_cm2_sr?: number | null;
  /** The scene. */
  scene: SceneReference;
  /** Altitude of the ground, metres, at least 0: where the terrain has a gap, that of the nearest terrain within 5 km; null where there is none, then 0 counts. */
  terrain_altitude_m?: number | null;
  /** What is not as it should be there, one sentence each: ground that the terrain does not have. */
  warnings: string[];
};

/** A site. */
export type SiteBody = {
  /** Metres above sea level, instead. */
  altitude?: number | null;
  /** Of `target`: the measure is to be this at most, in its unit, artificial light alone. */
  at_most?: number | null;
  /** Metres above the ground; the default is 2. */
  height?: number | null;
  /** Degrees north. */
  lat: number;
  /** Degrees east. */
  lon: number;
  /** Of `target`: `zenith` (the default), `mean`, `horizontal` or `region`. */
  measure?: string | null;
  /** Of `target`: the measure is to be less by this part of what it is, 0 to 1. */
  reduce_by?: number | null;
  /** A closed curve on the sky, corner by corner as `[azimuth_deg, elevation_deg]`; instead of the query's `region`. */
  region?: [number, number][] | null;
};

/** The numbers alone. */
export type SkyAnswer = Assumptions & {
  /** The numbers. */
  sky: QuantitiesAnswer;
};

/** What a site wanted of a target plan, and whether it has it. */
export type TargetAnswer = {
  /** Whether `after` is at most that, to a part in ten thousand. */
  is_met: boolean;
  /** What would be left with every light cut as far as it may be, in `unit`. */
  least: number;
  /** Of that, from lights in protected polygons. */
  of_protected: number;
  /** Of that, what `max_cut` leaves of the others. */
  of_uncut: number;
  /** The wanted value, in `unit`. */
  wanted: number;
  /** Why it is not met, in words; null where it is. */
  why_not?: string | null;
};

/** TileJSON 3.0. */
export type TileJson = {
  /** Whom to credit. */
  attribution?: string | null;
  /** West, south, east, north, degrees. */
  bounds: number[];
  /** Longitude, latitude and zoom level to start at. */
  center: number[];
  /** What the colours mean. */
  description: string;
  /** Highest zoom level with detail of its own. */
  maxzoom: number;
  /** Lowest zoom level. */
  minzoom: number;
  /** The layer. */
  name: string;
  /** What the darkest and the brightest colour stand for, logarithmic between; null where colours are tints. */
  range?: number[] | null;
  /** Whether tiles are answered at once; until then they wait for what they show to be found. Ask again to know. */
  ready: boolean;
  /** `xyz`. */
  scheme: string;
  /** `3.0.0`. */
  tilejson: string;
  /** URL templates with `{z}`, `{x}`, `{y}`. */
  tiles: string[];
  /** Unit of what the colours stand for. */
  unit: string;
  /** The scene's version. */
  version: string;
};

/** Everything that GET answers: by path, what it takes and what comes back. */
export interface Gets {
  /** A page to read and try the interface. */
  "/api/docs": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: Blob;
  };
  /** Lists the resident table packs: those of first-order scattering, then those of all orders, each ascending in turbidity. */
  "/api/v1/atmospheres": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: AtmosphereAnswer[];
  };
  /** The OpenAPI document. */
  "/api/v1/openapi.json": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: Record<string, unknown>;
  };
  /** A plan, in the format that the Accept header prefers, or that its address ends in: `.json` what is said of it and the pixels with the most effect, `.tif` the part of every pixel that goes as GeoTIFF on the scene's own grid, `.geojson` and `.csv` the pixels with the most effect. */
  "/api/v1/plans/{plan}": {
    path: {
      /** The plan's id, with `.json`, `.tif`, `.geojson`, `.csv` or without */
      plan: string;
    };
    query: {
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
    };
    answer: PlanAnswer;
  };
  /** A scenario, and what it does to its scene. */
  "/api/v1/scenarios/{scenario}": {
    path: {
      /** The scenario's id */
      scenario: string;
    };
    query: Record<string, never>;
    answer: ScenarioAnswer;
  };
  /** Lists the scenes. */
  "/api/v1/scenes": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: SceneAnswer[];
  };
  /** Describes a scene. */
  "/api/v1/scenes/{scene}": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: Record<string, never>;
    answer: SceneAnswer;
  };
  /** Which lights cause the sky of a place, in the format that the Accept header prefers: JSON, GeoTIFF, GeoJSON or CSV. */
  "/api/v1/scenes/{scene}/influence": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
    };
    answer: InfluenceAnswer;
  };
  /** The most influential pixels as a table; what they depend on stands in the JSON alone. */
  "/api/v1/scenes/{scene}/influence.csv": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
    };
    answer: Blob;
  };
  /** The most influential pixels as GeoJSON points. */
  "/api/v1/scenes/{scene}/influence.geojson": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
    };
    answer: Blob;
  };
  /** Which lights cause the sky of a place: the most influential pixels, and all by distance and azimuth. */
  "/api/v1/scenes/{scene}/influence.json": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
    };
    answer: InfluenceAnswer;
  };
  /** What every lit pixel does, as GeoTIFF on the scene's own grid: one float32 band; pixels without light or beyond 300 km are no data. */
  "/api/v1/scenes/{scene}/influence.tif": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
    };
    answer: Blob;
  };
  /** The artificial luminance at the zenith of every place as a cloud-optimized GeoTIFF on the scene's own grid: one float32 band, cd m⁻², two metres above the ground; by blocks where that would be more than 1.2 million places. The first time it takes seconds. */
  "/api/v1/scenes/{scene}/layers/brightness.tif": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
    };
    answer: Blob;
  };
  /** Terrain elevation at the middles of the scene's pixels as a cloud-optimized GeoTIFF: one float32 band, metres; by blocks where that would be more than 4 million pixels. */
  "/api/v1/scenes/{scene}/layers/elevation.tif": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: Record<string, never>;
    answer: Blob;
  };
  /** Upward radiance as a cloud-optimized GeoTIFF on the scene's own grid: one float32 band, nW cm⁻² sr⁻¹, without the calibration; by blocks where that would be more than 4 million pixels. */
  "/api/v1/scenes/{scene}/layers/radiance.tif": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
    };
    answer: Blob;
  };
  /** The sky in the format that the Accept header prefers; PNG if it takes anything. Parameters that mean nothing for that format are errors. */
  "/api/v1/scenes/{scene}/panorama": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Which light: artificial alone, or with the natural sky of 22.0 mag arcsec⁻². Allowed: artificial, total. */
      sky?: "artificial" | "total";
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** Projection: fisheye is zenithal equidistant with north up and east left. Allowed: equirectangular, fisheye, perspective. */
      projection?: "equirectangular" | "fisheye" | "perspective";
      /** Azimuth of the centre of a perspective, clockwise from north. Allowed: -360 to 360 degrees. */
      azimuth?: number;
      /** Elevation of the centre of a perspective. Allowed: -90 to 90 degrees. */
      elevation?: number;
      /** Horizontal field of view of a perspective. Allowed: 1 to 150 degrees. */
      fov?: number;
      /** False colour on a fixed scale, or realistic at a fixed exposure. Allowed: false_colour, realistic. */
      style?: "false_colour" | "realistic";
      /** Colour map of false colour, all readable without colour vision. Allowed: inferno, magma, plasma, viridis, cividis, grey. */
      colormap?: "inferno" | "magma" | "plasma" | "viridis" | "cividis" | "grey";
      /** Unit of min and max: luminance in cd m⁻² (logarithmic) or magnitude in mag arcsec⁻². Allowed: luminance, magnitude. */
      scale?: "luminance" | "magnitude";
      /** Smaller end of the colour scale; default 1e-5 cd m⁻² or 15 mag arcsec⁻². Allowed: 1e-9 to 1e6 cd/m2, or -5 to 40 mag/arcsec2, below max. */
      min?: string;
      /** Larger end of the colour scale; default 0.1 cd m⁻² or 25 mag arcsec⁻². Allowed: 1e-9 to 1e6 cd/m2, or -5 to 40 mag/arcsec2, above min. */
      max?: string;
      /** Exposure of realistic, stops; at 0 a sky of 0.001 cd m⁻² is middle grey. Allowed: -12 to 12 EV. */
      exposure?: number;
      /** Width of the sky in the picture; the default depends on projection and format. Allowed: a whole number from 16 to 4096. */
      width?: number;
      /** Height of the sky in the picture, without the legend; the default depends on projection and format. Width times height is at most 8 388 608 pixels. Allowed: a whole number from 16 to 4096. */
      height_px?: number;
      /** Compass letters and the strip that explains the colours. Allowed: on, off. */
      legend?: "on" | "off";
    };
    answer: PanoramaAnswer;
  };
  /** Linear radiance as OpenEXR: channels R, G, B in W m⁻² sr⁻¹, 32-bit floats, 0 where terrain hides the sky; A says where the projection shows the upper hemisphere. */
  "/api/v1/scenes/{scene}/panorama.exr": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Which light: artificial alone, or with the natural sky of 22.0 mag arcsec⁻². Allowed: artificial, total. */
      sky?: "artificial" | "total";
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** Projection: fisheye is zenithal equidistant with north up and east left. Allowed: equirectangular, fisheye, perspective. */
      projection?: "equirectangular" | "fisheye" | "perspective";
      /** Azimuth of the centre of a perspective, clockwise from north. Allowed: -360 to 360 degrees. */
      azimuth?: number;
      /** Elevation of the centre of a perspective. Allowed: -90 to 90 degrees. */
      elevation?: number;
      /** Horizontal field of view of a perspective. Allowed: 1 to 150 degrees. */
      fov?: number;
      /** Width of the sky in the picture; the default depends on projection and format. Allowed: a whole number from 16 to 4096. */
      width?: number;
      /** Height of the sky in the picture, without the legend; the default depends on projection and format. Width times height is at most 8 388 608 pixels. Allowed: a whole number from 16 to 4096. */
      height_px?: number;
    };
    answer: Blob;
  };
  /** The raw grid with its numbers; it has no projection and no style. */
  "/api/v1/scenes/{scene}/panorama.json": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Which light: artificial alone, or with the natural sky of 22.0 mag arcsec⁻². Allowed: artificial, total. */
      sky?: "artificial" | "total";
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
    };
    answer: PanoramaAnswer;
  };
  /** The sky as PNG, with its legend. */
  "/api/v1/scenes/{scene}/panorama.png": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Which light: artificial alone, or with the natural sky of 22.0 mag arcsec⁻². Allowed: artificial, total. */
      sky?: "artificial" | "total";
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** Projection: fisheye is zenithal equidistant with north up and east left. Allowed: equirectangular, fisheye, perspective. */
      projection?: "equirectangular" | "fisheye" | "perspective";
      /** Azimuth of the centre of a perspective, clockwise from north. Allowed: -360 to 360 degrees. */
      azimuth?: number;
      /** Elevation of the centre of a perspective. Allowed: -90 to 90 degrees. */
      elevation?: number;
      /** Horizontal field of view of a perspective. Allowed: 1 to 150 degrees. */
      fov?: number;
      /** False colour on a fixed scale, or realistic at a fixed exposure. Allowed: false_colour, realistic. */
      style?: "false_colour" | "realistic";
      /** Colour map of false colour, all readable without colour vision. Allowed: inferno, magma, plasma, viridis, cividis, grey. */
      colormap?: "inferno" | "magma" | "plasma" | "viridis" | "cividis" | "grey";
      /** Unit of min and max: luminance in cd m⁻² (logarithmic) or magnitude in mag arcsec⁻². Allowed: luminance, magnitude. */
      scale?: "luminance" | "magnitude";
      /** Smaller end of the colour scale; default 1e-5 cd m⁻² or 15 mag arcsec⁻². Allowed: 1e-9 to 1e6 cd/m2, or -5 to 40 mag/arcsec2, below max. */
      min?: string;
      /** Larger end of the colour scale; default 0.1 cd m⁻² or 25 mag arcsec⁻². Allowed: 1e-9 to 1e6 cd/m2, or -5 to 40 mag/arcsec2, above min. */
      max?: string;
      /** Exposure of realistic, stops; at 0 a sky of 0.001 cd m⁻² is middle grey. Allowed: -12 to 12 EV. */
      exposure?: number;
      /** Width of the sky in the picture; the default depends on projection and format. Allowed: a whole number from 16 to 4096. */
      width?: number;
      /** Height of the sky in the picture, without the legend; the default depends on projection and format. Width times height is at most 8 388 608 pixels. Allowed: a whole number from 16 to 4096. */
      height_px?: number;
      /** Compass letters and the strip that explains the colours. Allowed: on, off. */
      legend?: "on" | "off";
    };
    answer: Blob;
  };
  /** Linear radiance as TIFF: three float32 bands in W m⁻² sr⁻¹; 0 where terrain hides the sky, NaN where the projection shows nothing above the horizontal plane. */
  "/api/v1/scenes/{scene}/panorama.tif": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Which light: artificial alone, or with the natural sky of 22.0 mag arcsec⁻². Allowed: artificial, total. */
      sky?: "artificial" | "total";
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** Projection: fisheye is zenithal equidistant with north up and east left. Allowed: equirectangular, fisheye, perspective. */
      projection?: "equirectangular" | "fisheye" | "perspective";
      /** Azimuth of the centre of a perspective, clockwise from north. Allowed: -360 to 360 degrees. */
      azimuth?: number;
      /** Elevation of the centre of a perspective. Allowed: -90 to 90 degrees. */
      elevation?: number;
      /** Horizontal field of view of a perspective. Allowed: 1 to 150 degrees. */
      fov?: number;
      /** Width of the sky in the picture; the default depends on projection and format. Allowed: a whole number from 16 to 4096. */
      width?: number;
      /** Height of the sky in the picture, without the legend; the default depends on projection and format. Width times height is at most 8 388 608 pixels. Allowed: a whole number from 16 to 4096. */
      height_px?: number;
    };
    answer: Blob;
  };
  /** The sky as lossless WebP, with its legend. */
  "/api/v1/scenes/{scene}/panorama.webp": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Which light: artificial alone, or with the natural sky of 22.0 mag arcsec⁻². Allowed: artificial, total. */
      sky?: "artificial" | "total";
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** Projection: fisheye is zenithal equidistant with north up and east left. Allowed: equirectangular, fisheye, perspective. */
      projection?: "equirectangular" | "fisheye" | "perspective";
      /** Azimuth of the centre of a perspective, clockwise from north. Allowed: -360 to 360 degrees. */
      azimuth?: number;
      /** Elevation of the centre of a perspective. Allowed: -90 to 90 degrees. */
      elevation?: number;
      /** Horizontal field of view of a perspective. Allowed: 1 to 150 degrees. */
      fov?: number;
      /** False colour on a fixed scale, or realistic at a fixed exposure. Allowed: false_colour, realistic. */
      style?: "false_colour" | "realistic";
      /** Colour map of false colour, all readable without colour vision. Allowed: inferno, magma, plasma, viridis, cividis, grey. */
      colormap?: "inferno" | "magma" | "plasma" | "viridis" | "cividis" | "grey";
      /** Unit of min and max: luminance in cd m⁻² (logarithmic) or magnitude in mag arcsec⁻². Allowed: luminance, magnitude. */
      scale?: "luminance" | "magnitude";
      /** Smaller end of the colour scale; default 1e-5 cd m⁻² or 15 mag arcsec⁻². Allowed: 1e-9 to 1e6 cd/m2, or -5 to 40 mag/arcsec2, below max. */
      min?: string;
      /** Larger end of the colour scale; default 0.1 cd m⁻² or 25 mag arcsec⁻². Allowed: 1e-9 to 1e6 cd/m2, or -5 to 40 mag/arcsec2, above min. */
      max?: string;
      /** Exposure of realistic, stops; at 0 a sky of 0.001 cd m⁻² is middle grey. Allowed: -12 to 12 EV. */
      exposure?: number;
      /** Width of the sky in the picture; the default depends on projection and format. Allowed: a whole number from 16 to 4096. */
      width?: number;
      /** Height of the sky in the picture, without the legend; the default depends on projection and format. Width times height is at most 8 388 608 pixels. Allowed: a whole number from 16 to 4096. */
      height_px?: number;
      /** Compass letters and the strip that explains the colours. Allowed: on, off. */
      legend?: "on" | "off";
    };
    answer: Blob;
  };
  /** Lists the named places of a scene, the most populous first. */
  "/api/v1/scenes/{scene}/places": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: Record<string, never>;
    answer: PlaceAnswer[];
  };
  /** Lists the plans of a scene, the newest first. */
  "/api/v1/scenes/{scene}/plans": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: Record<string, never>;
    answer: PlanEntry[];
  };
  /** Lists the scenarios of a scene, the newest first. */
  "/api/v1/scenes/{scene}/scenarios": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: Record<string, never>;
    answer: ScenarioEntry[];
  };
  /** Says what is at a place. */
  "/api/v1/scenes/{scene}/site": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
    };
    answer: SiteAnswer;
  };
  /** The numbers of the sky at a place. */
  "/api/v1/scenes/{scene}/sky": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Which light: artificial alone, or with the natural sky of 22.0 mag arcsec⁻². Allowed: artificial, total. */
      sky?: "artificial" | "total";
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
    };
    answer: SkyAnswer;
  };
  /** Describes a layer of tiles (TileJSON 3.0). What takes seconds to find is begun by this, and `ready` says whether it is found. Its parameters are those of the layer's tiles, and are handed on to them; that of `influence` needs the place. */
  "/api/v1/scenes/{scene}/tiles/{layer}/tilejson.json": {
    path: {
      /** The scene's id */
      scene: string;
      /** `radiance`, `elevation`, `brightness` or `influence` */
      layer: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat?: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon?: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
    };
    answer: TileJson;
  };
  /** A map tile, 256 pixels a side, or 512 where `y` ends in `@2x`: `radiance` on a logarithmic scale, dark is transparent; `elevation` with hypsometric tints and shading; `brightness`, the artificial luminance at the zenith of every place, from a hundredth of the natural sky to forty times that on a logarithmic scale, less is transparent (the first tile of a map takes seconds); `influence` on a logarithmic scale down to a ten-thousandth of the 32nd most influential pixel; TileJSON says from what to what. `radiance` takes the parameter `scenario`, `brightness` that and `turbidity`, `scattering`, `lamp`, `emission`, `terrain`, `influence` all parameters below, and needs the place. */
  "/api/v1/scenes/{scene}/tiles/{layer}/{z}/{x}/{y}.png": {
    path: {
      /** The scene's id */
      scene: string;
      /** `radiance`, `elevation`, `brightness` or `influence` */
      layer: string;
      /** Zoom level */
      z: number;
      /** Column, from 180° west */
      x: number;
      /** Row, from the north; with `@2x` behind it for 512 pixels a side */
      y: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat?: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon?: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
    };
    answer: Blob;
  };
  /** Answers while the server lives. */
  "/healthz": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: HealthAnswer;
  };
  /** Counters for Prometheus, in the OpenMetrics text format. */
  "/metrics": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: Blob;
  };
  /** Explains a kind of problem. */
  "/problems/{kind}": {
    path: {
      /** The last part of a problem's `type` */
      kind: string;
    };
    query: Record<string, never>;
    answer: Blob;
  };
  /** Answers 200 once tables are resident and the device answers. */
  "/readyz": {
    path: Record<string, never>;
    query: Record<string, never>;
    answer: HealthAnswer;
  };
}

/** Everything that POST answers: by path, what it takes with which body, and what comes back. */
export interface Posts {
  "/api/v1/scenes/{scene}/influence": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
    };
    body: InfluenceBody;
    answer: InfluenceAnswer;
  };
  "/api/v1/scenes/{scene}/influence.csv": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
    };
    body: InfluenceBody;
    answer: Blob;
  };
  "/api/v1/scenes/{scene}/influence.geojson": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
    };
    body: InfluenceBody;
    answer: Blob;
  };
  "/api/v1/scenes/{scene}/influence.json": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
    };
    body: InfluenceBody;
    answer: InfluenceAnswer;
  };
  "/api/v1/scenes/{scene}/influence.tif": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Latitude of the place, WGS84. Allowed: -90 to 90 degrees. */
      lat: number;
      /** Longitude of the place, WGS84. Allowed: -180 to 360 degrees. */
      lon: number;
      /** Height of the observer above the ground; the resident packs narrow the range. Allowed: 0 to 100000 m. */
      height?: number;
      /** Altitude of the observer above sea level, instead of terrain and height; below 0 counts as 0. The resident packs narrow the range. Allowed: -1000 to 100000 m. */
      altitude?: number;
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** What of the sky lights have their part in: the mean luminance within 5° of the zenith, of the visible sky, or of the visible sky inside a region; the horizontal illuminance; or the norm of each light's own sky, open down to the horizontal plane, which does not add up. The default is `region` where one is given, else `zenith`. Allowed: norm, zenith, mean, horizontal, region. */
      measure?: "norm" | "zenith" | "mean" | "horizontal" | "region";
      /** A closed curve on the sky, corner by corner; its sides are great circles, the last corner is joined to the first. Directions that it winds around are inside: it may pass north, hold or touch the zenith, and cross itself. Allowed: 3 to 1000 corners azimuth,elevation in degrees, elevation 0 to 90, with semicolons between, such as 10,20;50,20;30,60. */
      region?: string;
    };
    body: InfluenceBody;
    answer: Blob;
  };
  /** Makes a reduction plan: what to dim, by how influential lights are on a site (`threshold`), or the least flux such that sites meet limits (`target`). Values before and after come from the forward model. The plan is kept, unless `keep=off` only tries it: then it counts towards no share of what is kept, and is forgotten after some minutes without a question about it. Its id is taken by every query as `scenario`, and the same request for the same scene answers the same plan. */
  "/api/v1/scenes/{scene}/plans": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: {
      /** Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 haze. The resident packs of the scattering narrow the range. Allowed: 1 to 20. */
      turbidity?: number;
      /** Orders of scattering: `multiple` counts all of them and the light that the ground sends back, `single` the first alone. The default is `multiple` where tables for it are resident, else `single`. Allowed: single, multiple. */
      scattering?: "single" | "multiple";
      /** Lamp: its flux in the bands R, G, B per flux that the satellite saw. Allowed: neutral, hps, lps, pc_amber, led_3000k, led_4000k, metal_halide, mercury, mixed, or three numbers r,g,b from 0 to 100, not all 0. */
      lamp?: string;
      /** How lamps spread their light over the zenith angle. Allowed: garstang, shielded, lambert, or three weights lambert,horizon,oblique that are not negative and not all 0. */
      emission?: string;
      /** Number of basis functions; the default is all that are resident, and no more can be had. Allowed: a whole number from 1 to 256. */
      basis?: number;
      /** Clouds: none, or the base of a closed layer of cloud in metres above sea level, of those that tables are resident for. Allowed: none, or a whole number from 200 to 12000 m. */
      clouds?: string;
      /** Whether terrain hides: the sky below the observer's horizon is dark and numbers are of the visible sky, and of every source's light what leaves below its skyline towards the observer does not count. Allowed: on, off. */
      terrain?: "on" | "off";
      /** Relative difference to the sky of all basis functions that fewer may make, in the norm over the open sky and the worst band. The fewest are used whose bound is within it, all of them where none is, and between the turbidities of the packs; `basis_error_bound` says the bound. Not together with `basis`. Allowed: 0.0001 to 0.5. */
      tolerance?: number;
      /** Id of a scenario or plan of the scene: its lights are as that says. Allowed: s- or p- and 20 hexadecimal digits, as POST scenarios and POST plans answer. */
      scenario?: string;
      /** Number of the most influential pixels that are listed. Allowed: a whole number from 0 to 10000. */
      limit?: number;
      /** Whether a plan is kept, or only held for some ten minutes after it was last asked for: for trying one after the other. Allowed: on, off. */
      keep?: "on" | "off";
    };
    body: PlanBody;
    answer: PlanAnswer;
  };
  /** Paints over a scene: dims, brightens or adds lights, replaces lamps, changes where they shine. The id that is answered is taken by every query as `scenario`; the same body answers the same id. */
  "/api/v1/scenes/{scene}/scenarios": {
    path: {
      /** The scene's id */
      scene: string;
    };
    query: Record<string, never>;
    body: ScenarioBody;
    answer: ScenarioAnswer;
  };
}
