//! What blocks of far lights cost where their lights stand behind different skylines: a sky from blocks, which have the
//! mean of their lights' blocking angles, against the same sky from every pixel by itself.
//!
//! `block_skylines DATA_DIR PACK SCENE LAT,LON...`

use skyglow_physics::{
    AZIMUTH_COUNT, ELEVATION_COUNT, EmissionMix, GeoPoint, LampPreset, Panorama, Turbidity,
    error_metric::{ErrorStatistics, relative_error},
};
use skyglow_render::{DeviceChoice, Engine, EngineConfig, RenderRequest};
use skyglow_scene::{FAR_BLOCK_RATIO, RING_COUNT, SceneId, SceneStore, ring_distance_m};
use skyglow_tables::Pack;
use std::{error::Error, path::Path, sync::Arc};

/// Every fourth column is looked at.
const COLUMN_STEP: usize = 4;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, data, pack, id, places @ ..] = arguments.as_slice() else {
        return Err("usage: block_skylines DATA_DIR PACK SCENE LAT,LON...".into());
    };
    let rings: Vec<f64> = (0..RING_COUNT).map(ring_distance_m).collect();
    let tables = Pack::open(Path::new(pack))?.resident(&rings);
    let (turbidity, scattering) = (Turbidity::new(tables.turbidity)?, tables.scattering);
    let tables = vec![Arc::new(tables)];
    let engine =
        Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() })?;
    let scene = SceneStore::new(data).open(&SceneId::parse(id)?)?;
    for text in places {
        let (latitude, longitude) = text.split_once(',').ok_or("a place is LAT,LON")?;
        let place = GeoPoint::from_deg(latitude.parse()?, longitude.parse()?)?;
        let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
        let horizon = scene.horizon(place, observer_altitude_m);
        let sky = |terrain_hides: bool, far_block_ratio: f64| -> Result<Panorama, Box<dyn Error>> {
            let rendered = engine.render_blocking(RenderRequest {
                polar: Arc::new(scene.polar_grid_with_ratio(place, terrain_hides, far_block_ratio)),
                observer_altitude_m,
                turbidity,
                scattering,
                cloud_base_m: None,
                emission: EmissionMix::garstang(),
                flux_per_dnb_flux: LampPreset::Mixed.lamp().flux_per_dnb_flux,
                basis: None,
            })?;
            Ok(rendered.panorama)
        };
        let (blocks, pixels, open) = (sky(true, FAR_BLOCK_RATIO)?, sky(true, 0.0)?, sky(false, 0.0)?);
        let against_pixels = |other: &Panorama| {
            let samples = (0..ELEVATION_COUNT)
                .flat_map(|r| (0..AZIMUTH_COUNT).step_by(COLUMN_STEP).map(move |c| (r, c)));
            let at = |sky: &Panorama, row, column| {
                std::array::from_fn(|band| sky.radiance_w_m2_sr(band, row, column))
            };
            ErrorStatistics::of(
                samples
                    .filter(|&(row, column)| !horizon.hides_sample(row, column))
                    .map(|(row, column)| relative_error(at(other, row, column), at(&pixels, row, column))),
            )
            .ok_or("no sky is seen")
        };
        let (error, without) = (against_pixels(&blocks)?, against_pixels(&open)?);
        println!(
            "{text}: mean {:.3} %, 99 % {:.2} %, largest {:.2} %; what hidden lights change: mean {:.1} %",
            100.0 * error.mean,
            100.0 * error.p99,
            100.0 * error.maximum,
            100.0 * without.mean
        );
    }
    Ok(())
}
