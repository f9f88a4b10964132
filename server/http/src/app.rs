//! The router: routes, their document, and the middleware around them.

use crate::{
    access::Access,
    config::HttpConfig,
    document::{self, Document},
    error::ApiError,
    middleware::{
        StorageQuota, answer_ranges, catch_panic, find_public_address, limit_rate, limit_sending,
        limit_storage, limit_time, observe, problems_only, read_body, refuse_stray_bodies, require_host,
        respond_async, share_across_origins, tag_encodings,
    },
    routes::{
        atmospheres, basemap, darker, docs, edr, health, horizon, influence, jobs, layers, link, night, ogc,
        panorama, plans, problems, processes, scenarios, scenes, shares, site, skies, sky, stac, styles,
        tilejson, tiles, uploads, viewer,
    },
    shared_counts::{Counted, add_up},
    state::AppState,
    token_buckets::TokenBuckets,
    valkey::Valkey,
};
use axum::{
    Router,
    extract::DefaultBodyLimit,
    http::{HeaderValue, header},
    middleware::{from_fn, from_fn_with_state},
    response::Response,
    routing::get,
};
use skyglow_app::source::SkySource;
use std::sync::Arc;
use tower_http::{
    CompressionLevel,
    compression::{
        CompressionLayer, Predicate,
        predicate::{NotForContentType, SizeAbove},
    },
    limit::RequestBodyLimitLayer,
};
use utoipa::OpenApi;
use utoipa_axum::{router::OpenApiRouter, routes};

/// Routes below `/api`: what is limited, timed and open to other origins.
fn api() -> OpenApiRouter<AppState> {
    OpenApiRouter::with_openapi(Document::openapi())
        .routes(routes!(scenes::list_scenes))
        .routes(routes!(scenes::get_scene))
        .routes(routes!(scenes::list_places))
        .routes(routes!(scenes::list_world_places))
        .routes(routes!(site::get_site))
        .routes(routes!(panorama::get_panorama))
        .routes(routes!(panorama::get_panorama_png))
        .routes(routes!(panorama::get_panorama_webp))
        .routes(routes!(panorama::get_panorama_exr))
        .routes(routes!(panorama::get_panorama_tif))
        .routes(routes!(panorama::get_panorama_json))
        .routes(routes!(panorama::get_panorama_sky))
        .routes(routes!(sky::get_sky))
        .routes(routes!(skies::post_skies))
        .routes(routes!(skies::post_skies_parquet))
        .routes(routes!(night::get_night))
        .routes(routes!(night::list_nights))
        .routes(routes!(darker::get_darker))
        .routes(routes!(horizon::get_horizon_txt))
        .routes(routes!(horizon::get_landscape_zip))
        .routes(routes!(night::get_scene_night))
        .routes(routes!(influence::get_influence, influence::post_influence))
        .routes(routes!(influence::get_influence_json, influence::post_influence_json))
        .routes(routes!(influence::get_influence_tif, influence::post_influence_tif))
        .routes(routes!(influence::get_influence_geojson, influence::post_influence_geojson))
        .routes(routes!(influence::get_influence_csv, influence::post_influence_csv))
        .routes(routes!(shares::get_shares, shares::post_shares))
        .routes(routes!(shares::get_shares_csv, shares::post_shares_csv))
        .routes(routes!(shares::get_shares_parquet, shares::post_shares_parquet))
        .routes(routes!(shares::get_shares_geojson, shares::post_shares_geojson))
        .routes(routes!(plans::list_plans, plans::post_plan))
        .routes(routes!(plans::get_plan, plans::delete_plan))
        .routes(routes!(jobs::get_job, jobs::delete_job))
        .routes(routes!(jobs::get_job_result))
        .routes(routes!(scenarios::list_scenarios, scenarios::post_scenario))
        .routes(routes!(scenarios::get_scenario, scenarios::delete_scenario))
        .routes(routes!(tilejson::get_tilejson))
        .routes(routes!(basemap::get_basemap))
        .routes(routes!(basemap::get_basemap_tile))
        .routes(routes!(layers::get_radiance_tif))
        .routes(routes!(layers::get_elevation_tif))
        .routes(routes!(layers::get_brightness_tif))
        .routes(routes!(styles::get_brightness_qml))
        .routes(routes!(styles::get_influence_qml))
        .routes(routes!(atmospheres::list_atmospheres))
        .routes(routes!(docs::get_openapi))
        .routes(routes!(docs::get_docs))
        .routes(routes!(problems::get_problem))
        .merge(standards())
}

/// The same under the names of standards: OGC APIs and STAC.
fn standards() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(ogc::get_landing))
        .routes(routes!(ogc::get_conformance))
        .routes(routes!(ogc::get_collections))
        .routes(routes!(ogc::get_collection))
        .routes(routes!(edr::get_position))
        .routes(routes!(edr::get_area))
        .routes(routes!(edr::get_trajectory))
        .routes(routes!(edr::get_map))
        .routes(routes!(ogc::get_tilesets))
        .routes(routes!(ogc::get_tileset))
        .routes(routes!(tiles::get_tileset_tile))
        .routes(routes!(ogc::get_tile_matrix_sets))
        .routes(routes!(ogc::get_tile_matrix_set))
        .routes(routes!(processes::get_processes))
        .routes(routes!(processes::get_process))
        .routes(routes!(processes::post_execution))
        .routes(routes!(processes::get_job_status, processes::dismiss_job))
        .routes(routes!(processes::get_job_results))
        .routes(routes!(stac::get_stac_catalog))
        .routes(routes!(stac::get_stac_collection))
        .routes(routes!(stac::get_stac_item))
}

