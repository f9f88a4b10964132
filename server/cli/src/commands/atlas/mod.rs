//! `skyglow atlas`: a map layer of a whole scene, to a file.

mod found;
mod part_file;
mod tiles;

use self::{
    found::{Found, MapLayer},
    part_file::PartFile,
};
use crate::{
    failure::Failure,
    flags::{Bounds, ProgramFlags, bounds},
    progress::Stages,
    query::{self, QueryFlags},
};
use clap::Args;
use skyglow_app::{
    answers::{BrightnessAssumptions, brightness_shows},
    facts::SourceFacts,
    fingerprint::{atlas_key, brightness_key},
    map_part::{check_part, window_within},
    parameters::BrightnessParameters,
    request,
};
use skyglow_display::{notes, tile::RADIANCE_RANGE_NW_CM2_SR};
use skyglow_observatory::{BrightnessRequest, SceneView};
use skyglow_scene::{PatchStore, PlaceWindow, RasterMetadata, SceneId, TileLayer};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// Bake a map layer of a whole scene to a cloud-optimized GeoTIFF or a PMTiles archive
///
/// A map of brightness that was interrupted goes on where it was: what is found so far is kept in FILE.part.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  skyglow atlas --scene demo -o brightness.tif\n  skyglow atlas --scene demo --turbidity 3.5 -o brightness.pmtiles\n  skyglow atlas --scene demo --bounds 8.5,46,9,46.5 -o ticino.tif"
)]
pub(crate) struct Atlas {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// What it shows; radiance takes --scenario of the parameters, elevation none
    #[arg(long, env = "SKYGLOW_LAYER", value_enum, default_value = "brightness")]
    layer: MapLayer,
    /// File to write; its ending says the format: .tif or .pmtiles
    #[arg(short, long, env = "SKYGLOW_OUTPUT", value_name = "FILE", value_parser = output)]
    output: Output,
    /// Places of the whole map at most: where the scene has more pixels, blocks of them share one. More than 400 000 000 are made part by
    /// part, with --bounds
    #[arg(long, env = "SKYGLOW_PLACES", value_name = "N", default_value_t = 16_000_000,
          value_parser = clap::value_parser!(u32).range(1..))]
    places: u32,
    /// West, south, east and north of the part to make, degrees, of a .tif; the same numbers as in the map of the whole scene [default:
    /// all of the scene]
    #[arg(long, env = "SKYGLOW_BOUNDS", value_name = "W,S,E,N", value_parser = bounds, allow_hyphen_values = true)]
    bounds: Option<Bounds>,
    /// Deepest zoom level of PMTiles; a server shows none with fewer than the default [default: that at which a tile's pixel is no larger than the way between
    /// places]
    #[arg(long, env = "SKYGLOW_MAX_ZOOM", value_name = "Z", value_parser = clap::value_parser!(u8).range(0..=14))]
    max_zoom: Option<u8>,
    #[command(flatten)]
    query: QueryFlags<BrightnessParameters>,
    #[command(flatten)]
    program: ProgramFlags,
}

/// A file of a map.
#[derive(Clone, Debug)]
struct Output {
    path: PathBuf,
    format: Format,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    GeoTiff,
    PmTiles,
}

fn output(text: &str) -> Result<Output, String> {
    let path = PathBuf::from(text);
    let format = match path.extension().and_then(|extension| extension.to_str()) {
        Some("tif" | "tiff") => Format::GeoTiff,
        Some("pmtiles") => Format::PmTiles,
        _ => return Err("the ending must be .tif or .pmtiles".to_owned()),
    };
    Ok(Output { path, format })
}

