//! Many skies, each as a line of JSON or all as a table: what the HTTP interface answers and the command line writes.

use crate::{
    answers::{Assumptions, SkyAnswer, SkyLine},
    conversion::check_altitude,
    error::AppError,
    parquet_table::{ParquetTable, ParquetTableError},
    problem::LineError,
    request::SkyOfMany,
    source::SkySource,
};
use skyglow_observatory::SceneView;
use skyglow_scene::SceneId;
use std::{collections::VecDeque, sync::Arc, time::Duration};

/// Skies that are rendered at a time.
const AT_A_TIME: usize = 8;

/// How often a full queue is tried again, and after how long.
const TRIES: u32 = 50;
const PAUSE: Duration = Duration::from_millis(20);

/// The lines of many skies as a table.
#[derive(Debug, Default)]
pub struct SkyTable {
    table: ParquetTable,
    failed: Option<ParquetTableError>,
}

impl SkyTable {
    /// Adds a line; answers whether it could.
    pub fn add(&mut self, line: &[u8]) -> bool {
        self.failed = self.table.add(line).err();
        self.failed.is_none()
    }

    /// The table in Parquet.
    ///
    /// # Errors
    /// [`ParquetTableError`], only by a defect.
    pub fn encode(self) -> Result<Vec<u8>, ParquetTableError> {
        let first = ["place", "name", "observer.latitude_deg", "observer.longitude_deg", "time"];
        self.failed.map_or(Ok(()), Err)?;
        self.table.encode(&first, &[])
    }
}

/// Renders many skies of a scene, some at a time, and hands each over as a line of JSON with its end, in their order, until one is not
/// taken. For a thread in an asynchronous runtime.
///
/// * `take`: given the part of all lines that came before, 0 to 1, and the line; answers whether to go on.
///
/// # Errors
/// [`AppError::Internal`], only by a defect.
pub async fn each_sky_line(
    source: &Arc<dyn SkySource>,
    view: &SceneView,
    scene: &SceneId,
    skies: Vec<SkyOfMany>,
    mut take: impl AsyncFnMut(f64, Vec<u8>) -> bool,
) -> Result<(), AppError> {
    let count = skies.len();
    let mut waiting = skies.into_iter();
    let mut under_way = VecDeque::with_capacity(AT_A_TIME);
    for taken in 0..count {
        while under_way.len() < AT_A_TIME
            && let Some(asked) = waiting.next()
        {
            let (source, view, scene) = (Arc::clone(source), view.clone(), scene.clone());
            let render = async move { sky_line(source.as_ref(), &view, scene, asked).await };
            under_way.push_back(tokio::spawn(render));
        }
        let Some(next) = under_way.pop_front() else { break };
        let line = next
            .await
            .map_err(|error| AppError::internal(format!("a worker of skies failed: {error}")))??;
        if !take(taken as f64 / count as f64, line).await {
            break;
        }
    }
    Ok(())
}

/// Renders a sky, or says why not; as a line of JSON with its end.
async fn sky_line(
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
            SkyLine { place, name, sky: None, error: Some(LineError::from(&error)) }
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
