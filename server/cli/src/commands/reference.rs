//! `skyglow reference`: the reference sky, by the direct sum.

use crate::{
    failure::Failure,
    flags::DataFlags,
    print,
    progress::Stages,
    query::{self, QueryFlags},
    values,
};
use clap::Args;
use serde::Serialize;
use skyglow_app::{
    answers::{Assumptions, PanoramaAnswer},
    conversion::above_clouds,
    parameters::ReferenceParameters,
    request,
};
use skyglow_display::Sky;
use skyglow_observatory::{RenderContext, RenderedSky, SkyRequest, night_sky::dark_sky};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, BlockedSource, CloudBase, ELEVATION_COUNT, Fixture, Horizon,
    Response, SkyPart, Slope, SourcePixel,
    direct_sum::{GridSample, cut_direct_sum, grid_direction, panorama_between, stratified_samples},
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, MultipleSum, Resolution, SumDensity},
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
    spectrum::{Light, RGB_BANDS},
};
use skyglow_scene::{ChangeLimits, ChangeStore, Scene, SceneId, SceneMetadata, SceneStore};
use skyglow_tables::{Clouds, Scattering};
use std::sync::Arc;

/// Compute the sky by summing every pixel exactly (slow; needs no packs) and print it as JSON
///
/// The first order is an integral for every pixel and direction. With multiple scattering all later orders are added
/// from fields solved for this very observer, one for every 300 m of source altitude, each ten seconds or more of
/// processor time: minutes on two cores.
///
/// Terrain hides lights by the model's definition: what leaves a light below the skyline between it and the observer,
/// as the light sees it, does not count in any order, and counts as cut off all around the light. Every pixel's skyline
/// comes from the terrain itself. Later orders then need fields behind skylines too, up to eight for each of some
/// altitudes around the observer's: how many there are in all is said before they are solved.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow reference --scene demo --lat 46.17 --lon 8.79 --directions 50 > reference.json"
)]
pub(crate) struct Reference {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// Number of directions, stratified over the sky with horizon and zenith always in; or all
    #[arg(long, env = "SKYGLOW_DIRECTIONS", value_name = "N|all", default_value = "500", value_parser = samples)]
    directions: Samples,
    /// Lambertian albedo of the ground, 0 to 1, for multiple scattering [default: 0.15]
    #[arg(long, env = "SKYGLOW_GROUND_ALBEDO", value_name = "A", value_parser = values::albedo, allow_negative_numbers = true)]
    ground_albedo: Option<f64>,
    /// Albedo of the base of --clouds from below, 0 to 0.95 [default: 0.5]
    #[arg(long, env = "SKYGLOW_CLOUD_ALBEDO", value_name = "A", value_parser = values::albedo, allow_negative_numbers = true)]
    cloud_albedo: Option<f64>,
    #[command(flatten)]
    query: QueryFlags<ReferenceParameters>,
    #[command(flatten)]
    data: DataFlags,
}

/// Grid samples in order.
#[derive(Clone, Debug)]
struct Samples(Vec<GridSample>);

const ALL: usize = AZIMUTH_COUNT * ELEVATION_COUNT;

fn samples(text: &str) -> Result<Samples, String> {
    let count = match text {
        "all" => Ok(ALL),
        number => number.parse().ok().filter(|count| (1..=ALL).contains(count)).ok_or(()),
    };
    let count = count.map_err(|()| format!("allowed are 1 to {ALL}, or all"))?;
    Ok(Samples(stratified_samples(count)))
}

/// One direction of the answer.
#[derive(Debug, Serialize)]
struct DirectionAnswer {
    row: usize,
    column: usize,
    azimuth_deg: f64,
    elevation_deg: f64,
    /// In R, G, B (600–700, 500–600, 400–500 nm), W m⁻² sr⁻¹; 0 where terrain hides the sky.
    radiance: [f64; 3],
    /// What the response sees, in its unit; 0 where terrain hides the sky.
    value: f64,
}

