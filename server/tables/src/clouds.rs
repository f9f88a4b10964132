//! The layer of cloud that a pack was made under, and what its sample points become below it.
//!
//! Packs under clouds have the axes of all others, so that one set of interpolation weights serves them all. Nodes with
//! observer or source higher than [`Clouds::ceiling_m`] repeat the highest one below it; no such place is ever asked for,
//! but interpolation reaches for the next node up.

use serde::{Deserialize, Serialize};
use skyglow_physics::{CloudBase, PhysicsError, single_source::SourceGeometry};

/// Room that observers and sources have below the base at least, metres: nearer, a point of light is a spot on the
/// cloud that no table resolves.
const CLOUD_ROOM_M: f64 = 100.0;

/// A layer of cloud as packs and requests name it: its base in whole metres above sea level, within the ranges of
/// [`CloudBase::new`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "WrittenClouds", into = "WrittenClouds")]
pub struct Clouds {
    base_m: u32,
    base: CloudBase,
}

/// A layer of cloud as manifests have it, not yet checked.
#[derive(Serialize, Deserialize)]
struct WrittenClouds {
    base_m: u32,
    albedo: f64,
}

impl TryFrom<WrittenClouds> for Clouds {
    type Error = PhysicsError;

    fn try_from(written: WrittenClouds) -> Result<Self, PhysicsError> {
        Self::new(written.base_m, written.albedo)
    }
}

impl From<Clouds> for WrittenClouds {
    fn from(clouds: Clouds) -> Self {
        Self { base_m: clouds.base_m, albedo: clouds.albedo() }
    }
}

/// Highest observer and source that tables know under clouds with a base at this altitude, metres above sea level.
pub fn ceiling_m(base_m: f64) -> f64 {
    base_m - CLOUD_ROOM_M
}

impl Clouds {
    /// Checks the ranges of [`CloudBase::new`].
    ///
    /// # Errors
    /// As [`CloudBase::new`].
    pub fn new(base_m: u32, albedo: f64) -> Result<Self, PhysicsError> {
        Ok(Self { base_m, base: CloudBase::new(f64::from(base_m), albedo)? })
    }

    /// Altitude of the base above sea level, metres.
    pub fn base_m(self) -> u32 {
        self.base_m
    }

    /// Lambertian albedo of the base from below, 0..=1.
    pub fn albedo(self) -> f64 {
        self.base.albedo()
    }

    /// As the physics has it.
    pub fn base(self) -> CloudBase {
        self.base
    }

    /// Highest observer and source that tables under these clouds know, metres above sea level.
    pub fn ceiling_m(self) -> f64 {
        ceiling_m(self.base.altitude_m())
    }

    /// The flags of the command that makes such a pack.
    pub(crate) fn flags(self) -> String {
        let base = format!(" --cloud-base {}", self.base_m);
        if self.albedo() == CloudBase::DEFAULT_ALBEDO {
            base
        } else {
            format!("{base} --cloud-albedo {}", self.albedo())
        }
    }

    /// What file names say of it.
    pub(crate) fn file_name_part(clouds: Option<Self>) -> String {
        clouds.map_or_else(String::new, |clouds| format!("-clouds-{}", clouds.base_m))
    }
}

/// An altitude as tables below a layer of cloud know it, metres.
pub(crate) fn held_below_clouds_m(altitude_m: f64, cloud: Option<CloudBase>) -> f64 {
    cloud.map_or(altitude_m, |base| altitude_m.min(ceiling_m(base.altitude_m())))
}

/// A node's geometry below a layer of cloud: the observer held below it, the source at the same offset from the
/// observer where that lies below it too.
pub(crate) fn held_geometry(geometry: SourceGeometry, cloud: Option<CloudBase>) -> SourceGeometry {
    let lowered_m = geometry.observer_altitude_m - held_below_clouds_m(geometry.observer_altitude_m, cloud);
    SourceGeometry {
        observer_altitude_m: geometry.observer_altitude_m - lowered_m,
        source_altitude_m: held_below_clouds_m(geometry.source_altitude_m - lowered_m, cloud),
        ..geometry
    }
}

/// Sample altitudes below a layer of cloud: those of an axis that lie well below it, the highest that there can be, and
/// some between where few are left.
pub(crate) fn altitudes_below(clear_m: &[f64], ceiling_m: f64) -> Vec<f64> {
    let mut below_m: Vec<f64> = clear_m.iter().copied().filter(|&z| z < 0.75 * ceiling_m).collect();
    if clear_m.last().is_some_and(|&highest_m| highest_m <= ceiling_m) {
        return clear_m.to_vec();
    }
    below_m.push(ceiling_m);
    while below_m.len() < clear_m.len().min(4) {
        below_m.insert(1, 0.5 * (below_m[0] + below_m[1]));
    }
    below_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_above_a_layer_of_cloud_repeat_the_highest_below_it_at_the_same_offset() {
        let node = |observer_altitude_m, source_altitude_m| SourceGeometry {
            distance_m: 5_000.0,
            source_altitude_m,
            observer_altitude_m,
        };
        let cloud = Some(Clouds::new(1_000, 0.5).unwrap().base());
        assert_eq!(held_geometry(node(300.0, 500.0), cloud), node(300.0, 500.0));
        assert_eq!(held_geometry(node(300.0, 1_500.0), cloud), node(300.0, 900.0));
        assert_eq!(held_geometry(node(1_900.0, 1_500.0), cloud), node(900.0, 500.0));
        assert_eq!(held_geometry(node(1_900.0, 1_500.0), None), node(1_900.0, 1_500.0));
    }

    #[test]
    fn sample_altitudes_end_at_the_highest_that_there_can_be_and_are_four_at_least() {
        let clear_m = [0.0, 600.0, 1_400.0, 2_600.0, 4_200.0, 6_000.0];
        assert_eq!(altitudes_below(&clear_m, 900.0), [0.0, 300.0, 600.0, 900.0]);
        assert_eq!(altitudes_below(&clear_m, 1_900.0), [0.0, 600.0, 1_400.0, 1_900.0]);
        assert_eq!(altitudes_below(&clear_m, 3_900.0), [0.0, 600.0, 1_400.0, 2_600.0, 3_900.0]);
        assert_eq!(altitudes_below(&clear_m, 200.0), [0.0, 50.0, 100.0, 200.0]);
        assert_eq!(altitudes_below(&clear_m, 11_900.0), clear_m);
        assert_eq!(altitudes_below(&[0.0], 900.0), [0.0]);
    }

    #[test]
    fn what_no_layer_of_cloud_is_is_refused() {
        for (base_m, albedo) in [(100, 0.5), (12_001, 0.5), (1_000, 1.1), (1_000, f64::NAN)] {
            assert!(Clouds::new(base_m, albedo).is_err(), "{base_m} {albedo}");
        }
    }

    #[test]
    fn clouds_are_read_as_they_were_written_and_impossible_ones_are_refused_by_name() {
        let clouds = Clouds::new(1_500, 0.6).unwrap();
        let text = serde_json::to_string(&clouds).unwrap();
        assert_eq!(text, r#"{"base_m":1500,"albedo":0.6}"#);
        assert_eq!(serde_json::from_str::<Clouds>(&text).unwrap(), clouds);
        let refused = serde_json::from_str::<Clouds>(r#"{"base_m":100,"albedo":0.6}"#).unwrap_err();
        assert!(refused.to_string().contains("cloud_base"), "{refused}");
    }
}
