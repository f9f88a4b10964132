//! The layer of cloud that a pack was computed under, and its sample points below it.
//!
//! The observers of such packs end at [`Clouds::ceiling_m`]. Sources of nodes higher than that are clamped there: no
//! source is that high, but interpolation uses the next node up. An overcast sky is smoother than a clear one, so
//! there are fewer distances and functions, and no more observers than the altitudes below the base need
//! (`docs/notebook/2026-11-29.md`). Grounds of later orders lie closer together the nearer they are to the base, where
//! the lit cloud above changes its place in the sky fastest.

use serde::{Deserialize, Serialize};
use skyglow_physics::{CloudBase, PhysicsError, single_source::SourceGeometry};

/// Least distance of observers and sources below the base, metres: nearer, a point of light is a spot on the
/// cloud that no table resolves.
pub const CLOUD_CLEARANCE_M: f64 = 100.0;
/// Distances of tables under clouds at most: every second one of a clear sky's takes 0.2 to 0.3 % off a whole sky, every
/// third one 0.5 to 1.
pub(crate) const MAX_DISTANCES: usize = 24;
/// Observer altitudes of tables under clouds at most. With five, whole skies are up to 1.6 % off between the lowest.
const MAX_OBSERVERS: usize = 6;
/// Lowest source of a node under clouds, metres: the cubic over observer altitude looks no farther below the sea than
/// three neighbours are apart, with hardly any weight at the end.
pub(crate) const MIN_SOURCE_M: f64 = -1_000.0;

/// A layer of cloud as packs and requests name it: its base in whole metres above sea level, within the ranges of
/// [`CloudBase::new`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "WrittenClouds", into = "WrittenClouds")]
pub struct Clouds(CloudBase);

/// A layer of cloud as manifests have it, not yet checked.
#[derive(Serialize, Deserialize)]
struct WrittenClouds {
    base_m: u32,
    albedo: f64,
    /// Of the drops; tables of earlier programs have none.
    optical_depth: Option<f64>,
}

impl TryFrom<WrittenClouds> for Clouds {
    type Error = String;

    fn try_from(written: WrittenClouds) -> Result<Self, String> {
        if written.optical_depth.is_none() {
            return Err("its clouds are a Lambertian surface, as in earlier programs; make it again with `skyglow precompute \
                        --cloud-base`"
                .to_owned());
        }
        Self::new(written.base_m, written.albedo).map_err(|error| error.to_string())
    }
}

impl From<Clouds> for WrittenClouds {
    fn from(clouds: Clouds) -> Self {
        Self {
            base_m: clouds.base_m(),
            albedo: clouds.albedo(),
            optical_depth: Some(CloudBase::optical_depth(clouds.albedo())),
        }
    }
}

/// Highest observer and source of tables under clouds with a base at this altitude, metres above sea level.
pub fn ceiling_m(base_m: f64) -> f64 {
    base_m - CLOUD_CLEARANCE_M
}

impl Clouds {
    /// Checks the ranges of [`CloudBase::new`].
    ///
    /// # Errors
    /// As [`CloudBase::new`].
    pub fn new(base_m: u32, albedo: f64) -> Result<Self, PhysicsError> {
        Ok(Self(CloudBase::new(f64::from(base_m), albedo)?))
    }

    /// Altitude of the base above sea level, metres.
    pub fn base_m(self) -> u32 {
        self.0.altitude_m() as u32
    }

    /// Albedo of the base from below, 0..=0.95: that of [`CloudBase::albedo`].
    pub fn albedo(self) -> f64 {
        self.0.albedo()
    }

    /// As the physics has it.
    pub fn base(self) -> CloudBase {
        self.0
    }

    /// Highest observer and source of tables under these clouds, metres above sea level.
    pub fn ceiling_m(self) -> f64 {
        ceiling_m(self.0.altitude_m())
    }

    /// The flags of the command that makes such a pack.
    pub(crate) fn flags(self) -> String {
        let base = format!(" --cloud-base {}", self.base_m());
        if self.albedo() == CloudBase::DEFAULT_ALBEDO {
            base
        } else {
            format!("{base} --cloud-albedo {}", self.albedo())
        }
    }

    /// Its part of file names.
    pub(crate) fn file_name_part(clouds: Option<Self>) -> String {
        clouds.map_or_else(String::new, |clouds| format!("-clouds-{}", clouds.base_m()))
    }
}

/// An altitude as tables below a layer of cloud know it, metres.
pub(crate) fn clamped_below_clouds_m(altitude_m: f64, cloud: Option<CloudBase>) -> f64 {
    cloud.map_or(altitude_m, |base| altitude_m.min(ceiling_m(base.altitude_m())))
}

