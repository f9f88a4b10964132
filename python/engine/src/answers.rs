//! Answers to questions by their addresses in the HTTP interface, in this process.

use crate::addresses::{document, find};
use serde::Serialize;
use skyglow_app::{
    AppError, SkySource,
    accept::{Format, InfluenceFormat},
    answers::{Assumptions, BrightnessAssumptions, ScenarioAnswer, SceneAnswer, SiteAnswer, SkyAnswer},
    conversion::check_altitude,
    drawing::draw,
    influence_file::encode_influences,
    layer_file,
    opening::{LoadedEngine, OpenError},
    plan_file::plan_answer,
    planning::{make_plan, prepare_plan},
    problem::LineError,
    request::{self, Keeping, no_parameters, scenario_alone, scene_id},
    shares_file::{SharesFormat, SharesQuestion},
    sky_lines::each_sky_line,
};
use skyglow_observatory::{
    CacheSizes, MAX_PLACES, PreparedBrightness, RenderedSky, SceneView, SkyRequest, Watch,
};
use skyglow_render::DeviceChoice;
use skyglow_scene::{ChangeLimits, Posting, SceneId, TileLayer};
use std::{
    path::Path,
    sync::{Arc, Mutex},
};
use tokio::runtime::{Builder, Runtime};

/// Threads that look after the skies under way. What they compute has threads of its own.
const WATCHING_THREADS: usize = 2;

/// Formats of a panorama.
const FORMATS: [Format; 6] =
    [Format::Json, Format::Png, Format::WebP, Format::Tiff, Format::Exr, Format::Sky];

/// An engine with its packs before the scenes of a folder.
pub struct Answers {
    pub(crate) source: Arc<dyn SkySource>,
    /// The map of which a part was asked for last, with what decides it.
    pub(crate) last_map: Mutex<Option<(String, Arc<PreparedBrightness>)>>,
    runtime: Runtime,
}

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// The address, such as `/api/v1/scenes/demo/sky`.
    pub address: &'a str,
    /// The query, percent-encoded.
    pub query: &'a str,
    /// The body of what the interface takes by POST.
    pub body: Option<&'a [u8]>,
}

/// What is asked of a scene.
struct OfScene<'a> {
    id: SceneId,
    query: Option<&'a str>,
    body: &'a [u8],
}

impl Answers {
    /// Opens packs and starts an engine; takes a second or two.
    ///
    /// # Errors
    /// [`OpenError`].
    pub fn open(packs: &Path, data: &Path, device: DeviceChoice) -> Result<Self, OpenError> {
        let loaded = LoadedEngine::start(packs, device, None)?;
        let sizes = CacheSizes::of_machine();
        let source: Arc<dyn SkySource> =
            Arc::new(loaded.before(data, ChangeLimits::none(), &sizes, MAX_PLACES));
        let runtime = Builder::new_multi_thread()
            .worker_threads(WATCHING_THREADS)
            .thread_name("skyglow-engine")
            .enable_time()
            .build()?;
        Ok(Self { source, last_map: Mutex::new(None), runtime })
    }

    /// What renders.
    pub fn executor(&self) -> &str {
        &self.source.facts().executor
    }

    /// The device's name.
    pub fn adapter(&self) -> &str {
        &self.source.facts().adapter
    }

    /// The bytes of an answer, or a problem document.
    ///
    /// * `watch`: is told how far long work is, and may end it.
    ///
    /// # Errors
    /// Why there is none.
    pub fn answer(&self, question: &Question<'_>, watch: &Watch<'_>) -> Result<Vec<u8>, Box<LineError>> {
        let Question { address, query, body } = *question;
        let (operation, scene) = find(address, body.is_some()).ok_or_else(|| nothing_at(address))?;
        let read = || {
            let query = Some(query);
            if scene.is_empty() {
                return self.of_none(operation.name, query);
            }
            let asked = OfScene { id: scene_id(scene)?, query, body: body.unwrap_or_default() };
            self.of_scene(operation.below, &asked, watch)
        };
        read().map_err(|error: AppError| Box::new(problem(&error)))
    }

    /// What needs no scene.
    fn of_none(&self, name: &str, query: Option<&str>) -> Result<Vec<u8>, AppError> {
        match name {
            "get_night" => return json(&request::night(query)?),
            "list_nights" => return json(&request::nights(query)?),
            _ => no_parameters(query)?,
        }
        match name {
            "list_atmospheres" => json(&self.source.atmospheres()),
            "list_scenes" => {
                json(&self.source.scenes()?.into_iter().map(SceneAnswer::from).collect::<Vec<_>>())
            }
            _ => json(&document()),
        }
    }

