//! What the server is told: a TOML file, over it the environment, over that flags.

use crate::{failure::Failure, folders};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use skyglow_engine::DeviceChoice;
use std::{
    net::{Ipv4Addr, SocketAddr},
    path::{Path, PathBuf},
};

/// What renders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Device {
    /// A hardware GPU if there is one, else lavapipe, else the CPU.
    #[default]
    Auto,
    /// A hardware GPU or an error.
    Gpu,
    /// Mesa's software Vulkan or an error.
    Lavapipe,
    /// Plain Rust, no Vulkan.
    Cpu,
}

impl From<Device> for DeviceChoice {
    fn from(device: Device) -> Self {
        match device {
            Device::Auto => DeviceChoice::Auto,
            Device::Gpu => DeviceChoice::Gpu,
            Device::Lavapipe => DeviceChoice::Lavapipe,
            Device::Cpu => DeviceChoice::Cpu,
        }
    }
}

/// One source of settings: the file, or the flags with their environment variables. None leaves a setting to
/// the source below.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(title = "Configuration of the Skyglow server")]
pub(crate) struct Layer {
    /// Address and port to listen on; default 127.0.0.1:8080. Port 0 takes a free one and logs it.
    pub(crate) listen: Option<SocketAddr>,
    /// Folder of the scenes; default `$XDG_DATA_HOME/skyglow`, else `~/.local/share/skyglow`.
    pub(crate) data: Option<PathBuf>,
    /// Folder of the table packs; default those that come with the program.
    pub(crate) packs: Option<PathBuf>,
    /// What renders; default `auto`.
    pub(crate) device: Option<Device>,
    /// Whether to do without the demo scene; default false: it is made when it is not there.
    pub(crate) no_demo: Option<bool>,
}

/// What is in force.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Settings {
    /// Address and port to listen on.
    pub(crate) listen: SocketAddr,
    /// Folder of the scenes.
    pub(crate) data: PathBuf,
    /// Folder of the table packs.
    pub(crate) packs: PathBuf,
    /// What renders.
    pub(crate) device: Device,
    /// Whether to do without the demo scene.
    pub(crate) no_demo: bool,
}

impl Layer {
    /// Reads a TOML file.
    ///
    /// # Errors
    /// [`Failure::Work`] with the file, the line and what is wrong there.
    pub(crate) fn from_file(path: &Path) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(path).map_err(|e| Failure::file(path, e))?;
        toml::from_str(&text).map_err(|error| {
            let line = error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
            let reason = error.message().lines().next().unwrap_or_default().to_owned();
            Failure::Work(format!("{}:{line}: {reason}", path.display()))
        })
    }

    /// This layer where it says something, else the one `below`.
    pub(crate) fn over(self, below: Self) -> Self {
        Self {
            listen: self.listen.or(below.listen),
            data: self.data.or(below.data),
            packs: self.packs.or(below.packs),
            device: self.device.or(below.device),
            no_demo: self.no_demo.or(below.no_demo),
        }
    }

    /// With defaults where nothing is said.
    pub(crate) fn settings(self) -> Settings {
        Settings {
            listen: self.listen.unwrap_or_else(|| SocketAddr::from((Ipv4Addr::LOCALHOST, 8080))),
            data: self.data.unwrap_or_else(folders::default_data_folder),
            packs: self.packs.unwrap_or_else(folders::default_packs_folder),
            device: self.device.unwrap_or_default(),
            no_demo: self.no_demo.unwrap_or(false),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from_text(text: &str) -> Result<Layer, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let name = file.path().display().to_string();
        Layer::from_file(file.path()).map_err(|failure| failure.to_string().replace(&name, "FILE"))
    }

    #[test]
    fn a_flag_wins_over_the_file_and_the_file_over_the_default() {
        let file = from_text("listen = \"0.0.0.0:80\"\ndevice = \"cpu\"\n").unwrap();
        let flags = Layer { device: Some(Device::Lavapipe), ..Layer::default() };
        let settings = flags.over(file).settings();
        assert_eq!(settings.listen.to_string(), "0.0.0.0:80");
        assert_eq!(settings.device, Device::Lavapipe);
        assert!(!settings.no_demo);
    }

    #[test]
    fn a_wrong_file_is_refused_with_its_line() {
        let unknown = from_text("device = \"cpu\"\nlisen = \"0.0.0.0:80\"\n").unwrap_err();
        assert!(unknown.starts_with("FILE:2: unknown field `lisen`"), "{unknown}");
        let device = from_text("device = \"tpu\"\n").unwrap_err();
        assert!(device.starts_with("FILE:1: unknown variant `tpu`"), "{device}");
        assert!(from_text("listen = \"port 80\"\n").is_err());
        assert!(from_text("listen").is_err());
    }

    #[test]
    fn what_print_writes_can_be_read_back() {
        let settings = Layer::default().settings();
        let layer = from_text(&toml::to_string(&settings).unwrap()).unwrap();
        assert_eq!(layer.settings(), settings);
    }

    #[test]
    fn the_schema_lists_every_setting() {
        let schema = serde_json::to_value(schemars::schema_for!(Layer)).unwrap();
        let settings = serde_json::to_value(Layer::default().settings()).unwrap();
        for name in settings.as_object().unwrap().keys() {
            assert!(schema["properties"][name]["description"].is_string(), "{name}");
        }
        assert_eq!(schema["additionalProperties"], serde_json::json!(false));
    }
}
