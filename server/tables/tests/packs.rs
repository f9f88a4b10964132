//! Packs as files: made, killed and resumed, the same bytes every time, refused when damaged.

#![expect(clippy::unwrap_used, reason = "a test that cannot set itself up must stop")]

use skyglow_physics::{Atmosphere, Band, LOBE_COUNT, Turbidity};
use skyglow_tables::{
    BasisCount, Clouds, MultipleAxes, NoProgress, Pack, PrecomputeOptions, Progress, Scattering, TablesError,
    images::images_of, layout::image_index, packs_in, precompute, precompute_together,
};
use std::{
    path::{Path, PathBuf},
    sync::{
        LazyLock,
        atomic::{AtomicU64, Ordering},
    },
};

fn options() -> PrecomputeOptions {
    PrecomputeOptions::coarse(Turbidity::new(2.0).unwrap())
}

fn all_orders() -> PrecomputeOptions {
    let multiple = MultipleAxes::coarse(0.3);
    PrecomputeOptions { scattering: Scattering::Multiple, multiple, ..options() }
}

fn without_skylines() -> PrecomputeOptions {
    PrecomputeOptions { blocked: None, ..options() }
}

/// A pack made once for all tests, with its manifest.
struct Made {
    name: String,
    pack: Vec<u8>,
    manifest: Vec<u8>,
}

impl Made {
    fn by(options: &PrecomputeOptions) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = precompute(options, folder.path(), &NoProgress).unwrap();
        let manifest = std::fs::read(path.with_extension("json")).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        Self { name, pack: std::fs::read(&path).unwrap(), manifest }
    }

    /// Both files in a folder; the pack's path.
    fn place(&self, folder: &Path) -> PathBuf {
        let path = folder.join(&self.name);
        std::fs::write(&path, &self.pack).unwrap();
        std::fs::write(path.with_extension("json"), &self.manifest).unwrap();
        path
    }
}

static FIRST_ORDER: LazyLock<Made> = LazyLock::new(|| Made::by(&options()));
static ALL_ORDERS: LazyLock<Made> = LazyLock::new(|| Made::by(&all_orders()));
static WITHOUT_SKYLINES: LazyLock<Made> = LazyLock::new(|| Made::by(&without_skylines()));

fn place(folder: &Path, bytes: &[u8]) -> PathBuf {
    let path = folder.join("turbidity-2.00-single.skyglow");
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn a_pack_reads_back_and_says_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = FIRST_ORDER.place(folder.path());
    assert_eq!(packs_in(folder.path()).unwrap(), vec![path.clone()]);
    let pack = Pack::open(&path).unwrap();
    assert_eq!(pack.manifest().turbidity, 2.0);
    assert_eq!(pack.manifest().bands_nm, Band::ALL.map(Band::wavelength_nm));
    assert_eq!(pack.manifest().measured_error.lobes.len(), LOBE_COUNT);
    assert!(pack.manifest().measured_error.lobes[0].samples > 100);
    let rings = [250.0, 1_000.0, 77_000.0, 300_000.0];
    let tables = pack.resident(&rings);
    assert_eq!(tables.log_scale.len() * tables.basis_count, tables.shape.len());
    // On the first and last sample distance the resident tables are the pack's own.
    let farther = tables.scale_index(0, 0, 1, 3, 2);
    let nearer = tables.scale_index(0, 0, 1, 0, 2);
    assert!(tables.log_scale[nearer] > tables.log_scale[farther] + 5.0);
}

/// Panics after some steps, as a kill would stop the work.
struct StopAfter(AtomicU64, u64);

impl Progress for StopAfter {
    fn begin(&self, _stage: &str, _steps: u64) {}
    fn advance(&self, steps: u64) {
        assert!(self.0.fetch_add(steps, Ordering::SeqCst) < self.1, "stopped on purpose");
    }
}

/// A killed run resumes and ends with the same bytes on any number of threads.
#[test]
fn a_killed_run_resumes_with_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    // 12 training images + 2 fit steps, then some of the 20 parts.
    let stopped =
        std::panic::catch_unwind(|| precompute(&options(), folder.path(), &StopAfter(AtomicU64::new(0), 22)));
    assert!(stopped.is_err());
    let partial = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|extension| extension == "partial"))
        .unwrap();
    let parts = || {
        std::fs::read_dir(&partial)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.starts_with("part-") && !name.ends_with(".tmp"))
            .count()
    };
    let kept = parts();
    assert!(kept >= 4, "{kept} parts kept");
    // A damaged part is made again.
    let damaged = std::fs::read_dir(&partial)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| path.file_name().unwrap().to_str().unwrap().starts_with("part-"))
        .unwrap();
    std::fs::write(&damaged, b"damaged").unwrap();
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let path = single.install(|| precompute(&options(), folder.path(), &NoProgress)).unwrap();
    assert!(std::fs::read(&path).unwrap() == FIRST_ORDER.pack, "the packs differ");
    assert!(!partial.exists());
}