impl Reference {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let cloud_albedo = self.cloud_albedo.unwrap_or(CloudBase::DEFAULT_ALBEDO);
        let facts = query::reference_facts(self.ground_albedo.unwrap_or(DEFAULT_GROUND_ALBEDO), cloud_albedo);
        let (request, light) = request::reference(Some(self.query.query()), self.scene.clone(), &facts)
            .map_err(|error| query::failure(&error))?;
        if request.scattering == Scattering::Single && self.ground_albedo.is_some() {
            return Err(Failure::Usage(
                "--ground-albedo means nothing with --scattering single: light of the first order never comes from \
                 the ground"
                    .to_owned(),
            ));
        }
        if request.cloud_base_m.is_none() && self.cloud_albedo.is_some() {
            return Err(Failure::Usage("--cloud-albedo means nothing without --clouds".to_owned()));
        }
        let clouds = request.cloud_base_m.map(|base_m| Clouds::new(base_m, cloud_albedo)).transpose();
        let clouds = clouds.map_err(|error| Failure::Usage(error.to_string()))?;
        let atmosphere = Atmosphere::new(request.turbidity).under(clouds.map(Clouds::base));
        let scene = self.scene(&request)?;
        if !scene.contains(request.place) {
            let [west, south, east, north] = scene.metadata().bounds;
            return Err(Failure::Work(format!(
                "the place lies outside the scene, which reaches from west {west} south {south} to east {east} \
                 north {north}"
            )));
        }
        let ground = scene.ground(request.place);
        let altitude_m = request.observer_height.altitude_m(ground);
        if let Some(clouds) = clouds.filter(|clouds| altitude_m > clouds.ceiling_m()) {
            let (base_m, maximum_m) = (clouds.base_m(), clouds.ceiling_m());
            return Err(query::failure(&above_clouds(altitude_m, base_m, maximum_m)));
        }
        let kinds = lights(&scene, &request);
        let horizon =
            if request.terrain_hides { scene.horizon(request.place, altitude_m) } else { Horizon::flat() };
        // Ground needs no sum, and what lies between directions of the sky is not to take from its darkness.
        let is_sky = |&(row, column): &GridSample| !horizon.hides_sample(row, column);
        let visible: Vec<GridSample> = self.directions.0.iter().copied().filter(is_sky).collect();
        let mut kernels = Vec::new();
        for (fixture, sources) in &kinds {
            let (mix, flux_factor) =
                request.emission.of_fixture(fixture).map_err(|error| Failure::Usage(error.to_string()))?;
            let light = SkyRequest { emission: mix.into(), ..request.clone() };
            let mut kernel = sum(atmosphere, &light, altitude_m, sources, &visible);
            if request.scattering == Scattering::Multiple {
                add(&mut kernel, self.later_orders(atmosphere, &light, altitude_m, sources, &visible)?);
            }
            kernel.iter_mut().flatten().for_each(|value| *value *= flux_factor);
            kernels.push((fixture.light(&request.lamp), kernel));
        }
        let parts = kernels.iter().map(|(light, kernel)| SkyPart {
            light: Arc::clone(light),
            kernel: panorama_between(&visible, kernel),
        });
        let context = RenderContext {
            altitude_m,
            ground,
            coverage: scene.coverage(request.place),
            calibration: scene.metadata().calibration,
            local_optical_depth: atmosphere.vertical_optical_depth(altitude_m),
            flux_dnb_w: kinds
                .iter()
                .flat_map(|(_, sources)| sources)
                .map(|blocked| blocked.source.flux_dnb_w)
                .sum(),
            // No tables.
            under_clouds: None,
            basis_count: 0,
            basis_error_bound: None,
            dark: dark_sky(None, request.turbidity, altitude_m),
            lamps_not_met: Vec::new(),
            slope: if request.terrain_hides { scene.slope(request.place) } else { Slope::default() },
        };
        let sky = RenderedSky::new(&request, parts.collect(), horizon, context);
        // Skylines come from the terrain itself, also where the scene was stored without them.
        let metadata = SceneMetadata { light_skylines: scene.metadata().terrain, ..scene.metadata().clone() };
        let mut assumptions = Assumptions::new(&request, &metadata, &sky.context, &facts);
        let is_sample = self.directions.0.len() < ALL;
        if is_sample {
            assumptions.warnings.push(format!(
                "the numbers of `sky` are interpolated between {} of {ALL} directions; --directions all computes \
                 them from the whole sky",
                self.directions.0.len()
            ));
        }
        let mut answer =
            serde_json::to_value(PanoramaAnswer::new(assumptions, &sky, light)).map_err(Failure::work)?;
        if let Some(fields) = answer.as_object_mut() {
            // A sum has no basis.
            fields.remove("basis_count");
            fields.remove("basis_error_bound");
            if is_sample {
                // What is interpolated cannot judge, direction by direction.
                fields.remove("radiance");
            }
            let dark = &sky.context.dark;
            let natural = |response: &Response| if light == Sky::Total { dark.value(response) } else { 0.0 };
            let seen = |response: &Response, at: usize| {
                let of_kind = |(light, kernel): &(Arc<Light>, Vec<[f64; BAND_COUNT]>)| {
                    light.rule(response).value(kernel[at])
                };
                kernels.iter().map(of_kind).sum::<f64>() + natural(response)
            };
            let mut directions: Vec<DirectionAnswer> = visible
                .iter()
                .enumerate()
                .map(|(at, &sample)| {
                    let radiance = RGB_BANDS.each_ref().map(|band| seen(band, at));
                    direction_answer(sample, radiance, seen(&request.response, at))
                })
                .collect();
            let is_ground = |&&(row, column): &&GridSample| sky.horizon.hides_sample(row, column);
            let hidden = self.directions.0.iter().filter(is_ground);
            directions.extend(hidden.map(|&sample| direction_answer(sample, [0.0; 3], 0.0)));
            directions.sort_by_key(|direction| (direction.row, direction.column));
            fields.insert("directions".to_owned(), serde_json::to_value(directions).map_err(Failure::work)?);
        }
        print::print_json(&answer)
    }
}

