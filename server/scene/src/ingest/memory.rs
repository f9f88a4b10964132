//! How much memory an ingest needs, and how much there is.

/// Bytes for each lit pixel while a scene is made of it: itself twice, its place in the pyramid, and its skyline (measured 44 and
/// more on real rasters without terrain).
const BYTES_PER_LIT_PIXEL: u64 = 96;
/// Bytes for 64 pixels of a raster, lit or not: runs of the mask and sums of negatives.
const BYTES_PER_64_PIXELS: u64 = 48;
/// What the program takes beside.
const BASE_BYTES: u64 = 256 << 20;

/// Bytes that a raster needs.
pub(super) fn needed_bytes(pixels: u64, lit: u64) -> u64 {
    BASE_BYTES + lit * BYTES_PER_LIT_PIXEL + pixels / 64 * BYTES_PER_64_PIXELS
}

/// Bytes that can be had: of the machine, of the control group, and of the address space; None where nobody says.
pub fn available_bytes() -> Option<u64> {
    let number = |path: &str| std::fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let field = |path: &str, name: &str| {
        let text = std::fs::read_to_string(path).ok()?;
        let line =
            text.lines().find_map(|line| line.strip_prefix(name))?.trim_start_matches(':').trim().to_owned();
        Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
    };
    let machine = field("/proc/meminfo", "MemAvailable");
    let group = number("/sys/fs/cgroup/memory.max").map(|most| {
        let used = number("/sys/fs/cgroup/memory.current").unwrap_or(0);
        // What files hold in the cache is given back when it is wanted.
        let cached = std::fs::read_to_string("/sys/fs/cgroup/memory.stat").ok().and_then(|text| {
            text.lines().find_map(|line| line.strip_prefix("inactive_file ")?.trim().parse::<u64>().ok())
        });
        most.saturating_sub(used.saturating_sub(cached.unwrap_or(0)))
    });
    let space = rustix::process::getrlimit(rustix::process::Resource::As)
        .current
        .map(|most| most.saturating_sub(field("/proc/self/status", "VmSize").unwrap_or(0)));
    [machine, group, space].into_iter().flatten().min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_known_and_grows_with_light() {
        assert!(available_bytes().is_some_and(|bytes| bytes > 1 << 20));
        assert!(needed_bytes(1_000_000, 1_000_000) > needed_bytes(1_000_000, 0));
    }
}
