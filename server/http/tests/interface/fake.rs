//! A program behind the interface that does as it is told.

use skyglow_app::{
    AppError, SkySource,
    answers::{AtmosphereAnswer, PlanEntry, ScenarioEntry},
    conversion::check_altitude,
    facts::{KindFacts, LeftOut, SourceFacts},
    format::rounded,
    request::ListRequest,
    source::BoxFuture,
};
use skyglow_observatory::{
    BrightnessMap, BrightnessRequest, DarkerPlaces, DarkerRequest, InfluenceMap, InfluenceRequest,
    PlanOutcome, PlanRequest, RenderContext, RenderedSky, ScenarioRecord, SceneView, Site, SkyAtTime,
    SkyRequest, SkyTime, Watch, night_sky::dark_sky,
};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, ELEVATION_COUNT, GeoPoint, Horizon, Panorama, SeenSky, SkyPart,
    Slope, spectrum::RGB_BANDS,
};
use skyglow_render::{EngineStats, PassTime};
use skyglow_scene::{
    Account, ChangeId, ChangeStore, GridMetadata, Ground, IngestOptions, IngestReport, NamedPlace, Owner,
    Page, PatchStore, Posting, RasterTile, Scenario, Scene, SceneId, SceneMetadata, SceneStore, StoredPlan,
    TileLayer, UploadFolder, Viewer, ingest,
};
use skyglow_tables::{Clouds, Scattering};
use std::{
    sync::{
        Arc, LazyLock, Mutex,
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
    Fails(AppError),
    /// Panic.
    Panics,
}

/// The program.
pub(crate) struct Fake {
    facts: SourceFacts,
    pub(crate) mood: Mutex<Mood>,
    pub(crate) rendered: AtomicUsize,
    /// Plans and influences that are being found.
    pub(crate) long_work: AtomicUsize,
    pub(crate) ready: AtomicBool,
    pub(crate) left_out: Mutex<LeftOut>,
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
                    unserved: Vec::new(),
                    basis_count: 64,
                    ground_albedo: None,
                    why_open: None,
                    checksums: String::new(),
                }],
                any_cloud_albedo: None,
                altitude_range_m: (0.0, 6000.0),
                celestial_turbidity_range: Some((1.5, 6.0)),
                celestial_highest_m: Some(4500.0),
                pack_checksums: "abc".into(),
            },
            mood: Mutex::default(),
            rendered: AtomicUsize::new(0),
            long_work: AtomicUsize::new(0),
            ready: AtomicBool::new(true),
            left_out: Mutex::default(),
            version: Mutex::new("v1".into()),
            ground: Mutex::new(Ground::Here { elevation_m: GROUND_M }),
            coverage: Mutex::new(0.95),
            horizon: Mutex::default(),
            illustrative: AtomicBool::new(true),
            kept: Mutex::default(),
        }
    }
}

/// A scene of two lights under another description: what the made-up program renders does not depend on it.
static SCENE: LazyLock<Arc<Scene>> = LazyLock::new(|| {
    let data = tempfile::tempdir().unwrap();
    let raster = data.path().join("light.tif");
    std::fs::write(&raster, include_bytes!("../../../../tests/fuzz/seeds/raster/smallest")).unwrap();
    let store = SceneStore::new(data.path());
    let id = ingest(&store, &IngestOptions::new(raster), &mut |_| {}).unwrap().id;
    Arc::new(store.open(&id).unwrap())
});

/// Bounds of the made-up scene.
pub(crate) const BOUNDS: [f64; 4] = [36.0, -2.0, 38.0, 1.0];
/// Altitude of the ground everywhere in it unless a test says otherwise, metres.
pub(crate) const GROUND_M: f64 = 1700.0;

/// The same in R, G, B of the default lamp.
pub(crate) fn bands_of(turbidity: f64) -> SeenSky {
    let light = Arc::clone(skyglow_physics::Lamp::default().light());
    SeenSky::of(&[SkyPart { light, kernel: sky_of(turbidity) }], &RGB_BANDS)
}

