//! Darker places near a place.

use super::Assumptions;
use crate::format::rounded;
use serde::Serialize;
use skyglow_observatory::{DarkerPlace, DarkerPlaces, Footing, LowSky, RenderedSky, low_sky};
use skyglow_physics::{GeoPoint, Response, geometry::LocalFrame};
use skyglow_scene::NamedPlace;
use utoipa::ToSchema;

/// Artificial light low in the sky. A direction is the mean over 15° of azimuth and the lowest 30° of the visible sky.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct LowSkyAnswer {
    /// Azimuth of the darkest direction, degrees clockwise from north.
    pub darkest_azimuth_deg: f64,
    /// Artificial luminance there, cd m⁻².
    pub darkest_luminance_cd_m2: f64,
    /// Azimuth of the brightest direction, degrees clockwise from north.
    pub brightest_azimuth_deg: f64,
    /// Artificial luminance there, cd m⁻².
    pub brightest_luminance_cd_m2: f64,
    /// Ranges of azimuth, first and last in degrees, in which artificial light is at most half of the dark reference overhead; of 15°
    /// or more. The last is below the first where a range passes north.
    pub clean_directions_deg: Vec<[f64; 2]>,
}

impl From<LowSky> for LowSkyAnswer {
    fn from(low: LowSky) -> Self {
        Self {
            darkest_azimuth_deg: low.darkest.0,
            darkest_luminance_cd_m2: low.darkest.1,
            brightest_azimuth_deg: low.brightest.0,
            brightest_luminance_cd_m2: low.brightest.1,
            clean_directions_deg: low.clean.into_iter().map(|range| range.map(rounded)).collect(),
        }
    }
}

/// A place with its sky, in short.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PlaceSky {
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Altitude of the ground, metres, at least 0; null where it is not known.
    pub terrain_altitude_m: Option<f64>,
    /// Artificial luminance within 5° of the zenith, cd m⁻².
    pub zenith_luminance_cd_m2: f64,
    /// Total brightness of the zenith, mag arcsec⁻².
    pub zenith_total_brightness_mag_arcsec2: Option<f64>,
    /// Artificial light at the zenith over the natural.
    pub ratio_to_natural: f64,
    /// Bortle class of the total at the zenith.
    pub bortle_class: Option<u8>,
    /// Faintest star at the zenith for the naked eye, mag.
    pub naked_eye_limit_mag: Option<f64>,
    /// Artificial light low in the sky; null where terrain hides all of it.
    pub low_sky: Option<LowSkyAnswer>,
}

impl PlaceSky {
    fn new(place: GeoPoint, sky: &RenderedSky) -> Self {
        let luminance = sky.seen.seen_by(&Response::Photopic).unwrap_or_default();
        let numbers = &sky.quantities;
        Self {
            latitude_deg: rounded(place.latitude_deg()),
            longitude_deg: rounded(place.longitude_deg()),
            terrain_altitude_m: sky.context.ground.known_altitude_m(),
            zenith_luminance_cd_m2: numbers.zenith_luminance_cd_m2,
            zenith_total_brightness_mag_arcsec2: numbers.zenith_total_brightness_mag_arcsec2,
            ratio_to_natural: numbers.ratio_to_natural,
            bortle_class: numbers.bortle_class,
            naked_eye_limit_mag: numbers.naked_eye_limit_mag,
            low_sky: low_sky(luminance, sky.context.dark.luminance_cd_m2(), &sky.horizon)
                .map(LowSkyAnswer::from),
        }
    }
}

/// The named place nearest to a place.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct NearestPlace {
    /// Its name.
    pub name: String,
    /// From it along the ground, metres.
    pub distance_m: f64,
    /// The direction from it, degrees clockwise from north.
    pub azimuth_deg: f64,
}

impl NearestPlace {
    fn of(place: GeoPoint, places: &[NamedPlace]) -> Option<Self> {
        let at = |named: &NamedPlace| {
            GeoPoint::from_rad_unchecked(named.latitude_deg.to_radians(), named.longitude_deg.to_radians())
        };
        let to = place.unit_vector();
        let nearest = places.iter().min_by(|a, b| {
            let [a, b] = [a, b].map(|named| at(named).unit_vector().distance_squared(to));
            a.total_cmp(&b)
        })?;
        let bearing = LocalFrame::at(at(nearest)).bearing_to(to);
        Some(Self {
            name: nearest.name.clone(),
            distance_m: bearing.distance_m,
            azimuth_deg: bearing.azimuth_rad.to_degrees(),
        })
    }
}

