//! `skyglow bench`: run time against error.

use crate::{
    failure::Failure,
    flags::{DataFlags, PacksFlags},
    folders, print,
    table::aligned,
};
use clap::{Args, builder::BoolishValueParser};
use skyglow_bench::{BenchOptions, Extent, Report, sections};
use skyglow_render::resident_tables;
use std::path::PathBuf;

/// Measure run time against error on this machine, beside slower ways of computing the same sky (minutes)
///
/// Panoramas of 1 to 2 048 lit cells and of rasters of up to a million lit pixels are timed on every executor that there
/// is and with bases of several sizes; so are, in the same run and on the same threads, the direct sum over every source
/// and the accumulation of interpolated source images, in part and scaled where they would take minutes. Errors are
/// those against the sum over every source: computed for made-up light, and from files for places of the demo where
/// packs have all orders of scattering.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow bench --quick\n  skyglow bench --out results --reference tests/reference/demo-03.json"
)]
pub(crate) struct Bench {
    /// Fewer scenes, and no errors: within two minutes
    #[arg(long, env = "SKYGLOW_QUICK", value_parser = BoolishValueParser::new())]
    quick: bool,
    /// Folder for bench.json, every row of it, and the plots; without it the table alone
    #[arg(long, env = "SKYGLOW_OUT", value_name = "DIR")]
    out: Option<PathBuf>,
    /// Reference sky of a place of the demo, as the repository's tests/reference has them; may come several times
    #[arg(long, alias = "truth", env = "SKYGLOW_REFERENCE", value_name = "FILE", value_delimiter = ',')]
    reference: Vec<PathBuf>,
    #[command(flatten)]
    data: DataFlags,
    #[command(flatten)]
    packs: PacksFlags,
}

impl Bench {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let packs = folders::packs_of(&self.packs.folder())?;
        let (tables, manifests) = resident_tables(&packs).map_err(Failure::work)?;
        if let Some(folder) = &self.out {
            // Before the minutes that it takes, not after them.
            std::fs::create_dir_all(folder).map_err(|error| Failure::file(folder, error))?;
        }
        let report = skyglow_bench::run(&BenchOptions {
            tables,
            manifests,
            extent: if self.quick { Extent::quick() } else { Extent::full() },
            reference_files: self.reference,
            data: self.data.folder(),
        })
        .map_err(Failure::work)?;
        print::print_line(text(&report).trim_end())?;
        self.out.as_deref().map_or(Ok(()), |folder| report.write(folder).map_err(Failure::work))
    }
}

fn text(report: &Report) -> String {
    let parts: Vec<String> = sections(report)
        .into_iter()
        .map(|section| format!("{}\n\n{}", section.title, aligned(&section.rows)))
        .collect();
    parts.join("\n")
}
