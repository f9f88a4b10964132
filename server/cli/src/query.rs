//! The API's query parameters as flags, made from the API's own table: the two cannot differ.

use crate::failure::Failure;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches, error::ErrorKind};
use skyglow_app::{
    error::AppError,
    facts::{KindFacts, SourceFacts},
    parameters::{MAX_BASIS_FUNCTIONS, Parameter, ParameterSet},
};
use skyglow_physics::{CloudBase, Turbidity};
use skyglow_tables::{
    Clouds, Manifest, Scattering, celestial::manifest::CelestialManifest, celestial_tables_in, packs_in,
};
use std::{marker::PhantomData, path::Path};

/// The flags of a set of parameters, as a query string.
#[derive(Clone, Debug)]
pub(crate) struct QueryFlags<Set> {
    query: String,
    set: PhantomData<Set>,
}

impl<Set> QueryFlags<Set> {
    /// `name=value&…`, percent-encoded.
    pub(crate) fn query(&self) -> &str {
        &self.query
    }
}

fn flag(parameter: &Parameter) -> Arg {
    let long = parameter.name.replace('_', "-");
    let env = format!("SKYGLOW_{}", parameter.name.to_uppercase());
    let default = match parameter.default {
        "" => String::new(),
        default => format!(" [default: {default}]"),
    };
    Arg::new(parameter.name)
        .long(long)
        .env(env)
        .value_name("VALUE")
        .help(format!("{} Allowed: {}.{default}", parameter.description, parameter.allowed()))
        .required(parameter.required)
        .allow_negative_numbers(true)
        .help_heading("The sky asked for (as the API's query parameters)")
}