/// Packs made together are those made alone, and clean air may have more functions.
#[test]
fn packs_made_together_equal_those_made_alone() {
    let options =
        PrecomputeOptions { basis_count: BasisCount { clean: 16, hazy: 12 }, error_sources: 1, ..options() };
    let [clean, hazy] = [2.0, 2.5].map(|turbidity| Turbidity::new(turbidity).unwrap());
    let [together, alone] = std::array::from_fn(|_| tempfile::tempdir().unwrap());
    let paths = precompute_together(&[hazy, clean], &options, together.path(), &NoProgress).unwrap();
    let counts: Vec<usize> =
        paths.iter().map(|path| Pack::open(path).unwrap().manifest().basis_count).collect();
    assert_eq!(counts, [16, 12]);
    for (path, turbidity) in paths.iter().zip([clean, hazy]) {
        let other =
            precompute(&PrecomputeOptions { turbidity, ..options.clone() }, alone.path(), &NoProgress)
                .unwrap();
        assert!(std::fs::read(path).unwrap() == std::fs::read(other).unwrap(), "{turbidity:?} differs");
    }
}

/// A training set too small for its functions is refused instead of written.
#[test]
fn too_small_a_training_set_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let options =
        PrecomputeOptions { basis_count: BasisCount::same(64), training_geometries: 11, ..options() };
    let refused = precompute(&options, folder.path(), &NoProgress).unwrap_err();
    assert!(refused.to_string().contains("beyond half precision"), "{refused}");
    assert_eq!(packs_in(folder.path()).unwrap(), Vec::<PathBuf>::new());
}

/// A pack of all orders is brighter than the first alone and states its ground albedo.
#[test]
fn all_orders_are_brighter_than_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = ALL_ORDERS.place(folder.path());
    assert!(path.ends_with("turbidity-2.00-multiple.skyglow"));
    let pack = Pack::open(&path).unwrap();
    assert_eq!(pack.manifest().scattering, Scattering::Multiple);
    assert_eq!(pack.manifest().ground_albedo, Some(0.3));
    assert!(pack.manifest().command.contains("--scattering multiple --ground-albedo 0.3"));
    // Interpolated light of later orders is in the f64 oracle that errors are measured against, too.
    assert!(pack.manifest().measured_error.lobes[0].median < 0.5);
    let alone = Pack::open(&FIRST_ORDER.place(folder.path())).unwrap();
    assert_eq!(alone.manifest().ground_albedo, None);
    let rings = [1_000.0, 30_000.0, 200_000.0];
    let (all, first) = (pack.resident(&rings), alone.resident(&rings));
    // The farther the source, the more of its light has turned more than once.
    let factor = |ring: usize| {
        let node = all.scale_index(0, 0, 1, ring, 2);
        f64::from(all.log_scale[node] - first.log_scale[node]).exp()
    };
    assert!(factor(0) > 1.02 && factor(1) > factor(0) && factor(2) > factor(1), "{}", factor(0));
}

fn refusal(bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    match Pack::open(&place(folder.path(), bytes)) {
        Err(error @ TablesError::Refused { .. }) => error.to_string(),
        other => panic!("not refused: {:?}", other.map(|pack| pack.manifest().turbidity)),
    }
}

/// Truncated, altered and foreign packs are refused by name.
#[test]
fn damaged_and_foreign_packs_are_refused() {
    let pack = &FIRST_ORDER.pack;
    for length in [0, 5, 40, pack.len() / 2, pack.len() - 1] {
        assert!(refusal(&pack[..length]).contains("turbidity-2.00-single.skyglow"));
    }
    for position in [9, 600, pack.len() / 2, pack.len() - 3] {
        let mut altered = pack.clone();
        altered[position] ^= 0x10;
        assert!(refusal(&altered).contains("truncated or altered"));
    }
    assert!(
        refusal(b"GIF89a, and then some more bytes to be long enough for a header")
            .contains("not a skyglow pack")
    );
}

/// A manifest beside a pack that is not its own is refused.
#[test]
fn a_manifest_of_another_pack_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = FIRST_ORDER.place(folder.path());
    let other = String::from_utf8(FIRST_ORDER.manifest.clone())
        .unwrap()
        .replace("\"turbidity\": 2.0", "\"turbidity\": 3.0");
    std::fs::write(path.with_extension("json"), other).unwrap();
    assert!(Pack::open(&path).unwrap_err().to_string().contains("another pack"));
}

