//! The sky between those of packs.

use skyglow_physics::{Panorama, interpolation::Stencil};
use skyglow_render::cpu::blend::blend;

/// The sky between those of packs.
pub(super) fn blended(mut skies: Vec<Vec<f32>>, stencil: &Stencil, side_by_side: bool) -> Option<Panorama> {
    let samples = match skies.len() {
        1 => skies.swap_remove(0),
        _ => blend(&skies.iter().map(Vec::as_slice).collect::<Vec<_>>(), stencil, side_by_side),
    };
    Panorama::from_samples(samples)
}
