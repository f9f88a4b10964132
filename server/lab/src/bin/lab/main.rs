//! Programs that measure: each subcommand computes reference solutions, judges by them, or times a part of the program.

mod accuracy;
mod against_reference;
mod arguments;
mod beams;
mod blocked_accuracy;
mod brightness;
mod class_accuracy;
mod class_reference;
mod cloud_bodies;
mod field_noise;
mod field_resolution;
mod hidden_lights;
mod influence_reference;
mod influence_times;
mod lamps;
mod latency;
mod multiple_accuracy;
mod multiple_vs_monte_carlo;
mod night_times;
mod offset_interpolation;
mod pass_times;
mod pictures;
mod place_reference;
mod plan_reference;
mod planet;
mod published_beams;
mod reference;
mod reference_multiple;
mod scene_times;
mod seeds;
mod slopes;
mod spectra;
mod speed;
mod tolerance;

use arguments::Outcome;
use clap::{Parser, Subcommand};

/// Programs that measure Skyglow: reference solutions, errors against them, times.
#[derive(Debug, Parser)]
#[command(name = "lab", allow_negative_numbers = true)]
struct Lab {
    #[command(subcommand)]
    program: Program,
}

#[derive(Debug, Subcommand)]
#[command(allow_negative_numbers = true)]
enum Program {
    Reference(reference::Arguments),
    ReferenceMultiple(reference_multiple::Arguments),
    ClassReference(class_reference::Arguments),
    PlaceReference(place_reference::Arguments),
    Accuracy(accuracy::Arguments),
    AgainstReference(against_reference::Arguments),
    ClassAccuracy(class_accuracy::Arguments),
    HiddenLights(hidden_lights::Arguments),
    BlockedAccuracy(blocked_accuracy::Arguments),
    MultipleAccuracy(multiple_accuracy::Arguments),
    OffsetInterpolation(offset_interpolation::Arguments),
    FieldResolution(field_resolution::Arguments),
    FieldNoise(field_noise::Arguments),
    MultipleVsMonteCarlo(multiple_vs_monte_carlo::Arguments),
    Beams(beams::Arguments),
    CloudBodies(cloud_bodies::Arguments),
    PublishedBeams(published_beams::Arguments),
    Lamps(lamps::Arguments),
    Spectra(spectra::Arguments),
    Brightness(brightness::Arguments),
    InfluenceReference(influence_reference::Arguments),
    PlanReference(plan_reference::Arguments),
    Speed(speed::Arguments),
    Tolerance(tolerance::Arguments),
    PassTimes(pass_times::Arguments),
    SceneTimes(scene_times::Arguments),
    InfluenceTimes(influence_times::Arguments),
    Latency(latency::Arguments),
    NightTimes(night_times::Arguments),
    Pictures(pictures::Arguments),
    Planet(planet::Arguments),
    Slopes(slopes::Arguments),
    /// Writes what fuzzers start from where the program makes it: the smallest pack and the smallest raster.
    Seeds,
}

fn main() -> Outcome {
    match Lab::parse().program {
        Program::Reference(arguments) => reference::run(&arguments),
        Program::ReferenceMultiple(arguments) => reference_multiple::run(&arguments),
        Program::ClassReference(arguments) => class_reference::run(&arguments),
        Program::PlaceReference(arguments) => place_reference::run(&arguments),
        Program::Accuracy(arguments) => accuracy::run(&arguments),
        Program::AgainstReference(arguments) => against_reference::run(&arguments),
        Program::ClassAccuracy(arguments) => class_accuracy::run(&arguments),
        Program::HiddenLights(arguments) => hidden_lights::run(&arguments),
        Program::BlockedAccuracy(arguments) => blocked_accuracy::run(&arguments),
        Program::MultipleAccuracy(arguments) => multiple_accuracy::run(&arguments),
        Program::OffsetInterpolation(arguments) => offset_interpolation::run(&arguments),
        Program::FieldResolution(arguments) => field_resolution::run(&arguments),
        Program::FieldNoise(arguments) => field_noise::run(&arguments),
        Program::MultipleVsMonteCarlo(arguments) => multiple_vs_monte_carlo::run(&arguments),
        Program::Beams(arguments) => beams::run(&arguments),
        Program::CloudBodies(arguments) => cloud_bodies::run(&arguments),
        Program::PublishedBeams(arguments) => published_beams::run(&arguments),
        Program::Lamps(arguments) => lamps::run(&arguments),
        Program::Spectra(arguments) => spectra::run(&arguments),
        Program::Brightness(arguments) => brightness::run(&arguments),
        Program::InfluenceReference(arguments) => influence_reference::run(&arguments),
        Program::PlanReference(arguments) => plan_reference::run(&arguments),
        Program::Speed(arguments) => speed::run(&arguments),
        Program::Tolerance(arguments) => tolerance::run(&arguments),
        Program::PassTimes(arguments) => pass_times::run(&arguments),
        Program::SceneTimes(arguments) => scene_times::run(&arguments),
        Program::InfluenceTimes(arguments) => influence_times::run(&arguments),
        Program::Latency(arguments) => latency::run(&arguments),
        Program::NightTimes(arguments) => night_times::run(&arguments),
        Program::Pictures(arguments) => pictures::run(&arguments),
        Program::Planet(arguments) => planet::run(&arguments),
        Program::Slopes(arguments) => slopes::run(&arguments),
        Program::Seeds => seeds::run(),
    }
}
