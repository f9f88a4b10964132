//! Flags that several commands share.

use crate::{device::Device, failure::Failure, folders, program, query};
use clap::{Args, builder::BoolishValueParser};
use skyglow_app::{SkySource, facts::SourceFacts, opening::LoadedEngine};
use skyglow_observatory::{CacheSizes, MAX_PLACES};
use skyglow_scene::{ChangeLimits, ChangeStore};
use std::{path::PathBuf, sync::Arc};

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
        self.given().unwrap_or_else(folders::default_packs_folder)
    }

    /// The folder where one was named.
    pub(crate) fn given(&self) -> Option<PathBuf> {
        self.packs.clone()
    }
}

/// Results for machines.
#[derive(Debug, Args)]
pub(crate) struct JsonFlags {
    /// Print JSON
    #[arg(long, env = "SKYGLOW_JSON", value_parser = BoolishValueParser::new())]
    pub(crate) json: bool,
}

/// What a command that renders needs.
#[derive(Debug, Args)]
pub(crate) struct ProgramFlags {
    #[command(flatten)]
    data: DataFlags,
    #[command(flatten)]
    packs: PacksFlags,
    /// What renders: a GPU, Mesa's lavapipe, plain Rust, or the best there is [default: auto]
    #[arg(long, env = "SKYGLOW_DEVICE", value_enum)]
    device: Option<Device>,
}

impl ProgramFlags {
    /// What the packs will serve, without opening them.
    pub(crate) fn facts(&self) -> SourceFacts {
        query::facts_of_packs(&self.packs.folder())
    }

    /// Scenes, packs and engine, ready to answer.
    pub(crate) fn source(&self) -> Result<Arc<dyn SkySource>, Failure> {
        let device = self.device.unwrap_or_default();
        let (data, packs) = (self.data.folder(), self.packs.folder());
        let loaded = LoadedEngine::start(&packs, device.into(), None).map_err(Failure::work)?;
        let (limits, sizes) = (ChangeLimits::none(), CacheSizes::of_machine());
        Ok(program::open(loaded, &data, ChangeStore::new(&data, limits), &sizes, MAX_PLACES, false))
    }
}
