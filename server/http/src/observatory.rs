//! The real program behind the interface.

use crate::{
    answers::AtmosphereAnswer,
    source::{BoxFuture, EyeHeight, RenderedSky, SiteFacts, SkyQuery, SkySource, SourceError, SourceFacts},
};
use skyglow_engine::{
    EngineError, EngineStats, Observatory,
    observatory::{ObserverHeight, SkyRequest},
};
use skyglow_physics::GeoPoint;
use skyglow_scene::{Place, RasterTile, SceneError, SceneId, SceneMetadata, TileLayer};
use skyglow_tables::Manifest;
use std::sync::Arc;

/// An observatory with what is fixed after the start.
#[derive(Debug)]
pub struct ObservatorySource {
    observatory: Arc<Observatory>,
    facts: SourceFacts,
}

impl ObservatorySource {
    /// Puts an observatory behind the interface.
    pub fn new(observatory: Arc<Observatory>) -> Self {
        let info = observatory.engine().info();
        let ends =
            |values: &[f64]| (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(0.0));
        let facts = SourceFacts {
            executor: info.executor.name().to_owned(),
            adapter: info.adapter.clone(),
            turbidity_range: ends(&info.turbidities),
            altitude_range_m: (info.altitude_range_m[0], info.altitude_range_m[1]),
            basis_count: info.basis_count,
            pack_checksums: observatory
                .engine()
                .tables()
                .iter()
                .map(|tables| tables.checksum.as_str())
                .collect::<Vec<_>>()
                .join(" "),
        };
        Self { observatory, facts }
    }
}

impl From<EngineError> for SourceError {
    fn from(error: EngineError) -> Self {
        match error {
            EngineError::Busy { .. } => SourceError::Busy,
            EngineError::Stopped | EngineError::Device(_) => SourceError::Down(error.to_string()),
            EngineError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m } => {
                SourceError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m }
            }
            EngineError::TurbidityOutOfRange { turbidity, minimum, maximum } => SourceError::OutOfRange {
                parameter: "turbidity",
                value: turbidity.to_string(),
                allowed: format!("{minimum} to {maximum}"),
            },
            EngineError::BasisOutOfRange { basis, maximum } => SourceError::OutOfRange {
                parameter: "basis",
                value: basis.to_string(),
                allowed: format!("a whole number from 1 to {maximum}"),
            },
            EngineError::OutsideScene { bounds, .. } => SourceError::OutsideScene { bounds },
            EngineError::Scene(error) => error.into(),
            // The rest is about starting an engine, or a defect.
            other => SourceError::Broken(other.to_string()),
        }
    }
}

impl From<SceneError> for SourceError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::UnknownScene { id } | SceneError::InvalidId { id } => SourceError::UnknownScene(id),
            SceneError::InvalidTile { .. } => SourceError::UnknownTile(error.to_string()),
            other => SourceError::Broken(other.to_string()),
        }
    }
}

/// A pack as the interface describes it.
fn atmosphere(manifest: &Manifest) -> AtmosphereAnswer {
    let ends = |axis: &[f64]| [axis.first().copied().unwrap_or(0.0), axis.last().copied().unwrap_or(0.0)];
    let scattering = serde_json::to_value(manifest.scattering).ok();
    AtmosphereAnswer {
        turbidity: manifest.turbidity,
        scattering: scattering.as_ref().and_then(|value| value.as_str()).unwrap_or("single").to_owned(),
        bands_nm: manifest.bands_nm.clone(),
        observer_altitude_m: ends(&manifest.axes.observer_altitude_m),
        source_altitude_m: [0.0, skyglow_tables::axes::HIGHEST_ALTITUDE_M],
        distance_m: ends(&manifest.axes.distance_m),
        basis_count: manifest.basis_count,
        checksum: manifest.checksum.clone(),
        measured_error: serde_json::to_value(&manifest.measured_error).ok(),
    }
}

impl SkySource for ObservatorySource {
    fn facts(&self) -> &SourceFacts {
        &self.facts
    }

    fn is_ready(&self) -> bool {
        self.observatory.engine().is_ready()
    }

    fn stats(&self) -> EngineStats {
        self.observatory.engine().stats()
    }

    fn open_scenes(&self) -> usize {
        self.observatory.open_scene_count()
    }

    fn atmospheres(&self) -> Vec<AtmosphereAnswer> {
        self.observatory.atmospheres().iter().map(atmosphere).collect()
    }

    fn scenes(&self) -> Result<Vec<SceneMetadata>, SourceError> {
        Ok(self.observatory.scenes()?)
    }

    fn scene(&self, id: &SceneId) -> Result<SceneMetadata, SourceError> {
        Ok(self.observatory.scene(id)?.metadata().clone())
    }

    fn places(&self, id: &SceneId) -> Result<Vec<Place>, SourceError> {
        Ok(self.observatory.scene(id)?.places().to_vec())
    }

    fn site(&self, id: &SceneId, place: GeoPoint) -> Result<SiteFacts, SourceError> {
        let site = self.observatory.site(id, place)?;
        Ok(SiteFacts { scene: site.scene, ground: site.ground, radiance_nw_cm2_sr: site.radiance_nw_cm2_sr })
    }

    fn tile(
        &self,
        id: &SceneId,
        layer: TileLayer,
        address: (u8, u32, u32),
        size_px: u32,
    ) -> Result<RasterTile, SourceError> {
        Ok(self.observatory.tile(id, layer, address, size_px)?)
    }

    fn sky(&self, query: Arc<SkyQuery>) -> BoxFuture<'_, Result<RenderedSky, SourceError>> {
        Box::pin(async move {
            let request = SkyRequest {
                scene: query.scene.clone(),
                place: query.place,
                observer_height: match query.eye_height {
                    EyeHeight::AboveGround(height_m) => ObserverHeight::AboveGround(height_m),
                    EyeHeight::AboveSea(altitude_m) => ObserverHeight::AboveSea(altitude_m),
                },
                turbidity: query.turbidity,
                lamp: query.lamp,
                emission: query.emission,
                basis: query.basis,
                terrain_hides: query.terrain_hides,
            };
            let answer = self.observatory.sky(request).await?;
            let horizon_time = answer.horizon_time.map(|time| ("horizon", 1e6 * time.as_secs_f64()));
            let passes = answer.rendered.passes.iter().map(|pass| (pass.name, pass.microseconds));
            Ok(RenderedSky {
                altitude_m: answer.observer.altitude_m,
                ground: answer.observer.ground,
                quantities: answer.quantities,
                coverage: answer.coverage,
                calibration: answer.calibration,
                local_optical_depth: answer.local_optical_depth,
                flux_dnb_w: answer.flux_dnb_w,
                basis_count: answer.rendered.basis_count,
                passes: horizon_time.into_iter().chain(passes).collect(),
                horizon: answer.horizon,
                panorama: answer.rendered.panorama,
            })
        })
    }
}