    fn of_scene(&self, below: &str, asked: &OfScene<'_>, watch: &Watch<'_>) -> Result<Vec<u8>, AppError> {
        let what = below.split_once("{scene}").map_or("", |(_, what)| what.trim_start_matches('/'));
        let (name, extension) = what.split_once('.').unwrap_or((what, ""));
        match name {
            "" | "places" => self.scene(name, asked),
            "site" => self.site(asked),
            "sky" => {
                let request = request::sky(asked.query, asked.id.clone(), self.source.facts())?;
                let (assumptions, sky) = self.rendered(request)?;
                json(&SkyAnswer::new(assumptions, &sky))
            }
            "panorama" => self.panorama(extension, asked),
            "influence" => self.influence(extension, asked, watch),
            "shares" => self.shares(asked, watch),
            "layers/radiance" => {
                let scenario = scenario_alone(asked.query)?;
                let view = self.source.view(&asked.id, scenario.as_ref())?;
                layer_file::scene_layer(view.scene(), TileLayer::Radiance)
            }
            "layers/elevation" => {
                no_parameters(asked.query)?;
                let view = self.source.view(&asked.id, None)?;
                layer_file::scene_layer(view.scene(), TileLayer::Elevation)
            }
            "layers/brightness" => self.brightness(asked, watch),
            "skies" => self.skies(asked, watch),
            "plans" => self.plan(asked, watch),
            "scenarios" => self.scenario(asked),
            _ => Err(AppError::internal(format!("nobody answers {below}"))),
        }
    }

    fn scene(&self, name: &str, asked: &OfScene<'_>) -> Result<Vec<u8>, AppError> {
        no_parameters(asked.query)?;
        let view = self.source.view(&asked.id, None)?;
        match name {
            "places" => json(&self.source.places(&view)),
            _ => json(&SceneAnswer::from(view.metadata().clone())),
        }
    }

    fn site(&self, asked: &OfScene<'_>) -> Result<Vec<u8>, AppError> {
        let (place, scenario) = request::place(asked.query)?;
        let view = self.source.view(&asked.id, scenario.as_ref())?;
        json(&SiteAnswer::new(place, view.metadata(), self.source.site(&view, place)?))
    }

    fn rendered(&self, request: SkyRequest) -> Result<(Assumptions, RenderedSky), AppError> {
        let view = self.source.view(&request.scene, request.scenario.as_ref())?;
        self.rendered_in(&Arc::new(request), &view)
    }

    fn rendered_in(
        &self,
        request: &Arc<SkyRequest>,
        view: &SceneView,
    ) -> Result<(Assumptions, RenderedSky), AppError> {
        let source = &self.source;
        let site = source.site(view, request.place)?;
        check_altitude(request, site.ground, source.facts().altitude_range_m)?;
        let sky = self.runtime.block_on(source.sky(Arc::clone(request), view.clone()))?;
        Ok((Assumptions::new(request, view.metadata(), &sky.context, source.facts()), sky))
    }

    fn panorama(&self, extension: &str, asked: &OfScene<'_>) -> Result<Vec<u8>, AppError> {
        let format = FORMATS.into_iter().find(|format| format.extension() == extension);
        let format = format.ok_or_else(|| AppError::internal(format!("no format {extension}")))?;
        let facts = self.source.facts();
        let (request, picture) = request::panorama(asked.query, asked.id.clone(), facts, format)?;
        let request = Arc::new(request);
        let view = self.source.view(&request.scene, request.scenario.as_ref())?;
        let (assumptions, sky) = self.rendered_in(&request, &view)?;
        draw(assumptions, (&request, &view), &sky, &picture, format).map_err(AppError::internal)
    }

    fn influence(
        &self,
        extension: &str,
        asked: &OfScene<'_>,
        watch: &Watch<'_>,
    ) -> Result<Vec<u8>, AppError> {
        let (source, facts) = (&self.source, self.source.facts());
        let format = InfluenceFormat::from_extension(extension);
        let format = format.ok_or_else(|| AppError::internal(format!("no format {extension}")))?;
        let body = (!asked.body.is_empty()).then_some(asked.body);
        let wanted = request::influence(asked.query, body, asked.id.clone(), facts, format)?;
        let of_sky = &wanted.request.sky;
        let view = source.view(&of_sky.scene, of_sky.scenario.as_ref())?;
        let site = source.site(&view, of_sky.place)?;
        check_altitude(of_sky, site.ground, facts.altitude_range_m)?;
        if let Some(area) = &wanted.boundary {
            area.check_within(view.metadata().bounds)?;
        }
        let map = source.influence(&wanted.request, &view, watch)?;
        let assumptions = Assumptions::of_influences(&wanted.request, &map, facts);
        encode_influences(assumptions, &map, &wanted, format).map_err(AppError::internal)
    }

