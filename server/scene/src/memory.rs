//! How much memory there is, by the control group and the machine, and how much a scene takes.

use crate::light_pyramid::Block;
use crate::skylines::Skyline;
use std::path::{Path, PathBuf};

/// Where the system says how much memory there is.
const PROC: &str = "/proc";
/// Where control groups are mounted.
const GROUPS: &str = "/sys/fs/cgroup";

/// Bytes of memory that this process and those beside it may take in all: the least of the machine's, of the control groups' that it
/// is in, and of its address space. None where nobody says.
pub fn memory_limit_bytes() -> Option<u64> {
    let machine = field(&Path::new(PROC).join("meminfo"), "MemTotal:");
    let groups = groups(Path::new(PROC), Path::new(GROUPS));
    let space = rustix::process::getrlimit(rustix::process::Resource::As).current;
    groups.iter().map(|group| group.most).chain(machine).chain(space).min()
}

/// Bytes that can still be had; None where nobody says.
pub fn available_bytes() -> Option<u64> {
    let machine = field(&Path::new(PROC).join("meminfo"), "MemAvailable:");
    let groups = groups(Path::new(PROC), Path::new(GROUPS));
    let space = rustix::process::getrlimit(rustix::process::Resource::As).current;
    let taken = field(&Path::new(PROC).join("self/status"), "VmSize:").unwrap_or(0);
    let space = space.map(|most| most.saturating_sub(taken));
    groups.iter().map(Group::left).chain(machine).chain(space).min()
}

/// The field of a file of lines such as `MemTotal:  123 kB`, bytes.
fn field(path: &Path, name: &str) -> Option<u64> {
    let text = std::fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}

/// A control group that limits memory.
#[derive(Debug, PartialEq)]
struct Group {
    most: u64,
    used: u64,
    /// What files hold in the cache: it is given back when it is wanted.
    cached: u64,
}

impl Group {
    fn left(&self) -> u64 {
        self.most.saturating_sub(self.used.saturating_sub(self.cached))
    }

    /// * `names`: of the files that say how much may be, and is, taken, and of the line of cached files.
    fn read(folder: &Path, names: [&str; 3]) -> Option<Self> {
        let number = |name: &str| std::fs::read_to_string(folder.join(name)).ok()?.trim().parse::<u64>().ok();
        let statistics = std::fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
        let cached = statistics.lines().find_map(|line| line.strip_prefix(names[2])?.trim().parse().ok());
        Some(Self {
            most: number(names[0])?,
            used: number(names[1]).unwrap_or(0),
            cached: cached.unwrap_or(0),
        })
    }
}

/// The control groups that this process is in, from its own to the highest that can be seen, of version 2 and 1: those with a limit.
/// Inside a container its own is the highest, whatever path it has outside.
fn groups(proc: &Path, mount: &Path) -> Vec<Group> {
    let paths = std::fs::read_to_string(proc.join("self/cgroup")).unwrap_or_default();
    let own = |controller: &str| {
        let mut lines = paths.lines().map(|line| line.splitn(3, ':').skip(1));
        let path = lines.find_map(|mut line| {
            let is_it = line.next()?.split(',').any(|name| name == controller);
            is_it.then(|| line.next().unwrap_or("/").trim_start_matches('/').to_owned())
        });
        path.unwrap_or_default()
    };
    let below = |root: PathBuf, path: &str, names: [&str; 3]| -> Vec<Group> {
        let folder = root.join(path);
        let up = folder.ancestors().take_while(|folder| folder.starts_with(&root));
        up.filter_map(|folder| Group::read(folder, names)).collect()
    };
    let mut all = below(mount.to_owned(), &own(""), ["memory.max", "memory.current", "inactive_file "]);
    let names = ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "];
    all.extend(below(mount.join("memory"), &own("memory"), names));
    all
}

/// Bytes for each lit pixel of an open scene: its code, radiance and altitude.
const BYTES_PER_LIT_PIXEL: u64 = 16;
/// Bytes for each block of the pyramid over them, with its code.
const BYTES_PER_BLOCK: u64 = size_of::<Block>() as u64 + 8;
/// Bytes for a light or block where skylines are known, and of each skyline.
const BYTES_PER_OPEN_SKY: u64 = 4;
const BYTES_PER_SKYLINE: u64 = size_of::<Skyline>() as u64;

/// Bytes for 64 pixels of a raster that is read, lit or not: runs of the mask and sums of negatives.
const BYTES_PER_64_PIXELS: u64 = 48;
/// What an ingest takes beside.
const BASE_BYTES: u64 = 256 << 20;
/// Levels that blocks can have: rasters have 2^24 pixels along a side at most.
pub(crate) const LEVELS: u32 = 24;

/// What the lights of a scene are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LightCount {
    pub(crate) lit: u64,
    /// Blocks of 2×2, 4×4 … pixels that hold one of them.
    pub(crate) blocks: u64,
    /// Lights with a skyline.
    pub(crate) skylines: u64,
}

