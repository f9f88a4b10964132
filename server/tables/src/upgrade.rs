//! Packs of the format before, made into packs of this one: their basis and open tables stay bit for bit, and sources
//! behind skylines are added. The result is the pack that a full precompute makes.

use crate::{
    blocked::BlockedAxes,
    checkpoint::Checkpoint,
    error::TablesError,
    manifest::{Manifest, PackParameters, Scattering},
    multiple::FIELD_VERSION,
    pack::Pack,
    precompute::{PrecomputeOptions, Progress, finish, make_multiple},
};
use skyglow_physics::{Atmosphere, Turbidity};
use std::path::{Path, PathBuf};

/// The options that a pack was made with, sources behind skylines apart.
fn options_of(manifest: &Manifest, blocked: Option<BlockedAxes>) -> Result<PrecomputeOptions, TablesError> {
    let turbidity = Turbidity::new(manifest.turbidity)?;
    let full = PrecomputeOptions::full(turbidity);
    Ok(PrecomputeOptions {
        turbidity,
        scattering: manifest.scattering,
        multiple: manifest.parameters.multiple.clone().unwrap_or(full.multiple),
        clouds: manifest.clouds,
        axes: manifest.axes.clone(),
        blocked,
        basis_count: manifest.basis_count,
        training_geometries: manifest.parameters.training_geometries,
        fit_iterations: manifest.parameters.fit_iterations,
        error_sources: manifest.measured_error.sources,
    })
}

/// Refuses a pack that was fitted with other constants than this program's, as far as its manifest says them: the tables
/// added would not belong to it.
fn check_constants(path: &Path, old: &Manifest, options: &PrecomputeOptions) -> Result<(), TablesError> {
    let turbidity = Turbidity::new(old.turbidity)?;
    let mut wanted =
        options.parameters(turbidity).manifest(old.measured_error.clone(), String::new()).parameters;
    if old.parameters.fit.is_none() {
        wanted.fit = None;
    }
    let fields_are_ours =
        options.multiple.field_version == FIELD_VERSION || old.scattering == Scattering::Single;
    if old.parameters == wanted && fields_are_ours {
        return Ok(());
    }
    Err(TablesError::Refused {
        path: path.to_owned(),
        reason:
            "it was made with other constants than this program's; make it again with `skyglow precompute`"
                .to_owned(),
    })
}

/// Makes packs of this format in `out` of packs of this format or the one before, which must differ in turbidity
/// alone, and returns their paths in ascending order of turbidity; `blocked` as in [`PrecomputeOptions`]. Several at
/// once share most of the work; a killed run goes on where it stopped. `out` may be the folder of the packs themselves:
/// each is replaced when its successor is whole.
///
/// # Errors
/// [`TablesError`] naming the file or the step; a pack made with other options than the first is refused.
pub fn add_blocked(
    paths: &[PathBuf],
    blocked: Option<&BlockedAxes>,
    out: &Path,
    progress: &dyn Progress,
) -> Result<Vec<PathBuf>, TablesError> {
    let mut old = paths
        .iter()
        .map(|path| Ok((path, Pack::open_older(path)?)))
        .collect::<Result<Vec<_>, TablesError>>()?;
    old.sort_by(|a, b| a.1.manifest().turbidity.total_cmp(&b.1.manifest().turbidity));
    if let Some(pair) = old.windows(2).find(|p| p[0].1.manifest().turbidity == p[1].1.manifest().turbidity) {
        return Err(TablesError::Refused {
            path: pair[1].0.clone(),
            reason: format!("{} has the same turbidity; convert one of them alone", pair[0].0.display()),
        });
    }
    let Some((_, first)) = old.first() else { return Ok(Vec::new()) };
    let options = options_of(first.manifest(), blocked.cloned())?;
    let mut turbidities = Vec::with_capacity(old.len());
    for (path, pack) in &old {
        let own = options_of(pack.manifest(), blocked.cloned())?;
        turbidities.push(own.turbidity);
        if (PrecomputeOptions { turbidity: options.turbidity, ..own }) != options {
            return Err(TablesError::Refused {
                path: (*path).clone(),
                reason: "it was made with other options than the packs beside it; convert it alone"
                    .to_owned(),
            });
        }
    }
    for (path, pack) in &old {
        check_constants(path, pack.manifest(), &options)?;
    }
    std::fs::create_dir_all(out).map_err(TablesError::io(out))?;
    let parameters: Vec<PackParameters> = turbidities.iter().map(|&t| options.parameters(t)).collect();
    let atmospheres: Vec<Atmosphere> = turbidities.iter().map(|&t| options.atmosphere(t)).collect();
    let checkpoints: Vec<Checkpoint> =
        parameters.iter().map(|p| Checkpoint::open(out, p)).collect::<Result<_, _>>()?;
    let multiple = make_multiple(&options, &atmospheres, &checkpoints, progress)?;
    let packs = parameters
        .iter()
        .zip(old)
        .map(|(parameters, (_, old))| {
            let manifest = parameters.manifest(old.manifest().measured_error.clone(), String::new());
            Pack::from_parts(manifest, old.log_scale, old.shape, old.basis_spectrum)
        })
        .collect();
    finish(&options, &atmospheres, &multiple, packs, checkpoints, out, progress)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{manifest::FORMAT_BEFORE, precompute, precompute::Silent};

    #[test]
    fn a_pack_of_the_format_before_becomes_the_one_that_a_full_precompute_makes() {
        let turbidity = Turbidity::new(2.0).unwrap();
        let with = PrecomputeOptions::coarse(turbidity);
        let without = PrecomputeOptions { blocked: None, ..with.clone() };
        let folders: [tempfile::TempDir; 3] = std::array::from_fn(|_| tempfile::tempdir().unwrap());
        let whole = precompute(&with, folders[0].path(), &Silent).unwrap();
        let open = precompute(&without, folders[1].path(), &Silent).unwrap();
        // As the format before had it: shapes as they are, and neither skylines nor constants in the manifest.
        let mut old = Pack::open(&open).unwrap();
        old.manifest_mut().format_version = FORMAT_BEFORE;
        old.manifest_mut().parameters.fit = None;
        let old = old.write(folders[1].path()).unwrap();
        let text = std::fs::read_to_string(old.with_extension("json")).unwrap();
        std::fs::write(old.with_extension("json"), text.replace("  \"blocked\": null,\n", "")).unwrap();
        let refused = Pack::open(&old).unwrap_err().to_string();
        assert!(refused.contains("format 2"), "{refused}");
        let made = add_blocked(&[old], with.blocked.as_ref(), folders[2].path(), &Silent).unwrap();
        assert!(std::fs::read(&made[0]).unwrap() == std::fs::read(&whole).unwrap(), "the packs differ");
        // The open tables alone are another file, so the check can fail; and they are the same tables.
        let rings = [300.0, 5_000.0, 200_000.0];
        let (whole, open) = (Pack::open(&whole).unwrap().resident(&rings), {
            let path = folders[1].path().join("again");
            Pack::open(&precompute(&without, &path, &Silent).unwrap()).unwrap().resident(&rings)
        });
        assert!(open.blocked.is_none() && whole.checksum != open.checksum);
        assert_eq!((&whole.log_scale, &whole.shape), (&open.log_scale, &open.shape));
    }
}
