//! The packs of a folder.

use crate::{error::RenderError, pack_kind::PackKind};
use skyglow_scene::{RING_COUNT, ring_distance_m};
use skyglow_tables::{Clouds, Manifest, Pack, ResidentTables};
use std::{path::PathBuf, sync::Arc};

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
        MultipleAxes, Scattering, TableAxes,
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

    /// Packs under clouds are kinds of their own and those of one base have one albedo.
    #[test]
    fn packs_under_clouds_are_kinds_of_their_own() {
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
