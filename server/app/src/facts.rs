//! What is fixed after the start: the device, and what is resident by the clouds and the orders of scattering of the packs.

use skyglow_observatory::SkyRequest;
use skyglow_tables::{Clouds, Scattering};

/// The packs of one scattering under one sky, as far as a request must know them.
#[derive(Clone, Debug, PartialEq)]
pub struct KindFacts {
    /// The layer of cloud; None under a clear sky.
    pub clouds: Option<Clouds>,
    /// Orders of scattering.
    pub scattering: Scattering,
    /// Smallest and largest turbidity resident.
    pub turbidity_range: (f64, f64),
    /// Spans in between, without their ends, that are not served for want of a pack that is left out.
    pub unserved: Vec<(f64, f64)>,
    /// Most basis functions resident.
    pub basis_count: usize,
    /// Lambertian albedo of the ground that light is scattered back from; None where scattering is single.
    pub ground_albedo: Option<f64>,
    /// Why sources behind skylines count as under an open sky; None where they do not.
    pub why_open: Option<&'static str>,
    /// Checksums of these packs, one after another.
    pub checksums: String,
}

impl KindFacts {
    /// What makes the pack under clouds that a turbidity needs; None under a clear sky, where the range is as wide as the model's.
    pub fn missing_turbidity(&self, turbidity: f64) -> Option<String> {
        let base_m = self.cloud_base_m()?;
        Some(format!(
            "is out of range: `skyglow precompute --turbidity {turbidity} --cloud-base {base_m}` makes a pack for it"
        ))
    }

    /// Whether a turbidity is served.
    pub fn serves(&self, turbidity: f64) -> bool {
        let (least, most) = self.turbidity_range;
        let is_inside = |&(from, to): &(f64, f64)| from < turbidity && turbidity < to;
        (least..=most).contains(&turbidity) && !self.unserved.iter().any(is_inside)
    }

    /// The turbidities that are served, in words.
    pub fn turbidities(&self) -> String {
        let (mut from, most) = self.turbidity_range;
        let mut spans = Vec::new();
        let ends = self.unserved.iter().copied().chain([(most, most)]);
        for (to, next) in ends {
            spans.push(if from < to || self.unserved.is_empty() {
                format!("{from} to {to}")
            } else {
                to.to_string()
            });
            from = next;
        }
        spans.join(", ")
    }

    /// Base of the layer of cloud above sea level, metres; None under a clear sky.
    pub fn cloud_base_m(&self) -> Option<u32> {
        self.clouds.map(Clouds::base_m)
    }
}

/// What is left out because it is damaged.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// File names of packs.
    pub packs: Vec<String>,
    /// Ids of scenes.
    pub scenes: Vec<String>,
    /// Whether no scene is left.
    pub no_scene_left: bool,
}

/// What is fixed after the start.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFacts {
    /// `gpu`, `lavapipe` or `cpu`.
    pub executor: String,
    /// Name of the device.
    pub adapter: String,
    /// Places of a map of the zenith's brightness at most.
    pub max_places: usize,
    /// The packs resident, those of a clear sky first, under each sky by scattering, the best last; one at least.
    pub kinds: Vec<KindFacts>,
    /// Albedo of the base of clouds at whatever altitude, where no packs are needed; None where packs decide.
    pub any_cloud_albedo: Option<f64>,
    /// Lowest and highest observer altitude resident, metres.
    pub altitude_range_m: (f64, f64),
    /// Smallest and largest turbidity of the resident celestial tables, which the natural sky of a time needs; None without any.
    pub celestial_turbidity_range: Option<(f64, f64)>,
    /// Altitude of an observer, m, above which the natural sky is that of this altitude: the highest of those tables; None without any.
    pub celestial_highest_m: Option<f64>,
    /// Checksums of all resident packs and celestial tables, one after another; part of every ETag.
    pub pack_checksums: String,
}

impl SourceFacts {
    /// The packs under a sky, by scattering, the best last.
    pub fn kinds_under(&self, cloud_base_m: Option<u32>) -> impl DoubleEndedIterator<Item = &KindFacts> {
        let any = self.any_cloud_albedo.is_some();
        self.kinds.iter().filter(move |kind| any || kind.cloud_base_m() == cloud_base_m)
    }

    /// The packs that serve a request which names no scattering; None where nothing is resident.
    pub fn best_kind(&self, cloud_base_m: Option<u32>) -> Option<&KindFacts> {
        self.kinds_under(cloud_base_m).next_back()
    }

    /// The packs that serve a request, where there are any.
    pub fn kind(&self, request: &SkyRequest) -> Option<&KindFacts> {
        self.kinds_under(request.cloud_base_m).find(|kind| kind.scattering == request.scattering)
    }

    /// Albedo of the base of a request's clouds; None under a clear sky.
    pub fn cloud_albedo(&self, request: &SkyRequest) -> Option<f64> {
        request.cloud_base_m?;
        self.any_cloud_albedo.or_else(|| Some(self.kind(request)?.clouds?.albedo()))
    }

    /// What is allowed with some packs, named only where others would allow something else.
    pub fn allowed_with(&self, kind: &KindFacts, allowed: String) -> String {
        let scattering = kind.scattering.name();
        match (self.kinds.len(), kind.cloud_base_m()) {
            (0 | 1, _) => allowed,
            (_, None) => format!("{allowed} with {scattering} scattering"),
            (_, Some(base_m)) => format!("{allowed} with {scattering} scattering under clouds at {base_m} m"),
        }
    }

    /// The names of every scattering resident under a sky.
    pub fn scatterings(&self, cloud_base_m: Option<u32>) -> String {
        self.kinds_under(cloud_base_m).map(|kind| kind.scattering.name()).collect::<Vec<_>>().join(", ")
    }

    /// What may be asked for in the place of clouds that there are no packs for, and what makes those.
    pub fn allowed_clouds(&self, base_m: u32) -> String {
        let bases_m = self.cloud_bases_m().iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
        if bases_m.is_empty() {
            format!(
                "none: no packs under clouds are resident; `skyglow precompute --turbidity 2.5 --cloud-base {base_m}` \
                 makes one"
            )
        } else {
            format!(
                "none, {bases_m}; `skyglow precompute --turbidity 2.5 --cloud-base {base_m}` makes a pack for this base"
            )
        }
    }

    /// Bases of the layers of cloud that there are packs for, metres, ascending.
    pub fn cloud_bases_m(&self) -> Vec<u32> {
        let mut bases_m: Vec<u32> = self.kinds.iter().filter_map(KindFacts::cloud_base_m).collect();
        bases_m.sort_unstable();
        bases_m.dedup();
        bases_m
    }
}
