//! Who waits for long work, and may stop waiting.

use crate::error::ObservatoryError;
use skyglow_render::RenderError;

/// Is told how far work is, 0 to 1, and answers whether to go on.
pub type Watch<'a> = dyn Fn(f64) -> bool + Sync + 'a;

/// Ends work that nobody waits for any more.
///
/// # Errors
/// [`RenderError::Ended`].
pub(crate) fn note(watch: &Watch<'_>, done: f64) -> Result<(), ObservatoryError> {
    if watch(done) { Ok(()) } else { Err(RenderError::Ended.into()) }
}