/// A sky that is bright in the low east, in proportion to turbidity.
pub(crate) fn sky_of(turbidity: f64) -> Panorama {
    let mut panorama = Panorama::dark();
    for band in 0..BAND_COUNT {
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
            unserved: Vec::new(),
            basis_count: 32,
            ground_albedo: Some(0.15),
            why_open: Some("in this test"),
            checksums: String::new(),
        });
        fake
    }

    /// Works for as long as it is slow and somebody waits, and fails then.
    fn work_long(&self, watch: &Watch<'_>) -> AppError {
        let Mood::Slow(time) = self.mood.lock().unwrap().clone() else { return AppError::EngineDown };
        self.long_work.fetch_add(1, Ordering::SeqCst);
        let start = std::time::Instant::now();
        while start.elapsed() < time && watch(start.elapsed().as_secs_f64() / time.as_secs_f64()) {
            std::thread::sleep(Duration::from_millis(5));
        }
        self.long_work.fetch_sub(1, Ordering::SeqCst);
        AppError::EngineDown
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
            land_cover: false,
            places_count: 1,
            places_source: None,
            ingested_unix_s: Some(1_764_374_400),
            // A real scene's is a hash of all that is said of it.
            version: {
                let measured = if self.illustrative.load(Ordering::SeqCst) { "" } else { "-measured" };
                format!("{}{measured}", self.version.lock().unwrap())
            },
        }
    }

    fn known(&self, id: &SceneId) -> Result<SceneMetadata, AppError> {
        if id.as_str() == "demo" {
            Ok(self.metadata())
        } else {
            Err(AppError::UnknownScene { id: id.to_string() })
        }
    }

    fn render(&self, request: &SkyRequest) -> Result<RenderedSky, AppError> {
        check_altitude(request, self.ground(), (0.0, 6000.0))?;
        let altitude_m = request.observer_height.altitude_m(self.ground());
        self.rendered.fetch_add(1, Ordering::SeqCst);
        let mut panorama = sky_of(request.turbidity.value());
        if request.scattering == Scattering::Multiple {
            panorama.samples_mut().iter_mut().for_each(|sample| *sample *= 2.0);
        }
        let horizon =
            if request.terrain_hides { self.horizon.lock().unwrap().clone() } else { Horizon::flat() };
        let context = RenderContext {
            altitude_m,
            ground: self.ground(),
            coverage: *self.coverage.lock().unwrap(),
            calibration: 1.0,
            local_optical_depth: Atmosphere::new(request.turbidity).vertical_optical_depth(altitude_m),
            flux_dnb_w: 1e6,
            under_clouds: None,
            basis_count: request.basis.unwrap_or(if request.tolerance.is_some() { 16 } else { 64 }),
            basis_error_bound: request.tolerance.map(|tolerance| 0.5 * tolerance),
            dark: dark_sky(None, request.turbidity, altitude_m),
            lamps_not_met: Vec::new(),
            slope: Slope::default(),
        };
        let parts = vec![SkyPart { light: Arc::clone(request.lamp.light()), kernel: panorama }];
        Ok(RenderedSky {
            passes: vec![
                PassTime { name: "coefficients", microseconds: 900.0 },
                PassTime { name: "basis sum", microseconds: 80.0 },
            ],
            ..RenderedSky::new(request, parts, horizon, context)
        })
    }
}

impl SkySource for Fake {
    fn facts(&self) -> &SourceFacts {
        &self.facts
    }

    /// It knows no natural sky.
    fn sky_at_times(
        &self,
        _: &SkyRequest,
        _: &RenderedSky,
        _: &[SkyTime],
    ) -> Result<Vec<SkyAtTime>, AppError> {
        Ok(Vec::new())
    }

    fn is_ready(&self) -> bool {
        self.ready.load(Ordering::SeqCst)
    }