    fn shares(&self, asked: &OfScene<'_>, watch: &Watch<'_>) -> Result<Vec<u8>, AppError> {
        let (source, facts) = (&self.source, self.source.facts());
        let question = match asked.body {
            [] => SharesQuestion::Places(request::shares(asked.query, asked.id.clone(), facts)?),
            body => SharesQuestion::Areas(request::area_shares(asked.query, body, asked.id.clone(), facts)?),
        };
        let request = match &question {
            SharesQuestion::Places(places) => &places.request,
            SharesQuestion::Areas(areas) => &areas.request,
        };
        let of_sky = &request.sky;
        let view = source.view(&of_sky.scene, of_sky.scenario.as_ref())?;
        let site = source.site(&view, of_sky.place)?;
        check_altitude(of_sky, site.ground, facts.altitude_range_m)?;
        if let SharesQuestion::Areas(areas) = &question {
            areas.check_within(view.metadata().bounds)?;
        }
        let map = source.influence(request, &view, watch)?;
        let assumptions = Assumptions::of_influences(request, &map, facts);
        let outcome = question.answer(assumptions, &map, watch)?;
        outcome.encode(SharesFormat::Json, &[]).map_err(AppError::internal)
    }

    fn brightness(&self, asked: &OfScene<'_>, watch: &Watch<'_>) -> Result<Vec<u8>, AppError> {
        let facts = self.source.facts();
        let request = request::brightness(asked.query, asked.id.clone(), facts)?;
        let view = self.source.view(&request.scene, request.scenario.as_ref())?;
        let map = self.source.brightness(&request, &view, &|done| watch(done))?;
        layer_file::brightness_layer(&map, &BrightnessAssumptions::new(&request, &map, facts))
    }

    fn skies(&self, asked: &OfScene<'_>, watch: &Watch<'_>) -> Result<Vec<u8>, AppError> {
        let source = &self.source;
        let wanted = request::skies(asked.query, asked.body, asked.id.clone(), source.facts())?;
        let view = source.view(&asked.id, wanted.scenario.as_ref())?;
        let mut lines = Vec::new();
        let take = async |done: f64, line: Vec<u8>| {
            lines.extend_from_slice(&line);
            watch(done)
        };
        self.runtime.block_on(each_sky_line(source, &view, &asked.id, wanted.skies, take))?;
        Ok(lines)
    }

    fn plan(&self, asked: &OfScene<'_>, watch: &Watch<'_>) -> Result<Vec<u8>, AppError> {
        let source = self.source.as_ref();
        let wanted = request::plan(asked.query, asked.body, asked.id.clone(), source.facts())?;
        let view = prepare_plan(source, &wanted)?;
        let (plan, _) = make_plan(source, &wanted, &view, &posting(wanted.keeping), watch)?;
        json(&plan_answer(&plan, wanted.limit))
    }

    fn scenario(&self, asked: &OfScene<'_>) -> Result<Vec<u8>, AppError> {
        let (scenario, keeping) = request::scenario(asked.query, asked.body, asked.id.clone())?;
        let (id, _) = self.source.store_scenario(&scenario, &posting(keeping))?;
        json(&ScenarioAnswer::new(&id, &self.source.scenario(&id)?))
    }
}

/// Whoever has the folder owns what is kept in it.
fn posting(keeping: Keeping) -> Posting {
    Posting { listed: keeping.listed, pinned: keeping.pinned, ..Posting::default() }
}

fn json(answer: &impl Serialize) -> Result<Vec<u8>, AppError> {
    serde_json::to_vec(answer).map_err(AppError::internal)
}

/// A problem as the HTTP interface says it, but for what is meant for a server's clients alone.
pub(crate) fn problem(error: &AppError) -> LineError {
    let mut problem = LineError::from(error);
    match error {
        // There is no log that would say more.
        AppError::Internal { reason } | AppError::Storage { reason } => problem.detail.clone_from(reason),
        AppError::UnknownScene { id } => {
            problem.detail = format!("there is no scene \"{id}\"; scenes() lists those that are there");
        }
        _ => {}
    }
    problem
}

fn nothing_at(address: &str) -> Box<LineError> {
    Box::new(LineError {
        kind: "/problems/not-found".to_owned(),
        title: "There is nothing here".to_owned(),
        detail: format!("the engine has no {address}; parameters() names what it has"),
        errors: Vec::new(),
        bounds: None,
    })
}