/// A node's geometry below a layer of cloud: the source clamped below it, and above [`MIN_SOURCE_M`].
pub(crate) fn clamped_geometry(geometry: SourceGeometry, cloud: Option<CloudBase>) -> SourceGeometry {
    let Some(base) = cloud else { return geometry };
    let source_altitude_m = geometry.source_altitude_m.clamp(MIN_SOURCE_M, ceiling_m(base.altitude_m()));
    SourceGeometry { source_altitude_m, ..geometry }
}

/// Widest step between sample altitudes that lie this far below a base, metres.
fn widest_step_m(depth_m: f64) -> f64 {
    0.45 * depth_m + 40.0
}

/// Observer altitudes of tables below a layer of cloud, from those of a clear sky: spread as there up to the highest below
/// the cloud. Closer towards the base they are no better, and the lowest need to be close.
pub(crate) fn observers_below(clear_m: &[f64], clouds: Clouds) -> Vec<f64> {
    points_below(clear_m, clear_m.len().min(MAX_OBSERVERS), clouds, |_| f64::INFINITY)
}

/// As many sample altitudes below a layer of cloud as `clear_m` has, from its first to its last or to the highest below
/// the cloud: as close together as there, and closer towards the base. All of `clear_m` where the base is far above it.
pub(crate) fn altitudes_below(clear_m: &[f64], clouds: Clouds) -> Vec<f64> {
    points_below(clear_m, clear_m.len(), clouds, widest_step_m)
}

