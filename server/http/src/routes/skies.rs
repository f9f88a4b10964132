//! Many skies at once, as lines that are sent as they are made.

use crate::{
    asker::{self, Asker, Work},
    error::ApiError,
    refusals::{BodyTooLong, OfSky},
    respond::Counted,
    state::AppState,
    work_places::Lane,
};
use axum::{
    body::{Body, Bytes, HttpBody},
    extract::{Path, RawQuery, State},
    http::{HeaderValue, Response, header},
};
use hyper::body::Frame;
use skyglow_app::{
    parameters::SkiesParameters,
    parquet_table,
    request::{SkiesBody, SkiesRequest, SkyOfMany, scene_id, skies},
    sky_lines::{SkyTable, each_sky_line},
    source::SkySource,
};
use skyglow_observatory::SceneView;
use skyglow_scene::SceneId;
use std::{
    convert::Infallible,
    pin::Pin,
    sync::Arc,
    task::{Context, Poll},
    time::Duration,
};
use tokio::{
    runtime::Handle,
    sync::{mpsc, oneshot},
    time::timeout,
};
use tracing::Instrument;

/// Lines that wait for their client.
const LINES_WAITING: usize = 64;
/// How long a line waits for its client: who reads slower keeps others waiting.
const PATIENCE: Duration = Duration::from_secs(10);
/// Bytes that the skies under way and their lines take, about.
const BYTES: usize = 32 << 20;
/// The same of a table, whose rows all wait for its end.
const TABLE_BYTES: usize = 96 << 20;

/// The numbers of the skies of up to 1000 places, a line of JSON for each, in the order of the body, sent as they are made.
///
/// A place takes every parameter of `GET sky` but `scenario`; what the query says holds for the places that do not say it themselves. A
/// place that cannot be answered has its error in its line, and the others their skies.
#[utoipa::path(
    post,
    path = "/api/v1/scenes/{scene}/skies",
    tag = "sky",
    params(("scene" = String, Path, description = "The scene's id"), SkiesParameters),
    request_body = SkiesBody,
    responses(
        (status = 200, description = "A line for each place and time, which is a SkyLine", body = String, content_type = "application/x-ndjson"),
        OfSky,
        BodyTooLong,
    )
)]
pub async fn post_skies(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    body: Bytes,
) -> Result<Response<Body>, ApiError> {
    let Asked { id, request, view } = Asked::read(&state, &scene, query, body).await?;
    let (lines, receiver) = mpsc::channel(LINES_WAITING);
    let (begin, has_begun) = oneshot::channel();
    let (source, work) = (Arc::clone(&state.source), Arc::clone(&state.work));
    let render = async move {
        let make = move |_: &dyn SkySource, watched: &Work| {
            // Whoever waits for the answer has it now, and reads its lines.
            let _ = begin.send(());
            Handle::current().block_on(send_lines(&source, &view, &id, request.skies, &lines, watched));
            Ok(())
        };
        work.long(Lane::Plan, BYTES, make).await.map(drop)
    };
    // Lines are made on when the handler has answered, and no longer than somebody takes them.
    let asker = Asker::new(asker::party(), Arc::default());
    let task = tokio::spawn(asker.scope(render.in_current_span()));
    if has_begun.await.is_err() {
        // It was refused before it began.
        let refused = task.await.map_err(|error| ApiError::internal(format!("a worker failed: {error}")))?;
        return Err(refused.err().unwrap_or_else(|| ApiError::internal("lines ended before they began")));
    }
    let mut response = Response::new(Body::new(Lines(receiver)));
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/x-ndjson"));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    Ok(response)
}

/// The numbers of the skies of up to 1000 places, as a table in Parquet: a row for each place and time, in the order of the body.
///
/// As the lines of `POST skies`; numbers inside objects have columns such as `observer.latitude_deg`, lists are JSON, and rows without a sky
/// have their error.
#[utoipa::path(
    post,
    path = "/api/v1/scenes/{scene}/skies.parquet",
    tag = "sky",
    params(("scene" = String, Path, description = "The scene's id"), SkiesParameters),
    request_body = SkiesBody,
    responses(
        (status = 200, description = "The table", body = String, content_type = "application/vnd.apache.parquet"),
        OfSky,
        BodyTooLong,
    )
)]
pub async fn post_skies_parquet(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    body: Bytes,
) -> Result<Response<Body>, ApiError> {
    let Asked { id, request, view } = Asked::read(&state, &scene, query, body).await?;
    let source = Arc::clone(&state.source);
    let make = move |_: &dyn SkySource, watched: &Work| {
        let mut table = SkyTable::default();
        let take = async |done, line: Vec<u8>| table.add(&line) && watched.note(done);
        Handle::current().block_on(each_sky_line(&source, &view, &id, request.skies, take))?;
        table.encode().map_err(ApiError::internal)
    };
    let (made, held) = state.work.long(Lane::Plan, TABLE_BYTES, make).await?;
    let mut response = Response::new(Body::from(state.work.keep(made, held)));
    response.extensions_mut().insert(Counted);
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(parquet_table::MEDIA_TYPE));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    Ok(response)
}

/// What a request asks for, and of which scene.
struct Asked {
    id: SceneId,
    request: SkiesRequest,
    view: SceneView,
}

impl Asked {
    async fn read(
        state: &AppState,
        scene: &str,
        query: Option<String>,
        body: Bytes,
    ) -> Result<Self, ApiError> {
        let id = scene_id(scene)?;
        let of_query = id.clone();
        let read =
            move |source: &dyn SkySource| Ok(skies(query.as_deref(), &body, of_query, source.facts())?);
        let request = state.blocking(read).await?;
        let view = state.view(&id, request.scenario.as_ref()).await?;
        Ok(Self { id, request, view })
    }
}

/// Renders skies and sends their lines in order, until nobody takes them.
async fn send_lines(
    source: &Arc<dyn SkySource>,
    view: &SceneView,
    scene: &SceneId,
    skies: Vec<SkyOfMany>,
    lines: &mpsc::Sender<Bytes>,
    work: &Work,
) {
    let send = async |done, line: Vec<u8>| {
        work.note(done) && timeout(PATIENCE, lines.send(line.into())).await.is_ok() && !lines.is_closed()
    };
    if let Err(error) = each_sky_line(source, view, scene, skies, send).await {
        tracing::error!(?error, "a line of many skies");
    }
}

/// A body of lines.
struct Lines(mpsc::Receiver<Bytes>);

impl HttpBody for Lines {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        self.0.poll_recv(context).map(|line| line.map(|line| Ok(Frame::data(line))))
    }
}
