//! Links as the client can follow them.

use crate::{state::AppState, trust::PublicAddress};
use axum::{
    extract::{Request, State},
    http::{HeaderValue, header},
    middleware::Next,
    response::Response,
};

/// Finds out where the client reached the server, for handlers, and puts the prefix of paths before what `Location` says.
pub async fn find_public_address(
    State(state): State<AppState>,
    mut request: Request,
    next: Next,
) -> Response {
    let address = PublicAddress::of(request.headers(), request.extensions(), &state.config);
    request.extensions_mut().insert(address.clone());
    let mut response = next.run(request).await;
    let location = response.headers().get(header::LOCATION).and_then(|value| value.to_str().ok());
    if let Some(path) = location.filter(|location| location.starts_with('/'))
        && let Ok(location) = HeaderValue::from_str(&address.path(path))
    {
        response.headers_mut().insert(header::LOCATION, location);
    }
    response
}