/// `count` sample altitudes from the first of `clear_m` to its last or to the highest below the cloud, spread as there and
/// as steps of `widest_step_m`, by how far they lie below the base, are.
fn points_below(
    clear_m: &[f64],
    count: usize,
    clouds: Clouds,
    widest_step_m: impl Fn(f64) -> f64,
) -> Vec<f64> {
    let (Some(&lowest_m), Some(&last_m)) = (clear_m.first(), clear_m.last()) else { return Vec::new() };
    let highest_m = last_m.min(clouds.ceiling_m());
    if count < 2 || highest_m <= lowest_m {
        return vec![lowest_m];
    }
    // Sample points a metre, summed up in steps of a metre: the points are even in it.
    let clear_step_m = |altitude_m: f64| {
        let above = clear_m.partition_point(|&z| z <= altitude_m).clamp(1, clear_m.len() - 1);
        clear_m[above] - clear_m[above - 1]
    };
    let density = |altitude_m: f64| {
        1.0 / clear_step_m(altitude_m).min(widest_step_m(clouds.base().altitude_m() - altitude_m))
    };
    let steps = (highest_m - lowest_m).ceil() as usize;
    let step_m = (highest_m - lowest_m) / steps as f64;
    let at_step = |step: usize| lowest_m + step_m * (step as f64 + 0.5);
    let total: f64 = (0..steps).map(|step| density(at_step(step))).sum();
    let mut below_m = vec![lowest_m];
    let mut sum = 0.0;
    for step in 0..steps {
        sum += density(at_step(step));
        let wanted = total * below_m.len() as f64 / (count - 1) as f64;
        if below_m.len() < count - 1 && sum >= wanted - 1e-9 {
            below_m.push((lowest_m + step_m * (step + 1) as f64).round());
        }
    }
    below_m.push(highest_m);
    below_m
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables under a Lambertian surface, which earlier programs made, are refused with what to do.
    #[test]
    fn lambertian_clouds_are_refused() {
        let read = |json: &str| serde_json::from_str::<Clouds>(json).map_err(|error| error.to_string());
        let refused = read(r#"{"base_m":1500,"albedo":0.5}"#).unwrap_err();
        assert!(refused.contains("Lambertian") && refused.contains("precompute"), "{refused}");
        let clouds = Clouds::new(1_500, 0.5).unwrap();
        assert_eq!(read(&serde_json::to_string(&clouds).unwrap()), Ok(clouds));
    }

    /// Sources of nodes above a layer of cloud are clamped below it.
    #[test]
    fn sources_are_clamped_below_clouds() {
        let node = |observer_altitude_m, source_altitude_m| SourceGeometry {
            distance_m: 5_000.0,
            source_altitude_m,
            observer_altitude_m,
        };
        let cloud = Some(Clouds::new(1_000, 0.5).unwrap().base());
        assert_eq!(clamped_geometry(node(300.0, 500.0), cloud), node(300.0, 500.0));
        assert_eq!(clamped_geometry(node(300.0, 1_500.0), cloud), node(300.0, 900.0));
        assert_eq!(clamped_geometry(node(300.0, -1_700.0), cloud), node(300.0, MIN_SOURCE_M));
        assert_eq!(clamped_geometry(node(300.0, -1_700.0), None), node(300.0, -1_700.0));
        assert_eq!(clamped_geometry(node(1_900.0, 1_500.0), None), node(1_900.0, 1_500.0));
    }

    /// Sample altitudes end at the highest that there can be and are closest at the base.
    #[test]
    fn altitudes_below_clouds_end_at_the_ceiling() {
        let clear_m = [0.0, 300.0, 700.0, 1_200.0, 1_900.0, 2_900.0, 4_200.0, 6_000.0];
        for base_m in [200, 500, 1_000, 2_500, 5_000, 8_000] {
            let clouds = Clouds::new(base_m, 0.5).unwrap();
            let below_m = altitudes_below(&clear_m, clouds);
            assert_eq!(below_m.len(), clear_m.len(), "{below_m:?}");
            assert_eq!(below_m[0], 0.0);
            assert_eq!(below_m[7], clouds.ceiling_m().min(6_000.0));
            let steps_m: Vec<f64> = below_m.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(steps_m.iter().all(|&step_m| step_m > 0.0), "{below_m:?}");
            if base_m <= 5_000 {
                // Each step is short beside the way up to the base, from its lower end.
                for (&from_m, step_m) in below_m.iter().zip(&steps_m) {
                    let depth_m = f64::from(base_m) - from_m;
                    assert!(*step_m < 0.7 * depth_m, "{below_m:?}");
                }
                assert!(steps_m[6] < steps_m[5], "{below_m:?}");
            }
        }
        let high = Clouds::new(12_000, 0.5).unwrap();
        assert_eq!(altitudes_below(&clear_m, high), clear_m);
        assert_eq!(altitudes_below(&[0.0, 6_000.0], Clouds::new(1_500, 0.5).unwrap()), [0.0, 1_400.0]);
        assert_eq!(altitudes_below(&[0.0], Clouds::new(1_000, 0.5).unwrap()), [0.0]);
    }

    /// Observers of tables are few, end at the ceiling, and are spread as those of a clear sky.
    #[test]
    fn observers_below_clouds_are_few() {
        let clear_m = crate::TableAxes::full().observer_altitude_m;
        let below_m = |base_m| observers_below(&clear_m, Clouds::new(base_m, 0.5).unwrap());
        let wanted_m = [0.0, 200.0, 433.0, 700.0, 1_033.0, 1_400.0];
        let is_wanted = |(at_m, wanted_m): (&f64, f64)| (at_m - wanted_m).abs() < 2.0;
        assert!(below_m(1_500).iter().zip(wanted_m).all(is_wanted), "{:?}", below_m(1_500));
        for base_m in [200, 500, 800, 3_000, 8_000] {
            let below_m = below_m(base_m);
            assert_eq!((below_m.len(), below_m[0]), (MAX_OBSERVERS, 0.0), "{below_m:?}");
            assert_eq!(below_m[5], f64::from(base_m - 100).min(6_000.0));
            let steps_m: Vec<f64> = below_m.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(steps_m.iter().all(|&m| m > 0.0), "{below_m:?}");
            // No step is much shorter than the one below it.
            assert!(steps_m.windows(2).all(|pair| pair[1] > 0.9 * pair[0] - 2.0), "{below_m:?}");
        }
        assert_eq!(observers_below(&[0.0, 6_000.0], Clouds::new(1_500, 0.5).unwrap()), [0.0, 1_400.0]);
    }

    #[test]
    fn what_no_layer_of_cloud_is_is_refused() {
        for (base_m, albedo) in [(100, 0.5), (12_001, 0.5), (1_000, 1.1), (1_000, f64::NAN)] {
            assert!(Clouds::new(base_m, albedo).is_err(), "{base_m} {albedo}");
        }
    }

    /// Clouds are read as they were written, and impossible ones are refused by name.
    #[test]
    fn clouds_round_trip_and_bad_ones_are_refused() {
        let clouds = Clouds::new(1_500, 0.6).unwrap();
        let text = serde_json::to_string(&clouds).unwrap();
        let depth = CloudBase::optical_depth(0.6);
        assert_eq!(text, format!(r#"{{"base_m":1500,"albedo":0.6,"optical_depth":{depth:?}}}"#));
        assert_eq!(serde_json::from_str::<Clouds>(&text).unwrap(), clouds);
        let refused = serde_json::from_str::<Clouds>(r#"{"base_m":100,"albedo":0.6,"optical_depth":20.0}"#)
            .unwrap_err();
        assert!(refused.to_string().contains("cloud_base"), "{refused}");
    }
}
