//! What a map of brightness depends on.

use super::{
    EmissionAnswer, LampAnswer, ResponseAnswer, SceneReference,
    assumptions::{hides_lights, open_lights_warning},
};
use crate::facts::SourceFacts;
use serde::Serialize;
use skyglow_observatory::{BrightnessMap, BrightnessRequest, EYE_HEIGHT_M, MapLight, MapMeasure};
use skyglow_physics::Response;
use skyglow_scene::{ChangeId, SceneMetadata};

/// What every number of a map of brightness depends on; written into its rasters.
#[derive(Clone, Debug, Serialize)]
pub struct BrightnessAssumptions {
    /// The scene.
    pub scene: SceneReference,
    /// Id of the scenario or plan that changes its lights; null for the scene as it is.
    pub scenario: Option<String>,
    /// Observers' height above the ground, metres.
    pub height_m: f64,
    /// Factor on the raster's radiances.
    pub calibration: f64,
    /// Turbidity at sea level.
    pub turbidity: f64,
    /// `single` or `multiple`.
    pub scattering: String,
    /// Lambertian albedo of the ground; null where scattering is single.
    pub ground_albedo: Option<f64>,
    /// Altitude of the base of the clouds, metres above sea level, or `none`.
    pub clouds: String,
    /// As it is asked for: `zenith`, `horizontal`, `slope`.
    pub measure: String,
    /// `artificial` light alone, or `total` with the natural sky.
    pub sky: String,
    /// The time that the natural sky is of; absent for artificial light alone and for the dark reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// The lamp.
    pub lamp: LampAnswer,
    /// What sees the sky.
    pub response: ResponseAnswer,
    /// The emission.
    pub emission: EmissionAnswer,
    /// Whether light counts only above the skyline that its source sees towards the observer.
    pub hidden_lights: bool,
    /// Pixels of the scene from one place to the next.
    pub step_pixels: u32,
    /// What the numbers had to do without, one sentence each.
    pub warnings: Vec<String>,
}

/// What a map of brightness shows, in words.
pub fn brightness_shows(
    measure: MapMeasure,
    light: MapLight,
    cloud_base_m: Option<u32>,
    response: &Response,
) -> String {
    let [photopic, other] = match measure {
        MapMeasure::Zenith => ["artificial luminance at the zenith", "artificial light at the zenith"],
        MapMeasure::Mean => ["mean artificial luminance of the sky", "mean artificial light of the sky"],
        MapMeasure::Horizontal => {
            ["horizontal illuminance by artificial light", "artificial light on level ground"]
        }
        MapMeasure::Slope => [
            "illuminance of the ground as it slopes, by artificial light of the sky",
            "artificial light of the sky on the ground as it slopes",
        ],
        MapMeasure::VerticalNorth => WALLS[0],
        MapMeasure::VerticalEast => WALLS[1],
        MapMeasure::VerticalSouth => WALLS[2],
        MapMeasure::VerticalWest => WALLS[3],
        MapMeasure::VerticalLargest => [
            "illuminance of the wall that receives most artificial light of the sky",
            "artificial light of the sky on the wall that receives most",
        ],
        MapMeasure::Cylindrical => {
            ["cylindrical illuminance by artificial light", "artificial light on a small upright cylinder"]
        }
        MapMeasure::Spherical => {
            ["spherical illuminance by artificial light", "artificial light on a small sphere"]
        }
    };
    let artificial = match response {
        Response::Photopic => photopic.to_owned(),
        response => format!("{other}, {}", response.name()),
    };
    match light {
        MapLight::Artificial => match cloud_base_m {
            Some(base_m) => format!("{artificial}, under clouds at {base_m} m"),
            None => artificial,
        },
        MapLight::Total(None) => format!("{artificial}; the dark reference of the natural sky is added"),
        MapLight::Total(Some(time)) => {
            format!("{artificial}; the natural sky of {} is added", time.instant.to_rfc3339())
        }
    }
}

/// What maps of walls that face north, east, south and west show.
const WALLS: [[&str; 2]; 4] = [
    [
        "illuminance of walls that face north, by artificial light of the sky",
        "artificial light of the sky on walls that face north",
    ],
    [
        "illuminance of walls that face east, by artificial light of the sky",
        "artificial light of the sky on walls that face east",
    ],
    [
        "illuminance of walls that face south, by artificial light of the sky",
        "artificial light of the sky on walls that face south",
    ],
    [
        "illuminance of walls that face west, by artificial light of the sky",
        "artificial light of the sky on walls that face west",
    ],
];

impl BrightnessAssumptions {
    /// Those of a map.
    pub fn new(request: &BrightnessRequest, map: &BrightnessMap, facts: &SourceFacts) -> Self {
        Self::of_scene(request, map.scene(), map.places().lattice().step, facts)
    }

    /// The same before it is found.
    ///
    /// * `step_pixels`: pixels of the scene from one place to the next.
    pub fn of_scene(
        request: &BrightnessRequest,
        scene: &SceneMetadata,
        step_pixels: u32,
        facts: &SourceFacts,
    ) -> Self {
        let kind = facts.kinds_under(request.cloud_base_m).find(|kind| kind.scattering == request.scattering);
        let edge =
            "light outside the raster is unknown, not absent: near its edges the sky is brighter than this"
                .to_owned();
        let open = open_lights_warning(request.terrain_hides, scene, kind);
        let is_level = request.measure == MapMeasure::Slope && !(request.terrain_hides && scene.terrain);
        let level = is_level.then(|| "without terrain the ground is level under an open sky".to_owned());
        let clouds = request.cloud_base_m.map(|base_m| {
            format!("under clouds at {base_m} m: ground higher than 100 m below them has no value, natural light is not in it, and beside lights less than 100 m below them it can be 15 % off")
        });
        Self {
            scene: scene.into(),
            scenario: request.scenario.as_ref().map(ChangeId::to_string),
            height_m: EYE_HEIGHT_M,
            calibration: scene.calibration,
            turbidity: request.turbidity.value(),
            scattering: request.scattering.name().to_owned(),
            ground_albedo: kind.and_then(|kind| kind.ground_albedo),
            clouds: request.cloud_base_m.map_or_else(|| "none".to_owned(), |base_m| base_m.to_string()),
            measure: request.measure.name().to_owned(),
            sky: if request.light == MapLight::Artificial { "artificial" } else { "total" }.to_owned(),
            time: match request.light {
                MapLight::Total(time) => time.map(|time| time.instant.to_rfc3339()),
                MapLight::Artificial => None,
            },
            lamp: (&request.lamp).into(),
            response: (&request.response).into(),
            emission: request.emission.into(),
            hidden_lights: hides_lights(request.terrain_hides, scene, kind),
            step_pixels,
            warnings: std::iter::once(edge).chain(open).chain(level).chain(clouds).collect(),
        }
    }
}
