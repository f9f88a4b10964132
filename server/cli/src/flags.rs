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

/// West, south, east, north, degrees.
pub(crate) type Bounds = [f64; 4];

/// Bounds from the command line.
pub(crate) fn bounds(text: &str) -> Result<Bounds, String> {
    let numbers = text.split(',').map(|part| part.trim().parse::<f64>()).collect::<Result<Vec<_>, _>>();
    match numbers.as_deref() {
        Ok(&[west, south, east, north])
            if (-180.0..=360.0).contains(&west)
                && (-180.0..=360.0).contains(&east)
                && (-90.0..north).contains(&south)
                && north <= 90.0
                && west != east =>
        {
            Ok([west, south, east, north])
        }
        _ => Err("four numbers with commas between them: west, south, east, north in degrees".to_owned()),
    }
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
        folders::packs_of(&packs)?;
        let loaded = LoadedEngine::start(&packs, device.into(), None).map_err(Failure::work)?;
        let (limits, sizes) = (ChangeLimits::none(), CacheSizes::of_machine());
        Ok(program::open(loaded, &data, ChangeStore::new(&data, limits), None, &sizes, MAX_PLACES, false))
    }
}
