//! The packs of a folder, and which of them turbidity is interpolated between.

use crate::error::RenderError;
use serde::Serialize;
use skyglow_scene::{RING_COUNT, ring_distance_m};
use skyglow_tables::{Clouds, Manifest, Pack, ResidentTables, Scattering};
use std::{fmt, path::PathBuf, sync::Arc};

/// What packs have in common that turbidity is interpolated between. Under one sky the order is from the coarsest model
/// of the air to the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct PackKind {
    /// Base of the closed layer of cloud above sea level, metres; None under a clear sky, which comes first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cloud_base_m: Option<u32>,
    /// Orders of scattering.
    pub scattering: Scattering,
}

impl PackKind {
    /// The kind of a pack.
    pub fn of(tables: &ResidentTables) -> Self {
        Self { cloud_base_m: tables.clouds.map(Clouds::base_m), scattering: tables.scattering }
    }

    /// The kind of the pack that a manifest describes.
    pub fn of_manifest(manifest: &Manifest) -> Self {
        Self { cloud_base_m: manifest.clouds.map(Clouds::base_m), scattering: manifest.scattering }
    }

    /// Altitude of the base above sea level, metres: no light comes through it. Infinite under a clear sky.
    pub fn cloud_altitude_m(self) -> f64 {
        self.cloud_base_m.map_or(f64::INFINITY, f64::from)
    }
}

impl fmt::Display for PackKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} scattering", self.scattering.name())?;
        self.cloud_base_m.map_or(Ok(()), |base_m| write!(out, " under clouds at {base_m} m"))
    }
}

/// The resident packs of one kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResidentKind {
    /// The kind.
    #[serde(flatten)]
    pub kind: PackKind,
    /// Turbidities of its packs, ascending; never empty.
    pub turbidities: Vec<f64>,
    /// Most basis functions that any of them has.
    pub basis_count: usize,
    /// Whether they have tables of sources behind skylines: all of them, or it counts for none.
    pub hides_lights: bool,
    /// Index of the first of them in the table set; the others follow.
    #[serde(skip)]
    pub(crate) first: usize,
}

impl ResidentKind {
    /// The kinds of packs that are sorted by kind, then turbidity.
    pub(crate) fn all_of(tables: &[Arc<ResidentTables>]) -> Vec<Self> {
        let mut first = 0;
        tables
            .chunk_by(|a, b| PackKind::of(a) == PackKind::of(b))
            .map(|packs| {
                let kind = Self {
                    kind: PackKind::of(&packs[0]),
                    turbidities: packs.iter().map(|pack| pack.turbidity).collect(),
                    basis_count: packs.iter().map(|pack| pack.basis_count).max().unwrap_or(0),
                    hides_lights: packs.iter().all(|pack| pack.blocked.is_some()),
                    first,
                };
                first += packs.len();
                kind
            })
            .collect()
    }
}

/// Opens packs and lays them out on the rings of the scenes' polar grids; the manifests come sorted by kind, then
/// turbidity.
///
/// # Errors
/// [`RenderError::Tables`] naming the file that is refused; [`RenderError::IncompatibleTables`] where packs of one
/// kind were computed over grounds or under clouds of different albedo: what lies between them is the sky of neither.
pub fn resident_tables(packs: &[PathBuf]) -> Result<(Vec<Arc<ResidentTables>>, Vec<Manifest>), RenderError> {
    let ring_distances_m: Vec<f64> = (0..RING_COUNT).map(ring_distance_m).collect();
    let mut tables = Vec::new();
    let mut manifests = Vec::new();
    for path in packs {
        let pack = Pack::open(path)?;
        tables.push(Arc::new(pack.resident(&ring_distances_m)));
        manifests.push(pack.manifest().clone());
    }
    manifests.sort_by(|a, b| {
        PackKind::of_manifest(a).cmp(&PackKind::of_manifest(b)).then(a.turbidity.total_cmp(&b.turbidity))
    });
    check_albedos(&manifests)?;
    Ok((tables, manifests))
}

fn check_albedos(sorted: &[Manifest]) -> Result<(), RenderError> {
    let words = |albedo: Option<f64>| albedo.map_or_else(|| "none".to_owned(), |albedo| albedo.to_string());
    for pair in sorted.windows(2) {
        let [before, pack] = pair else { continue };
        let kind = PackKind::of_manifest(pack);
        if kind != PackKind::of_manifest(before) {
            continue;
        }
        let cloud_albedo = |manifest: &Manifest| manifest.clouds.map(Clouds::albedo);
        for (what, ours, theirs) in [
            ("ground", pack.ground_albedo, before.ground_albedo),
            ("cloud", cloud_albedo(pack), cloud_albedo(before)),
        ] {
            if ours != theirs {
                return Err(RenderError::IncompatibleTables {
                    turbidity: pack.turbidity,
                    kind,
                    reason: format!(
                        "its {what} albedo is {}, that of the pack for turbidity {} is {}",
                        words(ours),
                        before.turbidity,
                        words(theirs)
                    ),
                });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_tables::{
        Clouds, MultipleAxes, TableAxes,
        manifest::{MeasuredError, PackParameters},
    };

    fn manifest(turbidity: f64, scattering: Scattering, ground_albedo: Option<f64>) -> Manifest {
        let parameters = PackParameters {
            turbidity,
            scattering,
            multiple: ground_albedo.map(MultipleAxes::coarse),
            clouds: None,
            axes: TableAxes::coarse(),
            basis_count: 8,
            training_geometries: 1,
            fit_iterations: 1,
            blocked: None,
            fit: skyglow_tables::fit_constants::FitConstants::current(),
        };
        parameters.manifest(MeasuredError::default(), String::new())
    }

    #[test]
    fn packs_of_one_kind_lie_over_one_ground() {
        let first_order = manifest(2.0, Scattering::Single, None);
        let all_orders = |turbidity, albedo| manifest(turbidity, Scattering::Multiple, Some(albedo));
        check_albedos(&[first_order.clone(), all_orders(2.0, 0.15), all_orders(3.0, 0.15)]).unwrap();
        let snow = check_albedos(&[first_order, all_orders(2.0, 0.15), all_orders(3.0, 0.8)]).unwrap_err();
        assert_eq!(
            snow.to_string(),
            "the pack for turbidity 3 with multiple scattering does not fit: its ground albedo is 0.8, that of the \
             pack for turbidity 2 is 0.15"
        );
    }

    #[test]
    fn packs_under_clouds_are_kinds_of_their_own_and_those_of_one_base_have_one_albedo() {
        let under = |turbidity, base_m, albedo| Manifest {
            clouds: Some(Clouds::new(base_m, albedo).unwrap()),
            ..manifest(turbidity, Scattering::Single, None)
        };
        check_albedos(&[
            manifest(3.0, Scattering::Single, None),
            under(2.0, 1_000, 0.5),
            under(3.0, 2_000, 0.7),
        ])
        .unwrap();
        let bright = check_albedos(&[under(2.0, 1_000, 0.5), under(3.0, 1_000, 0.7)]).unwrap_err();
        assert_eq!(
            bright.to_string(),
            "the pack for turbidity 3 with single scattering under clouds at 1000 m does not fit: its cloud albedo is \
             0.7, that of the pack for turbidity 2 is 0.5"
        );
        let kind = |manifest| PackKind::of_manifest(&manifest);
        assert!(kind(manifest(6.0, Scattering::Multiple, Some(0.15))) < kind(under(2.0, 1_000, 0.5)));
    }
}
