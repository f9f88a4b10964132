//! A program behind the interface that does as it is told.

use skyglow_app::{
    SkySource,
    answers::{AtmosphereAnswer, PlanEntry, ScenarioEntry},
    kind_facts::KindFacts,
    source::{
        BoxFuture, InfluenceQuery, RenderContext, RenderedSky, SiteFacts, SkyQuery, SourceError, SourceFacts,
    },
};
use skyglow_observatory::{BrightnessMap, BrightnessRequest, InfluenceMap, PlanOutcome, PlanRequest};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, ELEVATION_COUNT, GeoPoint, Horizon, Panorama, SkyQuantities,
};
use skyglow_render::EngineStats;
use skyglow_scene::{
    ChangeId, ChangeSummary, GridMetadata, Ground, IngestOptions, IngestReport, NamedPlace, PatchStore,
    RasterTile, Scenario, Scene, SceneId, SceneMetadata, StoredPlan, TileLayer, UploadFolder,
};
use skyglow_tables::{Clouds, Scattering};
use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    time::Duration,
};

/// What the next skies do.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) enum Mood {
    /// Render at once.
    #[default]
    Well,
    /// Render after a while.
    Slow(Duration),
    /// Fail.
    Fails(SourceError),
    /// Panic.
    Panics,
}

/// The program.
pub(crate) struct Fake {
    facts: SourceFacts,
    pub(crate) mood: Mutex<Mood>,
    pub(crate) rendered: AtomicUsize,
    pub(crate) ready: AtomicBool,
    pub(crate) version: Mutex<String>,
    pub(crate) ground: Mutex<Ground>,
    pub(crate) coverage: Mutex<f64>,
    pub(crate) horizon: Mutex<Horizon>,
    pub(crate) illustrative: AtomicBool,
    /// Scenarios, where it keeps any.
    pub(crate) kept: Mutex<Option<Vec<Scenario>>>,
}

impl Default for Fake {
    fn default() -> Self {
        Self {
            facts: SourceFacts {
                executor: "cpu".into(),
                adapter: "made up".into(),
                max_places: 1000,
                kinds: vec![KindFacts {
                    clouds: None,
                    scattering: Scattering::Single,
                    turbidity_range: (1.5, 6.0),
                    basis_count: 64,
                    ground_albedo: None,
                    why_open: None,
                }],
                any_cloud_albedo: None,
                altitude_range_m: (0.0, 6000.0),
                pack_checksums: "abc".into(),
            },
            mood: Mutex::default(),
            rendered: AtomicUsize::new(0),
            ready: AtomicBool::new(true),
            version: Mutex::new("v1".into()),
            ground: Mutex::new(Ground::Here { elevation_m: GROUND_M }),
            coverage: Mutex::new(0.95),
            horizon: Mutex::default(),
            illustrative: AtomicBool::new(true),
            kept: Mutex::default(),
        }
    }
}

/// Bounds of the made-up scene.
pub(crate) const BOUNDS: [f64; 4] = [36.0, -2.0, 38.0, 1.0];
/// Altitude of the ground everywhere in it unless a test says otherwise, metres.
pub(crate) const GROUND_M: f64 = 1700.0;

/// A sky that is bright in the low east, in proportion to turbidity.
pub(crate) fn sky_of(turbidity: f64) -> Panorama {
    let mut panorama = Panorama::dark();
    for band in 0..3 {
        for row in 0..ELEVATION_COUNT {
            for column in 0..AZIMUTH_COUNT {
                let from_east = (column as f64 - 64.0).abs().min(256.0 - (column as f64 - 64.0).abs());
                let glow = (-from_east / 30.0 - row as f64 / 15.0).exp();
                panorama.samples_mut()[Panorama::index(band, row, column)] =
                    (turbidity * 1e-6 * (0.05 + glow) * (1.0 + 0.1 * band as f64)) as f32;
            }
        }
    }
    panorama
}

impl Fake {
    /// With packs of all orders beside those of the first, for fewer turbidities.
    pub(crate) fn with_both_kinds() -> Self {
        let mut fake = Self::default();
        fake.facts.kinds.push(KindFacts {
            clouds: None,
            scattering: Scattering::Multiple,
            turbidity_range: (2.0, 5.0),
            basis_count: 32,
            ground_albedo: Some(0.15),
            why_open: Some("in this test"),
        });
        fake
    }

    fn ground(&self) -> Ground {
        *self.ground.lock().unwrap()
    }

    pub(crate) fn metadata(&self) -> SceneMetadata {
        SceneMetadata {
            id: SceneId::parse("demo").unwrap(),
            title: "Made up".into(),
            bounds: BOUNDS,
            grid: GridMetadata {
                width: 480,
                height: 720,
                geotransform: [36.0, 1.0 / 240.0, 0.0, 1.0, 0.0, -1.0 / 240.0],
                crs_wkt: "GEOGCS[\"WGS 84\"]".into(),
            },
            crs: "WGS 84".into(),
            calibration: 1.0,
            report: IngestReport::default(),
            pixel_size_m: 463.0,
            lit_pixels: 1234,
            date: Some("2023".into()),
            attribution: Some("nobody".into()),
            illustrative: self.illustrative.load(Ordering::SeqCst),
            terrain: true,
            light_skylines: true,
            places_count: 1,
            // A real scene's is a hash of all that is said of it.
            version: {
                let measured = if self.illustrative.load(Ordering::SeqCst) { "" } else { "-measured" };
                format!("{}{measured}", self.version.lock().unwrap())
            },
        }
    }

