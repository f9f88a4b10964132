//! The pixels of a plan as the bytes of a file.

use super::edits::PixelFactors;
use super::stored::StoredPlan;
use crate::sections::{self, Sections, pack_ascending, unpack_ascending};
use std::borrow::Cow;

/// A plan's pixels as a file.
pub(super) fn pack(plan: &StoredPlan) -> std::io::Result<Vec<u8>> {
    let parts: Vec<(String, Cow<'_, [u8]>)> = vec![
        ("codes".into(), Cow::Owned(pack_ascending(&plan.factors.codes))),
        ("factors".into(), Cow::Borrowed(bytemuck::cast_slice(&plan.factors.factors))),
        ("effects".into(), Cow::Borrowed(bytemuck::cast_slice(&plan.effects))),
    ];
    sections::pack(&parts)
}

/// What is left of each pixel, and its effect.
///
/// # Errors
/// What is wrong with the bytes.
pub(super) fn unpack(bytes: &[u8]) -> Result<(PixelFactors, Vec<f32>), String> {
    let sections = Sections::parse(bytes)?;
    let codes = unpack_ascending(&sections.bytes("codes")?)?;
    let factors: Vec<f32> = sections.numbers("factors")?;
    let effects: Vec<f32> = sections.numbers("effects")?;
    let is_whole = codes.len() == factors.len()
        && codes.len() == effects.len()
        && codes.windows(2).all(|pair| pair[0] < pair[1])
        && factors.iter().all(|factor| (0.0..=1.0).contains(factor));
    if is_whole {
        Ok((PixelFactors { codes, factors }, effects))
    } else {
        Err("contradicts itself".to_owned())
    }
}
