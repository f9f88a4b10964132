//! Flags that several commands share.

use crate::{
    folders,
    settings::{Device, Layer},
};
use clap::{Args, builder::BoolishValueParser};
use std::{net::SocketAddr, path::PathBuf};

/// Where the scenes are.
#[derive(Debug, Args)]
pub(crate) struct DataFlags {
    /// Folder of the scenes [default: $XDG_DATA_HOME/skyglow, else ~/.local/share/skyglow]
    #[arg(long, env = "SKYGLOW_DATA", value_name = "DIR")]
    data: Option<PathBuf>,
}

impl DataFlags {
    /// The folder.
    pub(crate) fn folder(&self) -> PathBuf {
        self.data.clone().unwrap_or_else(folders::default_data_folder)
    }
}

/// Where the table packs are.
#[derive(Debug, Args)]
pub(crate) struct PacksFlags {
    /// Folder of the table packs [default: those that come with the program]
    #[arg(long, env = "SKYGLOW_PACKS", value_name = "DIR")]
    packs: Option<PathBuf>,
}

impl PacksFlags {
    /// The folder.
    pub(crate) fn folder(&self) -> PathBuf {
        self.packs.clone().unwrap_or_else(folders::default_packs_folder)
    }

    /// The folder where one was named.
    pub(crate) fn given(&self) -> Option<PathBuf> {
        self.packs.clone()
    }
}

/// What renders.
#[derive(Debug, Args)]
pub(crate) struct DeviceFlags {
    /// What renders: a GPU, Mesa's lavapipe, plain Rust, or the best there is [default: auto]
    #[arg(long, env = "SKYGLOW_DEVICE", value_enum)]
    device: Option<Device>,
}

impl DeviceFlags {
    /// The choice.
    pub(crate) fn device(&self) -> Device {
        self.device.unwrap_or_default()
    }
}

/// Results for machines.
#[derive(Debug, Args)]
pub(crate) struct JsonFlags {
    /// Print JSON
    #[arg(long, env = "SKYGLOW_JSON", value_parser = BoolishValueParser::new())]
    pub(crate) json: bool,
}

/// Everything that decides what the server does; the same names are in the file.
#[derive(Debug, Args)]
pub(crate) struct ServerFlags {
    /// Address and port to listen on; port 0 takes a free one [default: 127.0.0.1:8080]
    #[arg(long, env = "SKYGLOW_LISTEN", value_name = "ADDRESS:PORT")]
    listen: Option<SocketAddr>,
    #[command(flatten)]
    data: DataFlags,
    #[command(flatten)]
    packs: PacksFlags,
    #[command(flatten)]
    device: DeviceFlags,
    /// Do not make the demo scene (`--no-demo=false` overrides a file)
    #[arg(long, env = "SKYGLOW_NO_DEMO", value_parser = BoolishValueParser::new(),
          num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    no_demo: Option<bool>,
}

impl ServerFlags {
    /// What flags and environment say.
    pub(crate) fn layer(&self) -> Layer {
        Layer {
            listen: self.listen,
            data: self.data.data.clone(),
            packs: self.packs.packs.clone(),
            device: self.device.device,
            no_demo: self.no_demo,
        }
    }
}