    fn known(&self, id: &SceneId) -> Result<SceneMetadata, SourceError> {
        if id.as_str() == "demo" {
            Ok(self.metadata())
        } else {
            Err(SourceError::UnknownScene(id.to_string()))
        }
    }

    fn render(&self, query: &SkyQuery) -> Result<RenderedSky, SourceError> {
        let altitude_m = query.eye_height.altitude_m(self.ground());
        if altitude_m > 6000.0 {
            return Err(SourceError::AltitudeOutOfRange { altitude_m, minimum_m: 0.0, maximum_m: 6000.0 });
        }
        self.rendered.fetch_add(1, Ordering::SeqCst);
        let mut panorama = sky_of(query.turbidity.value());
        if query.scattering == Scattering::Multiple {
            panorama.samples_mut().iter_mut().for_each(|sample| *sample *= 2.0);
        }
        let horizon =
            if query.terrain_hides { self.horizon.lock().unwrap().clone() } else { Horizon::flat() };
        horizon.darken(&mut panorama);
        Ok(RenderedSky {
            quantities: SkyQuantities::of_visible(&panorama, &horizon),
            panorama,
            horizon,
            context: RenderContext {
                altitude_m,
                ground: self.ground(),
                coverage: *self.coverage.lock().unwrap(),
                calibration: 1.0,
                local_optical_depth: Atmosphere::new(query.turbidity).vertical_optical_depth(altitude_m),
                flux_dnb_w: 1e6,
                basis_count: query.basis.unwrap_or(if query.tolerance.is_some() { 16 } else { 64 }),
                basis_error_bound: query.tolerance.map(|tolerance| 0.5 * tolerance),
                lamps_not_met: Vec::new(),
            },
            passes: vec![("coefficients", 900.0), ("basis sum", 80.0)],
        })
    }
}

impl SkySource for Fake {
    fn facts(&self) -> &SourceFacts {
        &self.facts
    }

    fn is_ready(&self) -> bool {
        self.ready.load(Ordering::SeqCst)
    }

    fn stats(&self) -> EngineStats {
        EngineStats {
            queue_length: 3,
            queue_capacity: 64,
            rendered: self.rendered.load(Ordering::SeqCst) as u64,
            dark_requests: 0,
            refused: 0,
            failed: 0,
            batches: 2,
            largest_batch: 4,
            device_losses: 1,
            mixed_nodes: 0,
            lit_cells: 0,
            lit_columns: 0,
            passes: vec![skyglow_render::PassTime { name: "coefficients", microseconds: 1500.0 }],
        }
    }

    fn open_scenes(&self) -> usize {
        1
    }

    fn atmospheres(&self) -> Vec<AtmosphereAnswer> {
        let pack = |kind: &KindFacts| AtmosphereAnswer {
            turbidity: 2.5,
            scattering: kind.scattering.name().into(),
            ground_albedo: kind.ground_albedo,
            cloud_base_m: kind.cloud_base_m(),
            cloud_albedo: kind.clouds.map(Clouds::albedo),
            bands_nm: vec![680.0, 550.0, 440.0],
            observer_altitude_m: [0.0, 6000.0],
            source_altitude_m: [0.0, 6000.0],
            distance_m: [250.0, 300_000.0],
            basis_count: kind.basis_count,
            checksum: "abc".into(),
            measured_error: None,
        };
        self.facts.kinds.iter().map(pack).collect()
    }

    fn scenes(&self) -> Result<Vec<SceneMetadata>, SourceError> {
        Ok(vec![self.metadata()])
    }

    fn upload_folder(&self) -> Result<UploadFolder, SourceError> {
        Err(SourceError::Storage("a made-up program has no disk".into()))
    }

    fn ingest(&self, _: &IngestOptions) -> Result<(SceneMetadata, bool), SourceError> {
        Err(SourceError::Storage("a made-up program has no disk".into()))
    }

    fn remove_scene(&self, id: &SceneId) -> Result<(), SourceError> {
        self.known(id).map(drop)
    }

    fn scene(&self, id: &SceneId) -> Result<SceneMetadata, SourceError> {
        self.known(id)
    }

    fn places(&self, id: &SceneId) -> Result<Vec<NamedPlace>, SourceError> {
        self.known(id)?;
        Ok(vec![NamedPlace {
            name: "Nairobi".into(),
            latitude_deg: -1.2864,
            longitude_deg: 36.8172,
            population: Some(4_397_073),
        }])
    }

