//! Many skies, each as a line of JSON: what the HTTP interface answers and the command line writes.

use crate::{
    answers::{Assumptions, LineError, SkyAnswer, SkyLine},
    conversion::check_altitude,
    error::AppError,
    request::SkyOfMany,
    source::SkySource,
};
use skyglow_observatory::SceneView;
use skyglow_scene::SceneId;
use std::{sync::Arc, time::Duration};

/// How often a full queue is tried again, and after how long.
const TRIES: u32 = 50;
const PAUSE: Duration = Duration::from_millis(20);

/// Renders a sky, or says why not; as a line of JSON with its end.
///
/// # Errors
/// [`AppError::Internal`] for what is no JSON.
pub async fn sky_line(
    source: &dyn SkySource,
    view: &SceneView,
    scene: SceneId,
    asked: SkyOfMany,
) -> Result<Vec<u8>, AppError> {
    let (place, name) = (asked.place, asked.name.clone());
    let line = match sky_of(source, view, scene, &asked).await {
        Ok(sky) => SkyLine { place, name, sky: Some(sky), error: None },
        Err(error) => {
            if let AppError::Internal { reason } = &error {
                tracing::error!(reason, "one of many skies failed");
            }
            let (detail, errors) = (error.detail(), error.field_errors().to_vec());
            SkyLine { place, name, sky: None, error: Some(LineError { detail, errors }) }
        }
    };
    let mut bytes = serde_json::to_vec(&line).map_err(AppError::internal)?;
    bytes.push(b'\n');
    Ok(bytes)
}

async fn sky_of(
    source: &dyn SkySource,
    view: &SceneView,
    scene: SceneId,
    asked: &SkyOfMany,
) -> Result<SkyAnswer, AppError> {
    let facts = source.facts();
    let request = Arc::new(asked.read(scene, facts)?);
    let site = source.site(view, request.place)?;
    check_altitude(&request, site.ground, facts.altitude_range_m)?;
    let mut tries = 0;
    let sky = loop {
        match source.sky(Arc::clone(&request), view.clone()).await {
            // Others fill the queue: it empties within milliseconds.
            Err(AppError::Busy { .. }) if tries < TRIES => {
                tries += 1;
                tokio::time::sleep(PAUSE).await;
            }
            other => break other?,
        }
    };
    Ok(SkyAnswer::new(Assumptions::new(&request, view.metadata(), &sky.context, facts), &sky))
}
