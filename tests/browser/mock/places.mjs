// Made-up answers about places: whose light, darker places, the world's places and the hours of a night.
import { nightOf } from "./night.mjs";
import { quantities, radiance, TOWNS } from "./sky.mjs";

const KM_PER_DEG = 111;

function wayTo(from, { latitude_deg, longitude_deg }) {
  const north = (latitude_deg - from.latitude_deg) * KM_PER_DEG;
  const east = (longitude_deg - from.longitude_deg) * KM_PER_DEG * Math.cos((from.latitude_deg * Math.PI) / 180);
  return { distance_m: 1000 * Math.hypot(north, east), azimuth_deg: ((Math.atan2(east, north) * 180) / Math.PI + 360) % 360 };
}

/** By Walker's law alone. */
export function sharesOf(place, measure, limit) {
  const glows = TOWNS.map((town) => {
    const way = wayTo(place, town);
    return { ...town, ...way, influence: town.population * Math.max(way.distance_m / 1000, 3) ** -2.5 };
  }).sort((a, b) => b.influence - a.influence);
  const total = glows.reduce((sum, { influence }) => sum + influence, 0);
  const part = (influence) => ({ influence, share: influence / total, flux_dnb_w: influence, pixels: 100 });
  const places = glows.slice(0, limit).map((town, i) => ({ rank: i + 1, ...town, ...part(town.influence) }));
  const rest = glows.slice(limit);
  return {
    measure,
    unit: "cd m-2",
    total,
    places,
    other_places: part(rest.reduce((sum, { influence }) => sum + influence, 0)),
    other_places_count: rest.length,
    elsewhere: part(0),
  };
}

/** Away from Nairobi in four steps. */
export function darkerThan(here) {
  const [nairobi] = TOWNS;
  const { azimuth_deg } = wayTo(nairobi, here);
  const places = [55, 40, 25, 12].map((distanceKm, i) => {
    const [north, east] = [Math.cos, Math.sin].map((of) => (distanceKm / KM_PER_DEG) * of((azimuth_deg * Math.PI) / 180));
    const place = { latitude_deg: here.latitude_deg + north, longitude_deg: here.longitude_deg + east };
    return {
      rank: i + 1,
      ...place,
      ...wayTo(here, place),
      ground: "land",
      gain_mag: distanceKm / 40,
      nearest_place: { name: nairobi.name, ...wayTo(nairobi, place) },
      low_sky: { clean_directions_deg: i < 2 ? [[azimuth_deg, (azimuth_deg + 90) % 360]] : [] },
    };
  });
  return { here, places, within_m: 60_000, step_m: 5000, compared_count: 400 };
}

export function hoursOf(place, date) {
  const night = nightOf(date, place.latitude_deg, place.longitude_deg);
  const { zenith_total_brightness_mag_arcsec2: darkest } = quantities(radiance(place, 2.5, [0.4, 0.6, 0.2]));
  const firstMs = Math.ceil(Date.parse(night.from_utc) / 3_600_000) * 3_600_000;
  const hours = Array.from({ length: 24 }, (_, i) => ({
    time: new Date(firstMs + i * 3_600_000).toISOString().replace(".000", ""),
    zenith_total_brightness_mag_arcsec2: darkest - 0.3 * Math.abs(i - 10) ** 1.5,
  }));
  return { night, hours, best_hour: hours[10].time };
}

export function worldPlaces(name) {
  const isMatch = (town) => town.name.toLowerCase().startsWith(name.toLowerCase());
  return TOWNS.filter(isMatch).map((town) => ({ ...town, country: "KE", scene: "demo" }));
}