    fn open_scene(&self, id: &SceneId, _: Option<&ChangeId>) -> Result<Arc<Scene>, SourceError> {
        self.known(id)?;
        Err(SourceError::Down("a made-up program has no scene to open".into()))
    }

    fn site(
        &self,
        id: &SceneId,
        scenario: Option<&ChangeId>,
        place: GeoPoint,
    ) -> Result<SiteFacts, SourceError> {
        let scene = self.known(id)?;
        if let Some(scenario) = scenario {
            return Err(SourceError::UnknownScenario(scenario.to_string()));
        }
        let [west, south, east, north] = BOUNDS;
        let (lat, lon) = (place.latitude_deg(), place.longitude_deg());
        if lat < south || lat > north || lon < west || lon > east {
            return Err(SourceError::OutsideScene { bounds: BOUNDS });
        }
        Ok(SiteFacts { scene, ground: self.ground(), radiance_nw_cm2_sr: Some(12.5) })
    }

    fn tile(
        &self,
        id: &SceneId,
        _: Option<&ChangeId>,
        _: TileLayer,
        (z, x, y): (u8, u32, u32),
        size_px: u32,
    ) -> Result<RasterTile, SourceError> {
        self.known(id)?;
        if z > 24 || x >> z != 0 || y >> z != 0 {
            return Err(SourceError::UnknownTile("off the world".into()));
        }
        let count = (size_px * size_px) as usize;
        Ok(RasterTile {
            values: (0..count).map(|i| (i % 256) as f32).collect(),
            has_data: vec![true; count],
            size_px,
        })
    }

    /// Influences need the light of a real scene: `whole.rs` asks for them.
    fn influence(&self, query: &InfluenceQuery) -> Result<InfluenceMap, SourceError> {
        self.known(&query.sky.scene)?;
        Err(SourceError::Down("a made-up program knows no influences".into()))
    }

    fn brightness(
        &self,
        query: &BrightnessRequest,
        _: &dyn PatchStore,
    ) -> Result<BrightnessMap, SourceError> {
        self.known(&query.scene)?;
        Err(SourceError::Down("a made-up program knows no brightness".into()))
    }

    /// Neither are scenarios and plans.
    fn store_scenario(&self, scenario: &Scenario) -> Result<ChangeId, SourceError> {
        self.known(&scenario.scene)?;
        let mut kept = self.kept.lock().unwrap();
        let Some(kept) = kept.as_mut() else {
            return Err(SourceError::Storage("a made-up program keeps nothing".into()));
        };
        let number = kept.iter().position(|known| known == scenario).unwrap_or_else(|| {
            kept.push(scenario.clone());
            kept.len() - 1
        });
        Ok(ChangeId::parse(&format!("s-{:020x}", number + 1)).unwrap())
    }

    fn scenario(&self, id: &ChangeId) -> Result<(Scenario, Arc<ChangeSummary>, u64), SourceError> {
        let unknown = || SourceError::UnknownScenario(id.to_string());
        let number = usize::from_str_radix(&id.as_str()[2..], 16).map_err(|_| unknown())?;
        let kept = self.kept.lock().unwrap();
        let scenario = kept.as_ref().and_then(|kept| kept.get(number.checked_sub(1)?)).ok_or_else(unknown)?;
        Ok((scenario.clone(), Arc::default(), 0))
    }

    fn plan(&self, request: &PlanRequest) -> Result<PlanOutcome, SourceError> {
        let scenes = request.sites().into_iter().map(|site| self.known(&site.sky.scene));
        scenes.collect::<Result<Vec<_>, _>>()?;
        Err(SourceError::Down("a made-up program plans nothing".into()))
    }

    fn store_plan(&self, _: &ChangeId, _: &StoredPlan) -> Result<(), SourceError> {
        Err(SourceError::Storage("a made-up program keeps nothing".into()))
    }

    fn hold_plan(&self, _: &ChangeId, _: StoredPlan) {}

    fn check_base(&self, _: &ChangeId) -> Result<(), SourceError> {
        Ok(())
    }

    fn is_stored(&self, _: &ChangeId) -> bool {
        false
    }

    fn plan_by_id(&self, id: &ChangeId) -> Result<(StoredPlan, u64), SourceError> {
        Err(SourceError::UnknownScenario(id.to_string()))
    }

    fn list_scenarios(&self, scene: &SceneId) -> Result<Vec<ScenarioEntry>, SourceError> {
        self.known(scene)?;
        Ok(Vec::new())
    }

    fn list_plans(&self, scene: &SceneId) -> Result<Vec<PlanEntry>, SourceError> {
        self.known(scene)?;
        Ok(Vec::new())
    }

    fn sky(&self, query: Arc<SkyQuery>) -> BoxFuture<'_, Result<RenderedSky, SourceError>> {
        Box::pin(async move {
            let mood = self.mood.lock().unwrap().clone();
            match mood {
                Mood::Well => {}
                Mood::Slow(time) => tokio::time::sleep(time).await,
                Mood::Fails(error) => return Err(error),
                Mood::Panics => panic!("the secret of /etc/passwd"),
            }
            self.render(&query)
        })
    }
}