impl Atlas {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        self.request(&self.program.facts())?;
        self.check_parameters()?;
        if let Some(folder) = self.output.path.parent().filter(|folder| !folder.as_os_str().is_empty())
            && !folder.is_dir()
        {
            return Err(Failure::file(folder, std::io::Error::from(std::io::ErrorKind::NotFound)));
        }
        let stages = Stages::new();
        let part = part_of(&self.output.path);
        let found = match self.layer {
            MapLayer::Brightness => self.brightness(&part, &stages)?,
            MapLayer::Radiance => self.of_scene(TileLayer::Radiance)?,
            MapLayer::Elevation => self.of_scene(TileLayer::Elevation)?,
        };
        match self.output.format {
            Format::GeoTiff => self.write_raster(&found)?,
            Format::PmTiles => {
                let deepest =
                    self.max_zoom.unwrap_or_else(|| tiles::deepest_zoom(&found.scene, &found.places));
                tiles::write(&self.output.path, self.layer, &found, deepest, &stages)?;
            }
        }
        PartFile::remove(&part);
        let lattice = found.places.lattice();
        tracing::info!(
            "{}: {} x {} places, {} pixel(s) of the scene from one to the next",
            self.output.path.display(),
            lattice.columns,
            lattice.rows,
            lattice.step
        );
        Ok(())
    }

    /// Refuses parameters that mean nothing for the layer: silence would hide a slip.
    fn check_parameters(&self) -> Result<(), Failure> {
        if self.bounds.is_some() && self.output.format == Format::PmTiles {
            return Err(Failure::Usage("--bounds means nothing for .pmtiles".to_owned()));
        }
        let allowed: &[&str] = match self.layer {
            MapLayer::Brightness => return Ok(()),
            MapLayer::Radiance => &["scenario"],
            MapLayer::Elevation => &[],
        };
        let mut given = self.query.query().split('&').filter_map(|pair| pair.split_once('='));
        match given.find(|(name, _)| !allowed.contains(name)) {
            Some((name, _)) => Err(Failure::Usage(format!("--{name} means nothing for this layer"))),
            None => Ok(()),
        }
    }

    fn request(&self, facts: &SourceFacts) -> Result<BrightnessRequest, Failure> {
        let query = request::brightness(Some(self.query.query()), self.scene.clone(), facts)
            .map_err(|error| query::failure(&error))?;
        Ok(BrightnessRequest { max_places: self.places as usize, ..query })
    }

    fn brightness(&self, part: &Path, stages: &Stages) -> Result<Found, Failure> {
        let source = self.program.source()?;
        let request = self.request(source.facts())?;
        let failure = |error| query::failure(&error);
        let view = source.view(&request.scene, request.scenario.as_ref()).map_err(failure)?;
        // A key knows the program too: another one's numbers are not gone on with.
        let key = brightness_key(&request, view.version(), source.facts()).map_err(failure)?;
        let atlas_key = atlas_key(&request, view.version(), source.facts()).map_err(failure)?;
        let window = self.window(&request, &view)?;
        let store = PartStore { file: PartFile::open(part, &key)?, stages };
        if request.terrain_hides {
            self.prepare_skylines(&view, stages);
        }
        stages.begin("brightness of places", 1000);
        let prepared = source.prepare_brightness(&request, &view).map_err(failure)?;
        let map = source
            .brightness_part(&prepared, window.as_ref(), &store)
            .map_err(|error| store.failure(part).unwrap_or_else(|| query::failure(&error)))?;
        let assumptions = BrightnessAssumptions::new(&request, &map, source.facts());
        for warning in &assumptions.warnings {
            tracing::warn!("{warning}");
        }
        Ok(Found {
            scene: Arc::clone(view.scene()),
            unit: map.unit(),
            description: brightness_shows(map.measure, map.light, map.cloud_base_m, &map.response),
            colour_range: map.colour_range(),
            asked: Some([atlas_key, self.query.query().to_owned()]),
            assumptions: serde_json::to_string(&assumptions).map_err(Failure::work)?,
            places: map.into_places(),
        })
    }

    /// The places within the bounds that are asked for; None for all.
    fn window(&self, request: &BrightnessRequest, view: &SceneView) -> Result<Option<PlaceWindow>, Failure> {
        let window = match self.bounds {
            None => None,
            Some(bounds) => Some(
                window_within(request, view, bounds)
                    .ok_or_else(|| Failure::Usage("no place of the scene lies within --bounds".to_owned()))?,
            ),
        };
        let all = || view.scene().place_lattice(request.max_places).len();
        let count = window.as_ref().map_or_else(all, PlaceWindow::count);
        check_part(count).map_err(|error| query::failure(&error))?;
        Ok(window)
    }

    /// Finds what terrain hides of the lights around the part, where that is found when it is needed: it may take minutes.
    fn prepare_skylines(&self, view: &SceneView, stages: &Stages) {
        let mut is_begun = false;
        let prepared = view.scene().prepare_skylines(self.bounds, &mut |done, lights| {
            if !is_begun {
                stages.begin("skylines of lights", lights);
                is_begun = true;
            }
            stages.set(done);
        });
        if let Err(error) = prepared {
            tracing::warn!("skylines are found, and not kept: {error}");
        }
    }

    fn of_scene(&self, layer: TileLayer) -> Result<Found, Failure> {
        let source = self.program.source()?;
        let request = self.request(source.facts())?;
        let scenario = request.scenario.as_ref().filter(|_| layer == TileLayer::Radiance);
        let view = source.view(&request.scene, scenario).map_err(|error| query::failure(&error))?;
        let scene = Arc::clone(view.scene());
        let lattice = scene.place_lattice(request.max_places);
        let part = self.window(&request, &view)?.map_or(lattice, |window| lattice.part(&window));
        let places = scene.layer_at_places(layer, part);
        let places =
            places.ok_or_else(|| Failure::Work("a layer of another size than its places".to_owned()))?;
        let (unit, description) = match layer {
            TileLayer::Radiance => ("nW cm-2 sr-1", "upward radiance"),
            TileLayer::Elevation => ("m", "terrain elevation"),
        };
        let assumptions = serde_json::json!({
            "scene": scene.metadata().id,
            "version": scene.metadata().version,
            "scenario": scenario.map(ToString::to_string),
        });
        let colour_range = RADIANCE_RANGE_NW_CM2_SR;
        let (unit, description) = (unit.to_owned(), description.to_owned());
        Ok(Found {
            places,
            unit,
            description,
            colour_range,
            assumptions: assumptions.to_string(),
            asked: None,
            scene,
        })
    }

    fn write_raster(&self, found: &Found) -> Result<(), Failure> {
        let notes = [("TIFFTAG_SOFTWARE", "Skyglow"), ("ASSUMPTIONS", found.assumptions.as_str())];
        let description = notes::description(found.description.clone(), found.scene.metadata().illustrative);
        let words = RasterMetadata { description: &description, unit: &found.unit, notes: &notes };
        let bytes = found.scene.places_geotiff(&found.places, &words).map_err(Failure::work)?;
        let path = &self.output.path;
        // Whole or not there: a reader never sees half a file.
        let unfinished = path.with_extension("unfinished");
        let written = std::fs::write(&unfinished, bytes).and_then(|()| std::fs::rename(&unfinished, path));
        written.map_err(|error| Failure::file(path, error))
    }
}

/// Where the results so far are stored.
fn part_of(output: &Path) -> PathBuf {
    let mut name = output.as_os_str().to_owned();
    name.push(".part");
    PathBuf::from(name)
}

struct PartStore<'a> {
    file: PartFile,
    stages: &'a Stages,
}

impl PartStore<'_> {
    /// What ended the work, if it was the file.
    fn failure(&self, path: &Path) -> Option<Failure> {
        self.file.error().map(|error| Failure::Work(format!("{}: {error}", path.display())))
    }
}

impl PatchStore for PartStore<'_> {
    fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>> {
        self.file.load(patch, count)
    }

    fn store(&self, patch: u64, sums: &[f32], progress: f64) -> bool {
        self.stages.set((1000.0 * progress) as u64);
        self.file.store(patch, sums)
    }
}