impl LightCount {
    /// Of lights by their Morton codes, ascending: two of them share no block that is smaller than where their codes differ.
    pub(crate) fn of_codes(codes: &[u64], skylines: u64) -> Self {
        let level = |a: u64, b: u64| u64::from((63 - (a ^ b).max(1).leading_zeros()) / 2);
        let ends = codes.first().zip(codes.last());
        let top = ends.map_or(0, |(first, last)| (level(*first, *last) + 1).max(1));
        let between: u64 = codes.windows(2).map(|pair| level(pair[0], pair[1])).sum();
        Self { lit: codes.len() as u64, blocks: top + between, skylines }
    }

    /// The most that a raster can have.
    pub(crate) fn worst(width: u32, height: u32) -> Self {
        let (width, height) = (u64::from(width), u64::from(height));
        let blocks = (1..=LEVELS).map(|level| width.div_ceil(1 << level) * height.div_ceil(1 << level));
        Self { lit: width * height, blocks: blocks.sum(), skylines: 0 }
    }

    /// Bytes that an ingest takes, as long as there is no terrain (measured: 43 for a pixel where all are lit, which this takes for 50).
    pub(crate) fn ingest_bytes(&self, pixels: u64) -> u64 {
        BASE_BYTES + self.scene_bytes() / 4 * 5 + pixels / 64 * BYTES_PER_64_PIXELS
    }

    /// Bytes that an open scene takes for them.
    pub(crate) fn scene_bytes(&self) -> u64 {
        let skies = match self.skylines {
            0 => 0,
            count => {
                BYTES_PER_OPEN_SKY * (self.lit + self.blocks)
                    + BYTES_PER_SKYLINE * (count + self.blocks.min(2 * count))
            }
        };
        BYTES_PER_LIT_PIXEL * self.lit + BYTES_PER_BLOCK * self.blocks + skies
    }
}

/// Bytes for people: `1.2 GB`.
pub(crate) fn gigabytes(bytes: u64) -> String {
    format!("{:.1} GB", bytes as f64 / 1e9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::morton;
    use std::collections::BTreeSet;

    #[test]
    fn this_machine_says_how_much_memory_it_has() {
        let (most, left) = (memory_limit_bytes().unwrap(), available_bytes().unwrap());
        assert!(left > 1 << 20 && left <= most, "{left} of {most}");
    }

    /// The least limit of the groups from a process's own upwards counts, in both versions of control groups.
    #[test]
    fn limits_of_groups_are_found_up_the_tree() {
        let folder = tempfile::tempdir().unwrap();
        let (proc, mount) = (folder.path().join("proc"), folder.path().join("groups"));
        let write = |path: PathBuf, text: &str| {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        write(proc.join("self/cgroup"), "4:cpu,memory:/kept/one\n0::/pod/app\n");
        write(mount.join("pod/app/memory.max"), "max\n");
        write(mount.join("pod/memory.max"), "4096\n");
        write(mount.join("pod/memory.current"), "3000\n");
        write(mount.join("pod/memory.stat"), "anon 1\ninactive_file 500\n");
        write(mount.join("memory/kept/one/memory.limit_in_bytes"), "8192\n");
        write(mount.join("memory/kept/one/memory.usage_in_bytes"), "8000\n");
        write(mount.join("memory/kept/one/memory.stat"), "total_inactive_file 100\n");
        let found = groups(&proc, &mount);
        assert_eq!(found.iter().map(|group| group.most).collect::<Vec<_>>(), [4096, 8192]);
        assert_eq!(found.iter().map(Group::left).collect::<Vec<_>>(), [1596, 292]);
        // A container sees its own group as the root, under whatever path.
        write(mount.join("memory.max"), "1024\n");
        write(proc.join("self/cgroup"), "0::/../outside\n");
        assert_eq!(groups(&proc, &mount)[0].most, 1024);
    }

    /// Blocks counted by the codes alone are those that a pyramid has, and never more than the bound.
    #[test]
    fn blocks_are_counted_without_a_pyramid() {
        for (step, side) in [(1, 16u32), (3, 64), (8, 64), (63, 64), (64, 64)] {
            let places = (0..side).step_by(step).flat_map(|c| (0..side).step_by(step).map(move |r| (c, r)));
            let mut codes: Vec<u64> = places.map(|(c, r)| morton::encode(c, r)).collect();
            codes.sort_unstable();
            let level = |level: u32| {
                codes.iter().map(|code| code >> (2 * level)).collect::<BTreeSet<_>>().len() as u64
            };
            let top = (1..).find(|&l| level(l) == 1).unwrap();
            let blocks: u64 = (1..=top).map(level).sum();
            let count = LightCount::of_codes(&codes, 0);
            assert_eq!(count.blocks, blocks, "{step} {side}");
            let worst = LightCount::worst(side, side);
            assert!(worst.blocks >= blocks && worst.scene_bytes() >= count.scene_bytes());
        }
        assert_eq!(LightCount::of_codes(&[], 0), LightCount::default());
    }
}
