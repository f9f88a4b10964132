//! Fields that an earlier run solved.

use skyglow_physics::{Atmosphere, multiple_scattering::DEFAULT_GROUND_ALBEDO};
use skyglow_tables::{MultipleAxes, MultipleTable};
use std::{error::Error, path::Path};

/// The table whose parts `multiple_accuracy` left; what is missing is solved (minutes).
pub(crate) fn kept_table(atmosphere: Atmosphere, cache: &Path) -> Result<MultipleTable, Box<dyn Error>> {
    let kept = |ground: usize, offset: usize| {
        let bytes = std::fs::read(cache.join(format!("{ground:02}-{offset:02}"))).ok()?;
        Some(bytemuck::pod_collect_to_vec::<u8, f32>(&bytes))
    };
    let axes = MultipleAxes::full(DEFAULT_GROUND_ALBEDO);
    Ok(MultipleTable::solve(atmosphere, &axes, kept, |_, _, _| Ok(()))?)
}
