//! A sky of the command line, rendered as the API does.

use crate::{failure::Failure, query};
use skyglow_app::{SkySource, answers::Assumptions};
use skyglow_observatory::{RenderedSky, SceneView, SkyRequest};
use std::sync::Arc;

/// A sky with what it is of.
pub(crate) struct Rendered {
    /// What was asked.
    pub(crate) request: Arc<SkyRequest>,
    /// The scene.
    pub(crate) view: SceneView,
    /// What it depends on.
    pub(crate) assumptions: Assumptions,
    /// The sky.
    pub(crate) sky: RenderedSky,
}

/// Renders a sky.
pub(crate) fn rendered(
    source: &dyn SkySource,
    request: SkyRequest,
) -> Result<(Assumptions, RenderedSky), Failure> {
    rendered_of_scene(source, request).map(|Rendered { assumptions, sky, .. }| (assumptions, sky))
}

/// Renders a sky, which its request and scene come with.
pub(crate) fn rendered_of_scene(source: &dyn SkySource, request: SkyRequest) -> Result<Rendered, Failure> {
    let failure = |error| query::failure(&error);
    let view = source.view(&request.scene, request.scenario.as_ref()).map_err(failure)?;
    source.site(&view, request.place).map_err(failure)?;
    let request = Arc::new(request);
    let runtime = tokio::runtime::Builder::new_current_thread().build().map_err(Failure::work)?;
    let rendered = runtime.block_on(source.sky(Arc::clone(&request), view.clone())).map_err(failure)?;
    let assumptions = Assumptions::new(&request, view.metadata(), &rendered.context, source.facts());
    Ok(Rendered { request, view, assumptions, sky: rendered })
}
