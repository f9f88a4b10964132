//! What lists of scenarios and of plans have in common, and their removal.

use super::frame::{Answer, JsonRequest};
use crate::{error::ApiError, poster::Poster, respond::CachePolicy, state::AppState, trust::PublicAddress};
use axum::http::{HeaderValue, StatusCode, header};
use serde::Serialize;
use skyglow_app::{
    error::AppError,
    request::{ListRequest, change_id, list_request, no_parameters},
    source::SkySource,
};
use skyglow_scene::{Page, SceneId, Viewer};

/// Part of a list, with the address of the next.
///
/// * `name`: the last part of the list's path.
pub(super) async fn list<T: Serialize + Send + 'static>(
    request: JsonRequest,
    poster: &Poster,
    address: &PublicAddress,
    name: &str,
    read: impl FnOnce(&dyn SkySource, &SceneId, &Viewer, &ListRequest) -> Result<Page<T>, AppError>
    + Send
    + 'static,
) -> Answer {
    let scene = request.scene()?;
    let part = list_request(request.query.as_deref())?;
    let viewer = poster.viewer();
    let policy = match viewer {
        Viewer::Anyone => CachePolicy::Revalidate,
        _ => CachePolicy::Private,
    };
    let path = format!("{}/api/v1/scenes/{scene}/{name}?limit={}", address.base(), part.limit);
    let page = request.state.blocking(move |source| Ok(read(source, &scene, &viewer, &part)?)).await?;
    let mut response = crate::respond::json_by_content(&request.headers, policy, &page.entries)?;
    if let Some(next) = page.next {
        let link = HeaderValue::from_str(&format!("<{path}&after={next}>; rel=\"next\""));
        response.headers_mut().insert(header::LINK, link.map_err(ApiError::internal)?);
    }
    Ok(response)
}

/// Removes a scenario or plan.
pub(super) async fn remove(
    state: &AppState,
    poster: &Poster,
    text: &str,
    query: Option<&str>,
    is_plan: bool,
) -> Result<StatusCode, ApiError> {
    no_parameters(query)?;
    let owner = poster.remover()?;
    let id = change_id(text)?;
    if id.is_plan() != is_plan {
        return Err(ApiError::App(AppError::UnknownScenario { id: id.to_string() }));
    }
    state.blocking(move |source| Ok(source.remove_change(&id, owner.as_ref())?)).await?;
    Ok(StatusCode::NO_CONTENT)
}
