//! A grid as sections of a binary file.

use crate::grid::{GeographicAxes, Grid};
use crate::lattice::Lattice;
use crate::sections::{Flaw, Sections};
use glam::DVec3;
use std::borrow::Cow;

/// The sections `size`, and `axes` or `nodes`, each with a suffix.
pub(crate) fn to_sections(grid: &Grid, suffix: &str) -> Vec<(String, Cow<'static, [u8]>)> {
    let step = grid.lattice().map_or(0, Lattice::step);
    let size = [grid.width, grid.height, step];
    let mut sections = vec![(format!("size{suffix}"), Cow::Owned(bytemuck::cast_slice(&size).to_vec()))];
    if let Some(axes) = grid.axes() {
        let numbers = [
            axes.first_longitude_deg,
            axes.first_latitude_deg,
            axes.longitude_step_deg,
            axes.latitude_step_deg,
        ];
        sections.push((format!("axes{suffix}"), Cow::Owned(bytemuck::cast_slice(&numbers).to_vec())));
    }
    if let Some(lattice) = grid.lattice() {
        let numbers: Vec<f64> = lattice.nodes().iter().flat_map(|node| node.to_array()).collect();
        sections.push((format!("nodes{suffix}"), Cow::Owned(bytemuck::cast_slice(&numbers).to_vec())));
    }
    sections
}

/// Undoes [`to_sections`].
pub(crate) fn from_sections(sections: &Sections<'_>, suffix: &str) -> Result<Grid, Flaw> {
    let size = sections.numbers::<u32>(&format!("size{suffix}"))?;
    let &[width, height, step] = size.as_slice() else { return Err("has no grid size".to_owned()) };
    if width == 0 || height == 0 {
        return Err("has an empty grid".to_owned());
    }
    if step == 0 {
        let axes = sections.numbers::<f64>(&format!("axes{suffix}"))?;
        let &[first_longitude_deg, first_latitude_deg, longitude_step_deg, latitude_step_deg] =
            axes.as_slice()
        else {
            return Err("has no grid axes".to_owned());
        };
        let axes =
            GeographicAxes { first_longitude_deg, first_latitude_deg, longitude_step_deg, latitude_step_deg };
        return Ok(Grid::geographic(axes, width, height));
    }
    let numbers = sections.numbers::<f64>(&format!("nodes{suffix}"))?;
    let nodes = numbers.chunks_exact(3).map(DVec3::from_slice).collect();
    let lattice = Lattice::new(width, height, step, nodes).ok_or("has a broken lattice")?;
    Ok(Grid::from_lattice(lattice))
}