/// A turbidity that would take another's file name is refused before any work.
#[test]
fn turbidities_of_three_decimals_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error =
        precompute(&PrecomputeOptions::coarse(Turbidity::new(2.004).unwrap()), folder.path(), &NoProgress)
            .unwrap_err()
            .to_string();
    assert!(error.contains("2.004") && error.contains("two decimals"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A pack without skylines states null, and one with them comes back bit for bit.
#[test]
fn skyline_tables_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let path = WITHOUT_SKYLINES.place(folder.path());
    let text = std::fs::read_to_string(path.with_extension("json")).unwrap();
    assert!(text.contains("\"blocked\": null"));
    assert!(Pack::open(&path).unwrap().resident(&[1_000.0]).blocked.is_none());
    let other = tempfile::tempdir().unwrap();
    let with = Pack::open(&FIRST_ORDER.place(other.path())).unwrap();
    assert_eq!(with.manifest().blocked.as_ref().unwrap().later, None);
    let again = with.write(other.path());
    assert!(std::fs::read(again.unwrap()).unwrap() == FIRST_ORDER.pack);
    let tables = with.resident(&[1_000.0, 40_000.0]);
    let blocked = tables.blocked.as_ref().unwrap();
    assert_eq!((blocked.offset_axis.len(), blocked.offset_axis[0].len()), (7, 2));
    assert_eq!(blocked.observer_altitude_m, tables.observer_altitude_m);
    assert!(blocked.log_scale.iter().all(|value| value.is_finite()));
}

#[test]
fn a_killed_run_goes_on_among_the_skylines_too() {
    let folder = tempfile::tempdir().unwrap();
    // 4 fields, 12 training images, 2 fit steps, 20 parts and 4 sources come first.
    let stopped = std::panic::catch_unwind(|| {
        precompute(&all_orders(), folder.path(), &StopAfter(AtomicU64::new(0), 4 + 12 + 2 + 20 + 4 + 5))
    });
    assert!(stopped.is_err());
    let kept = |prefix: &str| {
        let partial = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .find(|path| path.extension().is_some_and(|extension| extension == "partial"))
            .unwrap();
        std::fs::read_dir(partial)
            .unwrap()
            .filter(|entry| entry.as_ref().unwrap().file_name().to_str().unwrap().starts_with(prefix))
            .count()
    };
    assert!(kept("later-") >= 4, "{} parts kept", kept("later-"));
    let path = precompute(&all_orders(), folder.path(), &NoProgress).unwrap();
    assert!(std::fs::read(path).unwrap() == ALL_ORDERS.pack, "the packs differ");
}

/// A pack under clouds contains the light that they reflect and ends below them.
#[test]
fn a_cloud_pack_ends_below_its_clouds() {
    let turbidity = Turbidity::new(2.0).unwrap();
    let clouds = Clouds::new(1_500, 0.6).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let clear = Pack::open(&WITHOUT_SKYLINES.place(folder.path())).unwrap();
    let overcast = without_skylines().under(clouds);
    let path = precompute(&overcast, folder.path(), &NoProgress).unwrap();
    assert_eq!(path.file_name().unwrap(), "turbidity-2.00-single-clouds-1500.skyglow");
    let pack = Pack::open(&path).unwrap();
    assert_eq!((pack.manifest().clouds, clear.manifest().clouds), (Some(clouds), None));
    let command = &pack.manifest().command;
    assert!(command.contains(" --cloud-base 1500 --cloud-albedo 0.6 "), "{command}");

    let axes = &overcast.axes;
    assert_eq!(axes.observer_altitude_m, [0.0, clouds.ceiling_m()]);
    let (observer, distance, offset) = (0, 3, 1);
    let air = Atmosphere::new(turbidity);
    let scale = |cloud| {
        images_of(&[air.under(cloud)], &[], &axes.geometry(observer, distance, offset, cloud))[0].log_scale
    };
    let (closed, open) = (scale(Some(clouds.base())), scale(None));
    let image = image_index(0, 1);
    assert!(closed[image] > open[image] + 0.3, "{} {}", closed[image], open[image]);
    let kept = |pack: &Pack, observer| {
        let tables = pack.resident(&axes.distance_m);
        f64::from(tables.log_scale[tables.scale_index(observer, 0, 1, distance, offset)])
    };
    assert!((kept(&pack, observer) - closed[image]).abs() < 1e-5);
    assert!((kept(&clear, observer) - open[image]).abs() < 1e-5);
    // A source above the clouds counts as the highest below them.
    let highest = axes.offset_count - 1;
    assert!(axes.geometry(1, distance, highest, None).source_altitude_m > f64::from(clouds.base_m()));
    let geometry = axes.geometry(1, distance, highest, Some(clouds.base()));
    assert_eq!(
        (geometry.observer_altitude_m, geometry.source_altitude_m),
        (clouds.ceiling_m(), clouds.ceiling_m())
    );
    let held = images_of(&[air.under(Some(clouds.base()))], &[], &geometry)[0].log_scale;
    let tables = pack.resident(&axes.distance_m);
    let kept_m = f64::from(tables.log_scale[tables.scale_index(1, 0, 1, distance, highest)]);
    assert!((kept_m - held[image]).abs() < 1e-5);
}
