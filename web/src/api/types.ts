// The shapes of the API's answers that the viewer uses.

/** [west, south, east, north] in degrees; west > east across the antimeridian. */
export type Bounds = [number, number, number, number];

export interface Scene {
  id: string;
  title: string;
  bounds: Bounds;
  date?: string | null;
  attribution?: string | null;
  /** Made up for demonstration; said wherever it is shown. */
  illustrative: boolean;
  terrain: boolean;
  version: string;
}

export interface NamedPlace {
  name: string;
  latitude_deg: number;
  longitude_deg: number;
  population?: number | null;
}

export interface Site {
  terrain_altitude_m: number | null;
  radiance_nw_cm2_sr: number | null;
}

/** The server's `sky` object: artificial light alone unless the name says `total`. */
export interface SkyQuantities {
  zenith_luminance_cd_m2: number;
  zenith_brightness_mag_arcsec2: number | null;
  zenith_total_luminance_cd_m2: number;
  zenith_total_brightness_mag_arcsec2: number;
  ratio_to_natural: number;
  sqm_luminance_cd_m2: number;
  sqm_total_brightness_mag_arcsec2: number;
  mean_luminance_cd_m2: number;
  horizontal_illuminance_lx: number;
  horizontal_total_illuminance_lx: number;
  brightest_luminance_cd_m2: number;
  brightest_azimuth_deg: number;
  brightest_elevation_deg: number;
  bortle_class: number;
  naked_eye_limit_mag: number;
}

export interface Observer {
  latitude_deg: number;
  longitude_deg: number;
  altitude_m: number;
  terrain_altitude_m: number | null;
}

export interface SkyAnswer {
  observer: Observer;
  sky: SkyQuantities;
  coverage: number;
  calibration: number;
  turbidity: number;
  local_optical_depth: [number, number, number];
}

export interface PanoramaAnswer extends SkyAnswer {
  grid: {
    azimuth_count: number;
    elevation_count: number;
    azimuth_first_deg: number;
    azimuth_step_deg: number;
    elevation_first_deg: number;
    elevation_step_deg: number;
  };
  bands_nm: number[];
  /** radiance[band][row][column], W m⁻² sr⁻¹; row 0 lowest, column 0 north. */
  radiance: number[][][];
  horizon_deg?: number[] | null;
}

export interface Atmosphere {
  turbidity: number;
}

export interface Health {
  status: string;
}

/** RFC 9457, with one entry for each bad parameter. */
export interface Problem {
  type?: string;
  title?: string;
  status?: number;
  detail?: string;
  errors?: { parameter: string; value?: string | null; allowed: string; message: string }[];
  bounds?: Bounds;
}
