//! The resident table packs.

use super::frame::{Answer, JsonRequest};
use crate::{refusals::BadParameters, respond::CachePolicy};
use skyglow_app::answers::AtmosphereAnswer;

/// Lists the resident table packs: those of first-order scattering, then those of all orders, each ascending in
/// turbidity.
#[utoipa::path(
    get,
    path = "/api/v1/atmospheres",
    tag = "atmospheres",
    responses(
        (status = 200, description = "The packs", body = Vec<AtmosphereAnswer>),
        (status = 304, description = "The client has this answer already"),
        BadParameters,
    )
)]
pub async fn list_atmospheres(request: JsonRequest) -> Answer {
    request.without_parameters()?;
    request.answer(CachePolicy::Revalidate, |source| Ok(source.atmospheres())).await
}
