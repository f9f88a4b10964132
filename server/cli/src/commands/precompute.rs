//! `skyglow precompute`: the table pack of one turbidity, or of several at once, with the celestial table beside it.

use crate::{failure::Failure, folders, print, progress::Stages, values};
use clap::Args;
use skyglow_app::parameters::MAX_BASIS_FUNCTIONS;
use skyglow_physics::{CloudBase, Turbidity};
use skyglow_tables::{
    BasisCount, Clouds, MultipleAxes, PrecomputeOptions, Scattering,
    celestial::{CelestialOptions, precompute_celestial},
    precompute_together,
};
use std::path::PathBuf;

/// Make the table pack of one turbidity, or of several at once, and the celestial table beside it (minutes; goes on where a killed run stopped)
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow precompute --turbidity 2.5 --out packs\n  skyglow precompute --turbidity 1.5,2.5,6 --out packs   (shares most of the work)\n  skyglow precompute --turbidity 2.5 --ground-albedo 0.8 --out snow\n  skyglow precompute --turbidity 2.5 --cloud-base 1500   (an overcast sky)\n  skyglow precompute --turbidity 2.5 --part celestial   (skies of Sun and Moon alone)"
)]
pub(crate) struct Precompute {
    /// Turbidity at sea level: 1 is clean air, 2.5 a clear night, 6 thick haze; several with commas
    #[arg(
        long,
        env = "SKYGLOW_TURBIDITY",
        value_name = "T",
        value_parser = values::turbidity,
        value_delimiter = ',',
        required = true
    )]
    turbidity: Vec<Turbidity>,
    /// Make one part alone: skies of lamps, or of beams from the sky [default: both, but under clouds and in single scattering lamps alone]
    #[arg(long, env = "SKYGLOW_PART", value_enum)]
    part: Option<Part>,
    /// Orders of scattering
    #[arg(long, env = "SKYGLOW_SCATTERING", value_enum, default_value = "multiple")]
    scattering: Orders,
    /// Albedo of the ground, 0 to 1, which sends light back up; with multiple scattering alone [default: 0.15]
    #[arg(long, env = "SKYGLOW_GROUND_ALBEDO", value_name = "A", value_parser = values::albedo, allow_negative_numbers = true)]
    ground_albedo: Option<f64>,
    /// Base of a closed layer of cloud, whole metres above sea level [default: none, a clear sky]
    #[arg(long, env = "SKYGLOW_CLOUD_BASE", value_name = "M", value_parser = cloud_base_m)]
    cloud_base: Option<u32>,
    /// Albedo of that base from below, 0 to 0.95 [default: 0.5]
    #[arg(long, env = "SKYGLOW_CLOUD_ALBEDO", value_name = "A", value_parser = values::albedo, allow_negative_numbers = true, requires = "cloud_base")]
    cloud_albedo: Option<f64>,
    /// Instead of the albedo: optical depth of the drops, 0 to 250
    #[arg(long, env = "SKYGLOW_CLOUD_OPTICAL_DEPTH", value_name = "TAU", value_parser = values::cloud_optical_depth, allow_negative_numbers = true, requires = "cloud_base", conflicts_with = "cloud_albedo")]
    cloud_optical_depth: Option<f64>,
    /// Folder of the pack and its manifest [default: where `serve` looks for packs]
    #[arg(long, env = "SKYGLOW_OUT", value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of basis functions, a multiple of 4 [default: as the packs that come with the program: 112 up to turbidity 2, else 96; under clouds 64]
    #[arg(long, env = "SKYGLOW_BASIS", value_name = "M", value_parser = multiple_of_4)]
    basis: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    /// Skies of lamps
    Lamps,
    /// Skies of beams: Sun, Moon, starlight
    Celestial,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Orders {
    /// All orders, with the light that the ground sends back
    Multiple,
    /// First order alone
    Single,
}

impl From<Orders> for Scattering {
    fn from(orders: Orders) -> Self {
        match orders {
            Orders::Multiple => Self::Multiple,
            Orders::Single => Self::Single,
        }
    }
}