impl Reference {
    /// The scene, with the changes of a scenario or plan.
    fn scene(&self, request: &SkyRequest) -> Result<Scene, Failure> {
        let folder = self.data.folder();
        let scene = SceneStore::new(&folder).open(&self.scene).map_err(Failure::work)?;
        let Some(scenario) = &request.scenario else { return Ok(scene) };
        let steps = ChangeStore::new(&folder, ChangeLimits::none())
            .steps(scenario, &self.scene, &scene.metadata().version)
            .map_err(Failure::work)?;
        Ok(scene.changed(&steps, scenario.as_str()).map_err(Failure::work)?.0)
    }

    /// What light brings that was scattered more than once.
    fn later_orders(
        &self,
        atmosphere: Atmosphere,
        request: &SkyRequest,
        altitude_m: f64,
        sources: &[BlockedSource],
        samples: &[GridSample],
    ) -> Result<Vec<[f64; BAND_COUNT]>, Failure> {
        let sum = MultipleSum {
            atmosphere,
            ground_albedo: self.ground_albedo.unwrap_or(DEFAULT_GROUND_ALBEDO),
            observer_altitude_m: altitude_m,
            emission: request.emission.mix(),
            resolution: Resolution::table(),
            density: SumDensity::default(),
        };
        let directions: Vec<_> = samples.iter().copied().map(grid_direction).collect();
        let stages = Stages::new();
        let fields = sum.field_count(sources);
        stages.begin(&format!("later orders: {fields} fields"), fields as u64);
        sum.cut_radiance(sources, [1.0; BAND_COUNT], &directions, &|| stages.advance(1))
            .map_err(|error| Failure::Usage(error.to_string()))
    }
}

fn add(radiance: &mut [[f64; BAND_COUNT]], more: Vec<[f64; BAND_COUNT]>) {
    for (bands, more) in radiance.iter_mut().zip(more) {
        bands.iter_mut().zip(more).for_each(|(band, more)| *band += more);
    }
}

/// Every light around the observer by kinds of fixtures, behind its skyline where terrain is to hide.
fn lights(scene: &Scene, request: &SkyRequest) -> Vec<(Fixture, Vec<BlockedSource>)> {
    if request.terrain_hides && scene.metadata().terrain {
        let stages = Stages::new();
        stages.begin("skylines of lights", 1);
        let sources = scene.blocked_sources_by_fixture(request.place);
        stages.advance(1);
        return sources;
    }
    let open = |pixels: Vec<SourcePixel>| {
        point_sources(request.place, &pixels).into_iter().map(BlockedSource::open).collect()
    };
    let pixels = scene.source_pixels_by_fixture(request.place, MAX_SOURCE_DISTANCE_M);
    pixels.into_iter().map(|(fixture, pixels)| (fixture, open(pixels))).collect()
}

fn sum(
    atmosphere: Atmosphere,
    request: &SkyRequest,
    altitude_m: f64,
    sources: &[BlockedSource],
    samples: &[GridSample],
) -> Vec<[f64; BAND_COUNT]> {
    let stages = Stages::new();
    stages.begin("directions", samples.len() as u64);
    let directions: Vec<_> = samples.iter().copied().map(grid_direction).collect();
    cut_direct_sum(
        &[atmosphere],
        sources,
        altitude_m,
        request.emission.mix(),
        [1.0; BAND_COUNT],
        &directions,
        &|| stages.advance(1),
    )
}

fn direction_answer((row, column): GridSample, radiance: [f64; 3], value: f64) -> DirectionAnswer {
    let direction = grid_direction((row, column));
    DirectionAnswer {
        row,
        column,
        azimuth_deg: direction.azimuth_rad.to_degrees(),
        elevation_deg: direction.elevation_rad.to_degrees(),
        radiance,
        value,
    }
}