    fn left_out(&self) -> LeftOut {
        self.left_out.lock().unwrap().clone()
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
            passes: vec![PassTime { name: "coefficients", microseconds: 1500.0 }],
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

    fn scenes(&self) -> Result<Vec<SceneMetadata>, AppError> {
        Ok(vec![self.metadata()])
    }

    fn upload_folder(&self) -> Result<UploadFolder, AppError> {
        Err(AppError::Storage { reason: "a made-up program has no disk".into() })
    }

    fn ingest(&self, _: &UploadFolder, _: &IngestOptions) -> Result<(SceneMetadata, bool), AppError> {
        Err(AppError::Storage { reason: "a made-up program has no disk".into() })
    }

    fn remove_scene(&self, id: &SceneId) -> Result<(), AppError> {
        self.known(id).map(drop)
    }

    fn view(&self, id: &SceneId, scenario: Option<&ChangeId>) -> Result<SceneView, AppError> {
        let metadata = self.known(id)?;
        if let Some(scenario) = scenario {
            return Err(AppError::UnknownScenario { id: scenario.to_string() });
        }
        Ok(SceneView::new(Arc::clone(&SCENE), Arc::clone(&SCENE)).with_metadata(metadata))
    }

    fn places(&self, _: &SceneView) -> Vec<NamedPlace> {
        vec![NamedPlace {
            name: "Nairobi".into(),
            latitude_deg: -1.2864,
            longitude_deg: 36.8172,
            population: Some(4_397_073),
        }]
    }

    fn site(&self, _: &SceneView, place: GeoPoint) -> Result<Site, AppError> {
        let [west, south, east, north] = BOUNDS;
        let (latitude_deg, longitude_deg) = (place.latitude_deg(), place.longitude_deg());
        if latitude_deg < south || latitude_deg > north || longitude_deg < west || longitude_deg > east {
            let [latitude_deg, longitude_deg] = [latitude_deg, longitude_deg].map(rounded);
            return Err(AppError::OutsideScene { latitude_deg, longitude_deg, bounds: BOUNDS });
        }
        Ok(Site { ground: self.ground(), radiance_nw_cm2_sr: Some(12.5) })
    }

    fn tile(
        &self,
        _: &SceneView,
        _: TileLayer,
        (z, x, y): (u8, u32, u32),
        size_px: u32,
    ) -> Result<RasterTile, AppError> {
        if z > 24 || x >> z != 0 || y >> z != 0 {
            return Err(AppError::UnknownTile { reason: "off the world".into() });
        }
        let count = (size_px * size_px) as usize;
        Ok(RasterTile {
            values: (0..count).map(|i| (i % 256) as f32).collect(),
            has_data: vec![true; count],
            size_px,
        })
    }

    /// Influences need the light of a real scene: `end_to_end` asks for them.
    fn influence(
        &self,
        _: &InfluenceRequest,
        _: &SceneView,
        watch: &Watch<'_>,
    ) -> Result<InfluenceMap, AppError> {
        Err(self.work_long(watch))
    }

    fn brightness(
        &self,
        _: &BrightnessRequest,
        _: &SceneView,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, AppError> {
        let mood = self.mood.lock().unwrap().clone();
        if let Mood::Slow(time) = mood {
            store.store(0, &[], 0.25);
            std::thread::sleep(time);
        }
        Err(AppError::EngineDown)
    }

    fn darker(&self, _: &DarkerRequest, _: &SceneView, watch: &Watch<'_>) -> Result<DarkerPlaces, AppError> {
        Err(self.work_long(watch))
    }

    /// Neither are scenarios and plans.
    fn store_scenario(&self, scenario: &Scenario, _: &Posting) -> Result<(ChangeId, bool), AppError> {
        self.known(&scenario.scene)?;
        let mut kept = self.kept.lock().unwrap();
        let Some(kept) = kept.as_mut() else {
            return Err(AppError::Storage { reason: "a made-up program keeps nothing".into() });
        };
        let known = kept.iter().position(|known| known == scenario);
        let number = known.unwrap_or_else(|| {
            kept.push(scenario.clone());
            kept.len() - 1
        });
        Ok((ChangeId::parse(&format!("s-{:020x}", number + 1)).unwrap(), known.is_none()))
    }

    fn scenario(&self, id: &ChangeId) -> Result<ScenarioRecord, AppError> {
        let unknown = || AppError::UnknownScenario { id: id.to_string() };
        let number = usize::from_str_radix(&id.as_str()[2..], 16).map_err(|_| unknown())?;
        let kept = self.kept.lock().unwrap();
        let scenario = kept.as_ref().and_then(|kept| kept.get(number.checked_sub(1)?)).ok_or_else(unknown)?;
        Ok(ScenarioRecord {
            scenario: scenario.clone(),
            summary: Arc::default(),
            scene: self.metadata(),
            created_unix_s: 0,
        })
    }

    fn plan(&self, _: &PlanRequest, _: &SceneView, watch: &Watch<'_>) -> Result<PlanOutcome, AppError> {
        Err(self.work_long(watch))
    }

    fn plan_id(&self, content: Vec<u8>, _: &Posting) -> Result<ChangeId, AppError> {
        Ok(ChangeStore::plan_id(&content))
    }

    fn remove_change(&self, id: &ChangeId, _: Option<&Owner>) -> Result<(), AppError> {
        Err(AppError::UnknownScenario { id: id.to_string() })
    }

    fn store_plan(&self, _: &ChangeId, _: &StoredPlan, _: &Posting) -> Result<bool, AppError> {
        Err(AppError::Storage { reason: "a made-up program keeps nothing".into() })
    }

    fn hold_plan(&self, _: &ChangeId, _: StoredPlan, _: &Account) {}

    fn check_base(&self, _: &ChangeId) -> Result<(), AppError> {
        Ok(())
    }

    fn is_kept(&self, _: &ChangeId) -> Result<bool, AppError> {
        Ok(false)
    }

    fn plan_by_id(&self, id: &ChangeId) -> Result<(StoredPlan, u64), AppError> {
        Err(AppError::UnknownScenario { id: id.to_string() })
    }

    fn list_scenarios(
        &self,
        scene: &SceneId,
        _: &Viewer,
        _: &ListRequest,
    ) -> Result<Page<ScenarioEntry>, AppError> {
        self.known(scene)?;
        Ok(Page { entries: Vec::new(), next: None })
    }

    fn list_plans(&self, scene: &SceneId, _: &Viewer, _: &ListRequest) -> Result<Page<PlanEntry>, AppError> {
        self.known(scene)?;
        Ok(Page { entries: Vec::new(), next: None })
    }

    fn sky(&self, request: Arc<SkyRequest>, _: SceneView) -> BoxFuture<'_, Result<RenderedSky, AppError>> {
        Box::pin(async move {
            let mood = self.mood.lock().unwrap().clone();
            match mood {
                Mood::Well => {}
                Mood::Slow(time) => tokio::time::sleep(time).await,
                Mood::Fails(error) => return Err(error),
                Mood::Panics => panic!("the secret of /etc/passwd"),
            }
            self.render(&request)
        })
    }
}
