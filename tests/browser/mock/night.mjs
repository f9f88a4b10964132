// A made-up night: the Sun sets at 18:20 of its own time and rises at 5:40, the Moon rises at 1.
const HOUR_MS = 3_600_000;
const TWILIGHTS = { civil: 0.4, nautical: 0.85, astronomical: 1.3 };

export function nightOf(date, latitudeDeg, longitudeDeg) {
  const noonMs = Date.parse(date) + (12 - longitudeDeg / 15) * HOUR_MS;
  const at = (hours) => new Date(noonMs + hours * HOUR_MS).toISOString().replace(/\.\d+Z/, "Z");
  const [set, rise, moonrise] = [6.33, 17.67, 13];
  const interval = (from, until) => ({ from_utc: at(from), until_utc: at(until), hours: until - from });
  const [darkFrom, darkUntil] = [set + TWILIGHTS.astronomical, rise - TWILIGHTS.astronomical];
  return {
    date,
    site: { latitude_deg: latitudeDeg, longitude_deg: longitudeDeg, altitude_m: 0 },
    from_utc: at(0),
    until_utc: at(24),
    sun: { set_utc: at(set), rise_utc: at(rise), lowest_utc: at(12), lowest_altitude_deg: -70, transit_utc: null, stays: null },
    twilights: Object.entries(TWILIGHTS).map(([kind, hours]) => ({
      kind,
      evening_end_utc: at(set + hours),
      morning_begin_utc: at(rise - hours),
      sun_stays: null,
    })),
    moon: {
      rises_utc: [at(moonrise)],
      sets_utc: [at(1)],
      transits: [],
      stays: null,
      illuminated_fraction: 0.31,
      phase_angle_deg: 112,
      phase: "waning_crescent",
      is_waxing: false,
      magnitude_v: -9.2,
    },
    astronomical_night: [interval(darkFrom, darkUntil)],
    dark_intervals: [interval(darkFrom, moonrise)],
    dark_hours: moonrise - darkFrom,
  };
}

/** The natural sky of a time: twilight by the hours to the middle of the night. */
export function nightSkyAt(time, { longitude_deg }) {
  const hours = (((Date.parse(time) / HOUR_MS + longitude_deg / 15) % 24) + 24) % 24;
  const toMidnight = Math.min(hours, 24 - hours);
  const sunDeg = 15 * toMidnight - 90;
  const component = (name, zenithLuminanceCdM2) => ({
    component: name,
    zenith_luminance_cd_m2: zenithLuminanceCdM2,
    zenith_brightness_mag_arcsec2: -2.5 * Math.log10(zenithLuminanceCdM2 / 1.08e5),
  });
  return {
    time,
    sun: { true_altitude_deg: sunDeg, apparent_altitude_deg: sunDeg, azimuth_deg: 270 },
    moon: { true_altitude_deg: 20, apparent_altitude_deg: 20, azimuth_deg: 90, illuminated_fraction: 0.31 },
    planets: [],
    components: [
      component("sun", 10 ** (1 + sunDeg / 3)),
      component("moon", 2e-4),
      component("starlight", 6e-5),
      component("zodiacal_light", 5e-5),
      component("airglow", 9e-5),
    ],
    stars: { visible: 1200, above_horizon: 4400 },
    limits: [],
    milky_way: { contrast: 0.2, azimuth_deg: 180, elevation_deg: 40, galactic_longitude_deg: 0 },
  };
}
