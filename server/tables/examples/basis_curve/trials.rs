//! What is tried with a basis beside its size.

use half::f16;
use skyglow_physics::single_source::SourceGeometry;
use skyglow_tables::{
    MultipleTable, PrecomputeOptions,
    fit::{Basis, Projector},
    precompute::basis_alone,
};
use std::error::Error;

/// How coefficients are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Storage {
    /// Single precision.
    Single,
    /// Half precision, as in packs.
    Half,
    /// Whole numbers from -127 to 127 times a factor of the node's own.
    EightBit,
}

/// The choices of a run.
#[derive(Clone, Debug)]
pub(crate) struct Trial {
    storage: Storage,
    training_geometries: Option<usize>,
    split_m: Option<f64>,
    by_altitude: bool,
}

impl Trial {
    /// From the arguments after the sizes.
    pub(crate) fn of(arguments: &[String]) -> Result<Self, Box<dyn Error>> {
        let mut trial =
            Self { storage: Storage::Half, training_geometries: None, split_m: None, by_altitude: false };
        for argument in arguments {
            match argument.split_once('=') {
                Some(("store", "f32")) => trial.storage = Storage::Single,
                Some(("store", "f16")) => trial.storage = Storage::Half,
                Some(("store", "8bit")) => trial.storage = Storage::EightBit,
                Some(("train", count)) => trial.training_geometries = Some(count.parse()?),
                Some(("split", distance_m)) => trial.split_m = Some(distance_m.parse()?),
                None if argument == "altitudes" => trial.by_altitude = true,
                _ => return Err(format!("what is {argument}?").into()),
            }
        }
        Ok(trial)
    }

    /// The options of a pack with this trial's training set.
    pub(crate) fn options(&self, mut options: PrecomputeOptions) -> PrecomputeOptions {
        options.training_geometries = self.training_geometries.unwrap_or(options.training_geometries);
        options
    }

    /// Coefficients of one node as they come back from storage.
    pub(crate) fn stored(&self, coefficients: &[f64]) -> Vec<f32> {
        let largest = coefficients.iter().fold(f64::MIN_POSITIVE, |most, c| most.max(c.abs()));
        let stored = |&c: &f64| match self.storage {
            Storage::Single => c as f32,
            Storage::Half => f16::from_f64(c).to_f32(),
            Storage::EightBit => ((c / largest * 127.0).round() * largest / 127.0) as f32,
        };
        coefficients.iter().map(stored).collect()
    }
}

/// One basis, or one for each part of the sources.
pub(crate) struct Bases {
    parts: Vec<Part>,
}

struct Part {
    /// Distances and observer altitudes, metres, from the first up to the second.
    distance_m: [f64; 2],
    observer_altitude_m: [f64; 2],
    basis: Basis,
    projector: Projector,
}

impl Bases {
    /// Fits them, and says how long that took.
    pub(crate) fn fit(
        trial: &Trial,
        options: &PrecomputeOptions,
        multiple: &[MultipleTable],
    ) -> Result<Self, Box<dyn Error>> {
        let started = std::time::Instant::now();
        let split_m = trial.split_m;
        let distances_m: Vec<[f64; 2]> = split_m
            .map_or(vec![[0.0, f64::INFINITY]], |split_m| vec![[0.0, split_m], [split_m, f64::INFINITY]]);
        let altitudes_m: Vec<[f64; 2]> = if trial.by_altitude {
            options.axes.observer_altitude_m.windows(2).map(|pair| [pair[0], pair[1]]).collect()
        } else {
            vec![[f64::NEG_INFINITY, f64::INFINITY]]
        };
        let mut parts = Vec::new();
        for distance_m in distances_m {
            for &observer_altitude_m in &altitudes_m {
                let mut options = options.clone();
                // Parts share the samples at their borders, so that what lies between is within either.
                let within = |[low, high]: [f64; 2], slack: f64| {
                    move |value: &f64| *value >= low / slack && *value <= high * slack
                };
                options.axes.distance_m.retain(within(distance_m, 1.15));
                options.axes.observer_altitude_m.retain(within(observer_altitude_m, 1.0));
                let basis = basis_alone(&options, multiple)?;
                let projector = Projector::new(&basis);
                parts.push(Part { distance_m, observer_altitude_m, basis, projector });
            }
        }
        let seconds = started.elapsed().as_secs_f64();
        println!(
            "# {} functions, {} bases fitted in {seconds:.0} s",
            options.basis_count.at(options.turbidity),
            parts.len()
        );
        Ok(Self { parts })
    }

    /// Functions of each.
    pub(crate) fn function_count(&self) -> usize {
        self.parts[0].basis.count
    }

    /// The one for a source; the last for one beyond all.
    pub(crate) fn of(&self, geometry: &SourceGeometry) -> (&Basis, &Projector) {
        let last = self.parts.len() - 1;
        let holds = |part: &&Part| {
            geometry.distance_m < part.distance_m[1]
                && geometry.observer_altitude_m < part.observer_altitude_m[1]
        };
        let part = self.parts.iter().find(holds).unwrap_or(&self.parts[last]);
        (&part.basis, &part.projector)
    }
}