/// Routes that answer however busy the server is.
fn operation() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(health::get_health))
        .routes(routes!(health::get_readiness))
        .routes(routes!(health::get_metrics))
}

/// The OpenAPI document of all routes.
pub fn openapi() -> utoipa::openapi::OpenApi {
    let (_, mut document) = api().merge(uploads()).merge(operation()).split_for_parts();
    document.merge(tiles::TileDocument::openapi());
    document::complete(&mut document);
    document
}

/// Routes that change scenes: uploads take longer and are larger than anything else.
fn uploads() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(uploads::put_scene, uploads::delete_scene))
}

/// [`router_with_access`] for anyone, who may read.
pub fn router(source: Arc<dyn SkySource>, config: HttpConfig) -> Router {
    router_with_access(source, config, Access::default())
}

/// The whole interface over a source, such as [`ObservatorySource`](skyglow_app::ObservatorySource).
pub fn router_with_access(source: Arc<dyn SkySource>, config: HttpConfig, access: Access) -> Router {
    router_beside(source, config, access, None)
}

/// The same beside other servers, with which shares of clients are counted together.
pub fn router_beside(
    source: Arc<dyn SkySource>,
    config: HttpConfig,
    access: Access,
    valkey: Option<Arc<Valkey>>,
) -> Router {
    let state = AppState::new(source, config, access);
    let config = state.config.clone();
    if let Ok(text) = openapi().to_json() {
        // The cell is new, so this sets it.
        let _ = state.openapi.set(text);
    }
    let limiter =
        Arc::new(TokenBuckets::new("requests", config.requests_per_second, f64::from(config.request_burst)));
    let quota = Arc::new(StorageQuota::new(config.kept_per_day));
    if let Some(valkey) = valkey {
        valkey.show_in(state.metrics.valkey_away.clone());
        let counted: [Arc<dyn Counted>; 4] =
            [limiter.clone(), state.work.shares.clone(), quota.shares().clone(), state.access.clone()];
        add_up(valkey, counted.iter().map(Arc::downgrade).collect());
    }
    let (api, _) = api().split_for_parts();
    let api = api
        .route("/api/v1/scenes/{scene}/tiles/{layer}/{z}/{x}/{file}", get(tiles::get_tile))
        // A root is asked for with a slash too.
        .route("/api/ogc/", get(ogc::get_landing))
        .route("/api/stac/", get(stac::get_stac_catalog))
        .route("/api/docs/page.js", get(docs::get_docs_script))
        .route("/api/docs/page.css", get(docs::get_docs_style))
        .layer(from_fn_with_state(state.clone(), limit_time))
        .layer(from_fn_with_state((state.clone(), quota), limit_storage))
        .layer(from_fn_with_state(state.clone(), respond_async))
        .layer(from_fn_with_state(state.clone(), read_body))
        .layer(from_fn_with_state((state.clone(), limiter.clone()), limit_rate))
        .layer(RequestBodyLimitLayer::new(config.body_limit_bytes));
    let (uploads, _) = uploads().split_for_parts();
    let uploads = uploads
        .layer(DefaultBodyLimit::disable())
        .layer(from_fn_with_state((state.clone(), limiter), limit_rate))
        .layer(RequestBodyLimitLayer::new(config.upload_limit_bytes));
    let (operation, _) = operation().split_for_parts();
    let all = Router::new()
        .merge(api)
        .merge(uploads)
        .merge(operation)
        .route("/", get(viewer::get_viewer))
        .route("/index.html", get(viewer::get_viewer))
        .route("/embed", get(viewer::get_embed))
        .route("/at", get(link::get_link))
        .route("/manifest.webmanifest", get(viewer::get_viewer))
        .route("/offline.js", get(viewer::get_viewer))
        .route("/icon.png", get(viewer::get_viewer))
        .route("/assets/{*file}", get(viewer::get_viewer))
        .fallback(not_found);
    all.layer(from_fn(answer_ranges))
        .layer(from_fn_with_state(state.clone(), limit_sending))
        .layer(CompressionLayer::new().quality(CompressionLevel::Fastest).compress_when(worth_compressing()))
        .layer(from_fn(tag_encodings))
        .layer(from_fn_with_state(state.clone(), refuse_stray_bodies))
        .layer(from_fn(require_host))
        .layer(from_fn_with_state(state.clone(), problems_only))
        .layer(from_fn_with_state(state.clone(), catch_panic))
        .layer(from_fn(secure))
        .layer(from_fn_with_state(state.clone(), share_across_origins))
        .layer(from_fn_with_state(state.clone(), find_public_address))
        .layer(from_fn_with_state(state.clone(), observe))
        .with_state(state)
}

async fn not_found() -> ApiError {
    ApiError::NotFound
}

/// Text is compressed, pictures are already.
fn worth_compressing() -> impl Predicate {
    SizeAbove::new(512)
        .and(NotForContentType::const_new("image/png"))
        .and(NotForContentType::const_new("image/webp"))
        .and(NotForContentType::const_new("image/x-exr"))
        .and(NotForContentType::const_new("image/tiff"))
}

/// Headers that every answer carries.
async fn secure(request: axum::extract::Request, next: axum::middleware::Next) -> Response {
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("same-origin"));
    response
}
