//! Tables of later orders whose parts are stored in a folder, one turbidity a folder.

use skyglow_physics::{Atmosphere, multiple_scattering::DEFAULT_GROUND_ALBEDO};
use skyglow_tables::{MultipleAxes, MultipleTable, TablesError};
use std::path::Path;

/// The full table for an atmosphere: parts that the folder holds are read, others solved (minutes) and stored there.
///
/// # Errors
/// A folder that cannot be written; what the solver says.
pub fn stored_table(atmosphere: Atmosphere, folder: &Path) -> Result<MultipleTable, TablesError> {
    let io = |path: &Path, source| TablesError::Io { path: path.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(|source| io(folder, source))?;
    let file = |ground: usize, offset: usize| folder.join(format!("{ground:02}-{offset:02}"));
    MultipleTable::solve(
        atmosphere,
        &MultipleAxes::full(DEFAULT_GROUND_ALBEDO),
        |ground, offset| {
            let bytes = std::fs::read(file(ground, offset)).ok()?;
            Some(bytemuck::pod_collect_to_vec::<u8, f32>(&bytes))
        },
        |ground, offset, part| {
            println!("# ground {ground} offset {offset}");
            let path = file(ground, offset);
            std::fs::write(&path, bytemuck::cast_slice::<f32, u8>(part)).map_err(|source| io(&path, source))
        },
    )
}