fn cloud_base_m(text: &str) -> Result<u32, String> {
    let base_m = text.parse().map_err(|_| "allowed are whole metres".to_owned())?;
    Clouds::new(base_m, CloudBase::DEFAULT_ALBEDO).map(Clouds::base_m).map_err(|error| error.to_string())
}

fn multiple_of_4(text: &str) -> Result<usize, String> {
    const MAX: usize = MAX_BASIS_FUNCTIONS as usize;
    match text.parse::<usize>() {
        Ok(count) if (4..=MAX).contains(&count) && count.is_multiple_of(4) => Ok(count),
        _ => Err(format!("allowed are multiples of 4 from 4 to {MAX}")),
    }
}

impl Precompute {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = self.options()?;
        let celestial = self.celestial_options(&options)?;
        let out = self.out.unwrap_or_else(folders::packs_folder_in_force);
        let mut paths = Vec::new();
        // The short part first.
        if let Some(celestial) = &celestial {
            let made = precompute_celestial(&self.turbidity, celestial, &out, &Stages::new());
            paths.extend(made.map_err(Failure::work)?);
        }
        if self.part != Some(Part::Celestial) {
            let made = precompute_together(&self.turbidity, &options, &out, &Stages::new());
            paths.extend(made.map_err(Failure::work)?);
        }
        for path in paths {
            print::print_line(&path.display().to_string())?;
        }
        Ok(())
    }

    /// What celestial tables hold, where any are made: beams come through clear air, and all their orders are one table.
    fn celestial_options(&self, options: &PrecomputeOptions) -> Result<Option<CelestialOptions>, Failure> {
        let are_possible = options.scattering == Scattering::Multiple && options.clouds.is_none();
        match self.part {
            Some(Part::Celestial) if !are_possible => Err(Failure::Usage(
                "--part celestial is for multiple scattering under a clear sky".to_owned(),
            )),
            Some(Part::Lamps) => Ok(None),
            _ => Ok(are_possible.then(|| CelestialOptions {
                ground_albedo: options.multiple.ground_albedo,
                ..CelestialOptions::default()
            })),
        }
    }

    fn options(&self) -> Result<PrecomputeOptions, Failure> {
        let scattering = Scattering::from(self.scattering);
        if scattering == Scattering::Single && self.ground_albedo.is_some() {
            return Err(Failure::Usage(
                "--ground-albedo means nothing with --scattering single: light of the first order never comes \
                 from the ground"
                    .to_owned(),
            ));
        }
        let first = self.turbidity.first().copied().unwrap_or_default();
        let full = PrecomputeOptions::full(first);
        let usual = if self.cloud_base.is_some() { BasisCount::UNDER_CLOUDS } else { full.basis_count };
        let options = PrecomputeOptions {
            scattering,
            multiple: self.ground_albedo.map_or(full.multiple, MultipleAxes::full),
            basis_count: self.basis.map_or(usual, BasisCount::same),
            ..full
        };
        let Some(base_m) = self.cloud_base else { return Ok(options) };
        // In millionths: manifests and commands show it.
        let rounded = |albedo: f64| (1e6 * albedo).round() / 1e6;
        let by_depth = self.cloud_optical_depth.map(CloudBase::albedo_of).map(rounded);
        let albedo = self.cloud_albedo.or(by_depth).unwrap_or(CloudBase::DEFAULT_ALBEDO);
        Ok(options.under(Clouds::new(base_m, albedo).map_err(|error| Failure::Usage(error.to_string()))?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use skyglow_physics::multiple_scattering::DEFAULT_GROUND_ALBEDO;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        precompute: Precompute,
    }

    fn options(arguments: &[&str]) -> Result<PrecomputeOptions, Failure> {
        let line = Line::try_parse_from([&["precompute", "--turbidity", "3"], arguments].concat());
        line.map_err(Failure::work)?.precompute.options()
    }

    /// All orders over the usual ground are what is made when nobody says.
    #[test]
    fn the_default_is_all_orders_over_usual_ground() {
        let default = options(&[]).unwrap();
        let full = PrecomputeOptions::full(Turbidity::new(3.0).unwrap());
        let wanted = PrecomputeOptions { scattering: Scattering::Multiple, ..full };
        assert_eq!(default, wanted);
        assert_eq!(default.multiple.ground_albedo, DEFAULT_GROUND_ALBEDO);
        let help = Line::command_help();
        assert!(help.contains(&format!("[default: {DEFAULT_GROUND_ALBEDO}]")), "{help}");
        assert_eq!(options(&["--scattering", "single"]).unwrap().scattering, Scattering::Single);
        assert_eq!(options(&["--ground-albedo", "0.8"]).unwrap().multiple.ground_albedo, 0.8);
    }

    /// An albedo is a share and belongs to multiple scattering.
    #[test]
    fn an_albedo_belongs_to_multiple_scattering() {
        for wrong in ["1.01", "-0.1", "NaN", "white"] {
            let refused = options(&["--ground-albedo", wrong]).unwrap_err().to_string();
            assert!(refused.contains("ground-albedo"), "{refused}");
        }
        let refused = options(&["--scattering", "single", "--ground-albedo", "0.15"]).unwrap_err();
        assert!(matches!(refused, Failure::Usage(_)), "{refused}");
        assert!(options(&["--scattering", "double"]).is_err());
    }

    /// Clouds have a base in range and an albedo that is nothing without them.
    #[test]
    fn clouds_have_a_base_in_range_and_an_albedo() {
        let clouds = |arguments: &[&str]| options(arguments).unwrap().clouds;
        assert_eq!(clouds(&[]), None);
        assert_eq!(clouds(&["--cloud-base", "1500"]), Clouds::new(1_500, 0.5).ok());
        assert_eq!(clouds(&["--cloud-base", "800", "--cloud-albedo", "0.7"]), Clouds::new(800, 0.7).ok());
        let by_depth = clouds(&["--cloud-base", "800", "--cloud-optical-depth", "20"]).map(Clouds::albedo);
        assert_eq!(by_depth, Some(0.6));
        assert!(
            options(&["--cloud-base", "800", "--cloud-optical-depth", "20", "--cloud-albedo", "0.6"])
                .is_err()
        );
        for wrong in [
            ["--cloud-optical-depth", "20"],
            ["--cloud-base", "150"],
            ["--cloud-base", "1500.5"],
            ["--cloud-albedo", "0.7"],
        ] {
            let refused = options(&wrong).unwrap_err().to_string();
            assert!(refused.contains("cloud"), "{refused}");
        }
        let below = options(&["--cloud-base", "1000"]).unwrap();
        assert!(below.multiple.ground_altitude_m.iter().all(|&ground_m| ground_m <= 900.0));
    }

    /// Both parts unless one is asked for; beams come through clear air alone.
    #[test]
    fn one_part_alone_can_be_made() {
        let celestial = |arguments: &[&str]| {
            let line =
                Line::try_parse_from([&["precompute", "--turbidity", "3"], arguments].concat()).unwrap();
            line.precompute.celestial_options(&line.precompute.options()?)
        };
        assert_eq!(celestial(&[]).unwrap(), Some(CelestialOptions::default()));
        assert_eq!(celestial(&["--part", "lamps"]).unwrap(), None);
        assert_eq!(celestial(&["--scattering", "single"]).unwrap(), None);
        assert_eq!(celestial(&["--cloud-base", "1500"]).unwrap(), None);
        let snow = celestial(&["--part", "celestial", "--ground-albedo", "0.8"]).unwrap().unwrap();
        assert_eq!(snow.ground_albedo, 0.8);
        assert!(celestial(&["--part", "celestial", "--cloud-base", "1500"]).is_err());
    }

    impl Line {
        fn command_help() -> String {
            <Self as clap::CommandFactory>::command().render_long_help().to_string()
        }
    }
}
