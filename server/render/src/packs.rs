//! The packs of a folder.

use crate::{
    error::RenderError,
    pack_kind::{PackKind, ResidentKind},
};
use skyglow_scene::{RING_COUNT, ring_distance_m};
use skyglow_tables::{Clouds, Manifest, Pack, ResidentTables, TablesError};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// Times its lower turbidity that the upper one of two packs may be where a pack between them is left out. With one of the
/// program's own packs missing (ratios up to 1.9) the zenith is off by up to 0.5 %, with two (2.3) by up to 0.8 %.
const MAX_RATIO_OVER_A_HOLE: f64 = 2.0;

/// A pack that is left out because its file is damaged.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOutPack {
    /// Name of its file.
    pub name: String,
    /// What is wrong with it.
    pub reason: String,
    /// Kind and turbidity, where its manifest can still be read.
    pub was: Option<(PackKind, f64)>,
}

impl LeftOutPack {
    fn new(path: &Path, error: &TablesError) -> Self {
        let was = Pack::manifest_of_refused(path);
        Self {
            name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            reason: error.to_string(),
            was: was.map(|manifest| (PackKind::of_manifest(&manifest), manifest.turbidity)),
        }
    }

    /// Spans of turbidity, without their ends, that the packs of a kind no longer serve: too wide to be interpolated over, and one
    /// that is left out lay inside, or may have.
    pub fn unserved(kind: &ResidentKind, left_out: &[Self]) -> Vec<(f64, f64)> {
        let spans = kind.turbidities.windows(2).map(|pair| (pair[0], pair[1]));
        spans
            .filter(|&(lower, upper)| {
                let lay_inside = |pack: &Self| {
                    pack.was.is_none_or(|(of, turbidity)| {
                        of == kind.kind && lower < turbidity && turbidity < upper
                    })
                };
                upper > MAX_RATIO_OVER_A_HOLE * lower && left_out.iter().any(lay_inside)
            })
            .collect()
    }
}

/// The packs of a folder that can be served.
#[derive(Debug)]
pub struct UndamagedTables {
    /// On the rings of the scenes' polar grids.
    pub tables: Vec<Arc<ResidentTables>>,
    /// What they are, by kind, then turbidity.
    pub manifests: Vec<Manifest>,
    /// The others.
    pub left_out: Vec<LeftOutPack>,
}

/// As [`resident_tables`], without the packs that are damaged, and what those are.
///
/// * `most_bytes`: of memory for all of them. What does not fit is not even opened.
///
/// # Errors
/// [`RenderError::Tables`] of the first where all are damaged; [`RenderError::IncompatibleTables`];
/// [`RenderError::TooManyPacks`].
pub fn undamaged_tables(packs: &[PathBuf], most_bytes: u64) -> Result<UndamagedTables, RenderError> {
    let (mut opened, mut left_out, mut first) = (Vec::new(), Vec::new(), None);
    for path in packs {
        check_room(packs.len(), &opened, most_bytes)?;
        match Pack::open(path) {
            Ok(pack) => opened.push(laid_out(&pack)),
            Err(error) => {
                left_out.push(LeftOutPack::new(path, &error));
                first.get_or_insert(error);
            }
        }
    }
    if let Some(error) = first.filter(|_| opened.is_empty()) {
        return Err(error.into());
    }
    let (tables, manifests) = checked(opened)?;
    Ok(UndamagedTables { tables, manifests, left_out })
}

/// Refuses the next of so many packs where it does not fit beside those that are open, if it is as large as the last.
fn check_room(
    count: usize,
    opened: &[(Arc<ResidentTables>, Manifest)],
    most_bytes: u64,
) -> Result<(), RenderError> {
    let bytes = |(tables, _): &(Arc<ResidentTables>, _)| tables.byte_count() as u64;
    let (taken, next) = (opened.iter().map(bytes).sum::<u64>(), opened.last().map_or(0, bytes));
    if taken + next <= most_bytes {
        return Ok(());
    }
    let needed_bytes = taken + (count - opened.len()) as u64 * next;
    Err(RenderError::TooManyPacks { count, needed_bytes, most_bytes })
}

/// Opens packs and lays them out on the rings of the scenes' polar grids; the manifests come sorted by kind, then
/// turbidity.
///
/// # Errors
/// [`RenderError::Tables`] naming the file that is refused; [`RenderError::IncompatibleTables`] where packs of one
/// kind were computed over grounds or under clouds of different albedo: what lies between them is the sky of neither.
pub fn resident_tables(packs: &[PathBuf]) -> Result<(Vec<Arc<ResidentTables>>, Vec<Manifest>), RenderError> {
    checked(packs.iter().map(|path| Ok(laid_out(&Pack::open(path)?))).collect::<Result<_, TablesError>>()?)
}

fn laid_out(pack: &Pack) -> (Arc<ResidentTables>, Manifest) {
    let ring_distances_m: Vec<f64> = (0..RING_COUNT).map(ring_distance_m).collect();
    (Arc::new(pack.resident(&ring_distances_m)), pack.manifest().clone())
}

fn checked(
    packs: Vec<(Arc<ResidentTables>, Manifest)>,
) -> Result<(Vec<Arc<ResidentTables>>, Vec<Manifest>), RenderError> {
    let (tables, mut manifests): (Vec<_>, Vec<Manifest>) = packs.into_iter().unzip();
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

    /// One missing pack of ours is interpolated over, two beside each other are not, and an unknown one may be anywhere.
    #[test]
    fn a_wide_hole_in_turbidity_is_not_served() {
        let kind = |turbidities: &[f64]| ResidentKind {
            kind: PackKind { cloud_base_m: None, scattering: Scattering::Multiple },
            turbidities: turbidities.to_vec(),
            basis_count: 8,
            hides_lights: true,
            first: 0,
        };
        let left_out = |was: Option<f64>| LeftOutPack {
            name: "x.skyglow".into(),
            reason: "altered".into(),
            was: was.map(|turbidity| (kind(&[1.0]).kind, turbidity)),
        };
        let unserved = |turbidities: &[f64], was: &[Option<f64>]| {
            let packs: Vec<_> = was.iter().map(|was| left_out(*was)).collect();
            LeftOutPack::unserved(&kind(turbidities), &packs)
        };
        assert_eq!(unserved(&[1.5, 2.0, 3.5, 4.75, 6.0], &[Some(2.5)]), []);
        assert_eq!(unserved(&[1.5, 2.0, 4.75, 6.0], &[Some(2.5), Some(3.5)]), [(2.0, 4.75)]);
        assert_eq!(unserved(&[1.5, 2.0, 6.0], &[Some(1.7)]), []);
        assert_eq!(unserved(&[1.5, 2.0, 6.0], &[None]), [(2.0, 6.0)]);
        assert_eq!(unserved(&[2.0, 6.0], &[]), []);
    }

    /// A pack that does not fit beside the open ones is refused before it is opened.
    #[test]
    fn packs_that_do_not_fit_are_not_opened() {
        let tables = crate::synthetic::table_set(&[1.5], 8).swap_remove(0);
        let bytes = tables.byte_count() as u64;
        let opened = [(tables, manifest(1.5, Scattering::Multiple, None))];
        check_room(3, &[], 0).unwrap();
        check_room(3, &opened, 2 * bytes).unwrap();
        let refused = check_room(3, &opened, 2 * bytes - 1).unwrap_err();
        let RenderError::TooManyPacks { count: 3, needed_bytes, most_bytes } = refused else {
            panic!("{refused}");
        };
        assert_eq!((needed_bytes, most_bytes), (3 * bytes, 2 * bytes - 1));
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
