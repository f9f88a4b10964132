//! Arguments that several programs take.

use skyglow_physics::{GeoPoint, PhysicsError, Turbidity};
use skyglow_render::DeviceChoice;
use skyglow_scene::{Scene, SceneError, SceneId, SceneStore};
use std::{error::Error, path::PathBuf, str::FromStr};

/// What a program ends with.
pub(crate) type Outcome = Result<(), Box<dyn Error>>;

/// Why a program was called wrongly.
type Wrong = Box<dyn Error + Send + Sync>;

/// A turbidity.
pub(crate) fn turbidity(text: &str) -> Result<Turbidity, Wrong> {
    Ok(Turbidity::new(text.parse()?)?)
}

/// Latitude and longitude, degrees, with a comma between them.
pub(crate) fn place(text: &str) -> Result<GeoPoint, Wrong> {
    let (latitude, longitude) = text.split_once(',').ok_or("a place is LATITUDE,LONGITUDE")?;
    Ok(GeoPoint::from_deg(latitude.parse()?, longitude.parse()?)?)
}

/// A device by its name.
pub(crate) fn device(name: &str) -> Result<DeviceChoice, &'static str> {
    DeviceChoice::from_name(name).ok_or("the devices are auto, gpu, lavapipe and cpu")
}

/// Values with commas between them.
#[derive(Clone, Debug)]
pub(crate) struct List<T>(pub(crate) Vec<T>);

impl<T: FromStr> FromStr for List<T> {
    type Err = T::Err;

    fn from_str(text: &str) -> Result<Self, T::Err> {
        text.split(',').map(str::parse).collect::<Result<_, _>>().map(Self)
    }
}

/// A scene of a data folder.
#[derive(Debug, clap::Args)]
pub(crate) struct SceneArguments {
    /// Folder of scenes.
    pub(crate) data: PathBuf,
    /// Id of the scene.
    #[arg(value_parser = SceneId::parse)]
    pub(crate) scene: SceneId,
}

impl SceneArguments {
    /// The scene.
    pub(crate) fn open(&self) -> Result<Scene, SceneError> {
        SceneStore::new(&self.data).open(&self.scene)
    }
}

/// A place in a scene and a turbidity, with packs.
#[derive(Debug, clap::Args)]
pub(crate) struct PlaceArguments {
    /// Folder of scenes.
    pub(crate) data: PathBuf,
    /// Folder of packs.
    pub(crate) packs: PathBuf,
    /// Id of the scene.
    #[arg(value_parser = SceneId::parse)]
    pub(crate) scene: SceneId,
    /// Degrees north.
    latitude_deg: f64,
    /// Degrees east.
    longitude_deg: f64,
    /// Turbidity.
    #[arg(value_parser = turbidity)]
    pub(crate) turbidity: Turbidity,
}

impl PlaceArguments {
    /// The scene.
    pub(crate) fn open(&self) -> Result<Scene, SceneError> {
        SceneStore::new(&self.data).open(&self.scene)
    }

    /// The place.
    pub(crate) fn place(&self) -> Result<GeoPoint, PhysicsError> {
        GeoPoint::from_deg(self.latitude_deg, self.longitude_deg)
    }
}
