//! A sky of the command line, rendered as the API does.

use crate::{failure::Failure, query};
use skyglow_app::{SkySource, answers::Assumptions};
use skyglow_observatory::{RenderedSky, SkyRequest};
use std::sync::Arc;

/// Renders a sky.
pub(crate) fn rendered(
    source: &dyn SkySource,
    request: SkyRequest,
) -> Result<(Assumptions, RenderedSky), Failure> {
    let failure = |error| query::failure(&error);
    let view = source.view(&request.scene, request.scenario.as_ref()).map_err(failure)?;
    source.site(&view, request.place).map_err(failure)?;
    let request = Arc::new(request);
    let runtime = tokio::runtime::Builder::new_current_thread().build().map_err(Failure::work)?;
    let rendered = runtime.block_on(source.sky(Arc::clone(&request), view.clone())).map_err(failure)?;
    Ok((Assumptions::new(&request, view.metadata(), &rendered.context, source.facts()), rendered))
}
