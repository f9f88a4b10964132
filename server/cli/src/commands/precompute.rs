//! `skyglow precompute`: the table pack of one turbidity, or of several at once.

use crate::{failure::Failure, folders, progress::Stages};
use clap::Args;
use skyglow_http::parameters::MOST_BASIS_FUNCTIONS;
use skyglow_physics::Turbidity;
use skyglow_tables::{PrecomputeOptions, precompute_together};
use std::path::PathBuf;

/// Make the table pack of one turbidity, or of several at once (minutes; goes on where a killed run stopped)
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow precompute --turbidity 2.5 --out packs\n  skyglow precompute --turbidity 1.5,2.5,6 --out packs   (shares most of the work)"
)]
pub(crate) struct Precompute {
    /// Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 thick haze; several with commas
    #[arg(
        long,
        env = "SKYGLOW_TURBIDITY",
        value_name = "T",
        value_parser = super::turbidity,
        value_delimiter = ',',
        required = true
    )]
    turbidity: Vec<Turbidity>,
    /// Orders of scattering
    #[arg(long, env = "SKYGLOW_SCATTERING", value_enum, default_value = "single")]
    scattering: Scattering,
    /// Folder of the pack and its manifest [default: where `serve` looks for packs]
    #[arg(long, env = "SKYGLOW_OUT", value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of basis functions, a multiple of 4 [default: that of the packs that come with the program]
    #[arg(long, env = "SKYGLOW_BASIS", value_name = "M", value_parser = multiple_of_4)]
    basis: Option<usize>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Scattering {
    /// First order alone
    Single,
}

fn multiple_of_4(text: &str) -> Result<usize, String> {
    const MOST: usize = MOST_BASIS_FUNCTIONS as usize;
    match text.parse::<usize>() {
        Ok(count) if (4..=MOST).contains(&count) && count.is_multiple_of(4) => Ok(count),
        _ => Err(format!("allowed are multiples of 4 from 4 to {MOST}")),
    }
}

impl Precompute {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let Scattering::Single = self.scattering;
        let out = self.out.unwrap_or_else(folders::packs_folder_in_force);
        let first = self.turbidity.first().copied().unwrap_or_default();
        let mut options = PrecomputeOptions::full(first);
        options.basis_count = self.basis.unwrap_or(options.basis_count);
        let paths =
            precompute_together(&self.turbidity, &options, &out, &Stages::new()).map_err(Failure::work)?;
        for path in paths {
            super::print_line(&path.display().to_string())?;
        }
        Ok(())
    }
}