/// A darker place.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct DarkerPlaceAnswer {
    /// Place in the list, from 1.
    pub rank: usize,
    /// From the place asked for along the ground, metres.
    pub distance_m: f64,
    /// From the place asked for, degrees clockwise from north.
    pub azimuth_deg: f64,
    /// What the terrain says of the ground: `land`; `level` where it is at one level all around, a lake or a plain; `unknown` in a scene
    /// without terrain. Nobody knows whether one may go there.
    pub ground: String,
    /// The nearest named place; null in a scene without.
    pub nearest_place: Option<NearestPlace>,
    /// How much darker its zenith is in total, mag arcsec⁻².
    pub gain_mag: Option<f64>,
    /// Its artificial light at the zenith over that of the place asked for.
    pub artificial_ratio: Option<f64>,
    /// Its sky.
    #[serde(flatten)]
    pub sky: PlaceSky,
}

/// Darker places near a place, and what they gain.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct DarkerAnswer {
    /// What the numbers of the place asked for depend on, and but for the place those of the others.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// The place asked for.
    pub here: PlaceSky,
    /// Darker ones, the darkest first. None where none within reach has at least a tenth less artificial light.
    pub places: Vec<DarkerPlaceAnswer>,
    /// How far was looked, metres.
    pub within_m: f64,
    /// From one place that was compared to the next, metres.
    pub step_m: f64,
    /// Places that were compared.
    pub compared_count: usize,
    /// Places left out as the sea, or as gaps in the terrain.
    pub sea_or_gap_count: usize,
    /// Places left out as higher than the table packs reach.
    pub too_high_count: usize,
}

impl DarkerAnswer {
    /// The answer from what was found and the skies of the place asked for and of [`DarkerPlaces::places`].
    pub fn new(
        mut assumptions: Assumptions,
        here: (GeoPoint, &RenderedSky),
        within_m: f64,
        found: &DarkerPlaces,
        skies: &[impl AsRef<RenderedSky>],
        named: &[NamedPlace],
    ) -> Self {
        let sky_here = PlaceSky::new(here.0, here.1);
        let place = |(at, (place, sky)): (usize, (&DarkerPlace, &RenderedSky))| {
            let sky = PlaceSky::new(place.place, sky);
            let total = sky.zenith_total_brightness_mag_arcsec2;
            let artificial = sky_here.zenith_luminance_cd_m2;
            DarkerPlaceAnswer {
                rank: at + 1,
                distance_m: place.distance_m,
                azimuth_deg: place.azimuth_rad.to_degrees(),
                ground: footing_name(place.footing).to_owned(),
                nearest_place: NearestPlace::of(place.place, named),
                gain_mag: total
                    .zip(sky_here.zenith_total_brightness_mag_arcsec2)
                    .map(|(there, here)| there - here),
                artificial_ratio: (artificial > 0.0).then(|| sky.zenith_luminance_cd_m2 / artificial),
                sky,
            }
        };
        let skies = skies.iter().map(AsRef::as_ref);
        let places = found.places.iter().zip(skies).enumerate().map(place).collect();
        if found.sea_or_gap > found.compared {
            assumptions.warnings.push(MOSTLY_SEA.to_owned());
        }
        Self {
            assumptions,
            places,
            here: sky_here,
            within_m,
            step_m: found.step_m,
            compared_count: found.compared,
            sea_or_gap_count: found.sea_or_gap,
            too_high_count: found.too_high,
        }
    }
}

/// Said where the search says little of the surroundings.
const MOSTLY_SEA: &str =
    "most places within reach were left out: the terrain there is level at the sea, or has no data";

/// What is known of the ground, as answers name it.
const fn footing_name(footing: Footing) -> &'static str {
    match footing {
        Footing::Land => "land",
        Footing::Level => "level",
        Footing::SeaOrGap => "sea_or_gap",
        Footing::Unknown => "unknown",
    }
}