impl<Set: ParameterSet> Args for QueryFlags<Set> {
    fn augment_args(command: Command) -> Command {
        command.args(Set::ALL.iter().map(flag))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<Set: ParameterSet> FromArgMatches for QueryFlags<Set> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut query = form_urlencoded::Serializer::new(String::new());
        for parameter in Set::ALL {
            let value = matches
                .try_get_one::<String>(parameter.name)
                .map_err(|error| clap::Error::raw(ErrorKind::InvalidValue, error))?;
            if let Some(value) = value {
                query.append_pair(parameter.name, value);
            }
        }
        Ok(Self { query: query.finish(), set: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// What is allowed at all, whatever packs are resident: to find slips before anything is loaded.
fn widest_facts() -> SourceFacts {
    let kind = |&scattering| KindFacts {
        clouds: None,
        scattering,
        turbidity_range: (Turbidity::MINIMUM, Turbidity::MAXIMUM),
        unserved: Vec::new(),
        basis_count: MAX_BASIS_FUNCTIONS as usize,
        ground_albedo: None,
        why_open: None,
        checksums: String::new(),
    };
    SourceFacts {
        executor: "reference".to_owned(),
        adapter: String::new(),
        max_places: usize::MAX,
        kinds: Scattering::ALL.iter().map(kind).collect(),
        any_cloud_albedo: Some(CloudBase::DEFAULT_ALBEDO),
        altitude_range_m: (0.0, 100_000.0),
        celestial_turbidity_range: Some((Turbidity::MINIMUM, Turbidity::MAXIMUM)),
        celestial_highest_m: None,
        pack_checksums: String::new(),
    }
}

/// What is allowed for the reference, which needs no packs.
pub(crate) fn reference_facts(ground_albedo: f64, cloud_albedo: f64) -> SourceFacts {
    let mut facts = SourceFacts { any_cloud_albedo: Some(cloud_albedo), ..widest_facts() };
    for kind in &mut facts.kinds {
        kind.ground_albedo = (kind.scattering == Scattering::Multiple).then_some(ground_albedo);
    }
    facts
}

/// What the packs of a folder will serve, from the manifests beside them: to name the true ranges before
/// anything is loaded. The widest where there are no manifests to read; opening the packs then says why.
pub(crate) fn facts_of_packs(folder: &Path) -> SourceFacts {
    let manifests: Vec<Manifest> = packs_in(folder)
        .unwrap_or_default()
        .iter()
        .filter_map(|path| std::fs::read(path.with_extension("json")).ok())
        .filter_map(|text| serde_json::from_slice(&text).ok())
        .collect();
    let mut facts = widest_facts();
    let mut skies: Vec<Option<u32>> = manifests.iter().map(cloud_base_m).collect();
    skies.sort_unstable();
    skies.dedup();
    let kinds = |sky: &Option<u32>| -> Vec<KindFacts> {
        Scattering::ALL.iter().filter_map(|&s| kind_facts(&manifests, *sky, s)).collect()
    };
    let kinds: Vec<KindFacts> = skies.iter().flat_map(kinds).collect();
    if !kinds.is_empty() {
        facts.kinds = kinds;
        facts.any_cloud_albedo = None;
    }
    facts.celestial_turbidity_range = celestial_turbidity_range(folder);
    let highest_m = manifests.iter().filter_map(|manifest| manifest.axes.observer_altitude_m.last().copied());
    facts.altitude_range_m.1 = highest_m.reduce(f64::max).unwrap_or(facts.altitude_range_m.1);
    facts
}

/// By the manifests beside celestial tables.
fn celestial_turbidity_range(folder: &Path) -> Option<(f64, f64)> {
    let paths = celestial_tables_in(folder).unwrap_or_default();
    let turbidities = paths.iter().filter_map(|path| {
        let manifest = std::fs::read(path.with_extension("json")).ok()?;
        serde_json::from_slice::<CelestialManifest>(&manifest).ok().map(|manifest| manifest.turbidity)
    });
    turbidities.map(|turbidity| (turbidity, turbidity)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

fn cloud_base_m(manifest: &Manifest) -> Option<u32> {
    manifest.clouds.map(Clouds::base_m)
}

/// What the packs of one scattering under one sky will serve; None where there are none.
fn kind_facts(manifests: &[Manifest], sky: Option<u32>, scattering: Scattering) -> Option<KindFacts> {
    let is_one = |manifest: &&Manifest| manifest.scattering == scattering && cloud_base_m(manifest) == sky;
    let mut packs = manifests.iter().filter(is_one);
    let first = packs.next()?;
    let mut facts = KindFacts {
        clouds: first.clouds,
        scattering,
        turbidity_range: (first.turbidity, first.turbidity),
        unserved: Vec::new(),
        basis_count: first.basis_count,
        ground_albedo: first.ground_albedo,
        // No parameter asks for it; a sky says what the packs really know.
        why_open: None,
        checksums: String::new(),
    };
    for pack in packs {
        let (least, most) = facts.turbidity_range;
        facts.turbidity_range = (least.min(pack.turbidity), most.max(pack.turbidity));
        facts.basis_count = facts.basis_count.max(pack.basis_count);
    }
    Some(facts)
}

/// A refused parameter is wrong usage; anything else is work that failed.
pub(crate) fn failure(error: &AppError) -> Failure {
    let detail = error.detail();
    match error {
        AppError::Parameters(_) => Failure::Usage(detail),
        AppError::Internal { reason } => Failure::Work(reason.clone()),
        AppError::UnknownScene { id } => {
            Failure::Work(format!("there is no scene \"{id}\"; `skyglow scenes` lists those that are there"))
        }
        _ => Failure::Work(detail),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_app::{accept::Format, parameters::PanoramaParameters};
    use skyglow_tables::{
        TableAxes,
        manifest::{MeasuredError, PackParameters},
    };

    fn query(arguments: &[&str]) -> String {
        let command = QueryFlags::<PanoramaParameters>::augment_args(Command::new("test"));
        let matches = command.try_get_matches_from([&["test"], arguments].concat()).unwrap();
        QueryFlags::<PanoramaParameters>::from_arg_matches(&matches).unwrap().query
    }

    #[test]
    fn flags_become_the_query_that_the_api_would_get() {
        assert_eq!(
            query(&["--lat", "-1.3", "--lon=36.8", "--height-px", "64", "--lamp", "1,2,3"]),
            "lat=-1.3&lon=36.8&lamp=1%2C2%2C3&height_px=64"
        );
    }

    #[test]
    fn the_api_reads_what_the_flags_wrote() {
        let scene = skyglow_scene::SceneId::parse("demo").unwrap();
        let text = query(&["--lat", "-1.3", "--lon", "36.8", "--emission", "1,1,2", "--sky", "total"]);
        let (sky, view) =
            skyglow_app::request::panorama(Some(&text), scene, &widest_facts(), Format::Png).unwrap();
        assert!((sky.place.latitude_deg() + 1.3).abs() < 1e-12);
        assert_eq!(sky.emission.mix().weights(), [0.25, 0.25, 0.5]);
        assert_eq!(view.options.sky, skyglow_display::Sky::Total);
    }

    /// Manifests tell what the packs of each scattering serve.
    #[test]
    fn manifests_tell_what_packs_serve() {
        let folder = tempfile::tempdir().unwrap();
        let none = SourceFacts { celestial_turbidity_range: None, ..widest_facts() };
        assert_eq!(facts_of_packs(folder.path()), none);
        let (single, multiple) = (Scattering::Single, Scattering::Multiple);
        for (turbidity, scattering, basis_count) in [
            (4.0, multiple, 32),
            (1.5, single, 64),
            (2.0, multiple, 16),
            (6.0, single, 64),
            (3.0, multiple, 16),
        ] {
            let parameters = PackParameters {
                turbidity,
                clouds: (turbidity == 3.0).then(|| Clouds::new(1_000, 0.6).unwrap()),
                scattering,
                multiple: (scattering == multiple).then(|| skyglow_tables::MultipleAxes::coarse(0.2)),
                axes: if turbidity == 3.0 {
                    TableAxes::coarse().below(Clouds::new(1_000, 0.6).unwrap())
                } else {
                    TableAxes::coarse()
                },
                basis_count,
                training_geometries: 1,
                fit_iterations: 1,
                blocked: None,
                fit: skyglow_tables::fit_constants::FitConstants::current(),
            };
            let manifest = parameters.manifest(MeasuredError::default(), String::new());
            let pack = folder.path().join(format!("{turbidity}-{}.skyglow", scattering.name()));
            std::fs::write(&pack, "").unwrap();
            std::fs::write(pack.with_extension("json"), serde_json::to_vec(&manifest).unwrap()).unwrap();
        }
        let kind = |scattering, turbidity_range, basis_count, ground_albedo| KindFacts {
            clouds: None,
            scattering,
            turbidity_range,
            unserved: Vec::new(),
            basis_count,
            ground_albedo,
            why_open: None,
            checksums: String::new(),
        };
        let facts = facts_of_packs(folder.path());
        // Packs under clouds end below them, and keep nobody under a clear sky from standing higher.
        assert_eq!(facts.altitude_range_m, (0.0, 6_000.0));
        assert_eq!(
            facts.kinds,
            [
                kind(single, (1.5, 6.0), 64, None),
                kind(multiple, (2.0, 4.0), 32, Some(0.2)),
                KindFacts {
                    clouds: Clouds::new(1_000, 0.6).ok(),
                    ..kind(multiple, (3.0, 3.0), 16, Some(0.2))
                },
            ]
        );
    }
}
