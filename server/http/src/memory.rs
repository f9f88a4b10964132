//! The memory that this process may take: that of its control group, or of the machine.

use std::{fs, path::Path};

/// Bytes taken for there where nobody says.
const FALLBACK_BYTES: u64 = 4 << 30;

/// Bytes of memory that this process may take.
pub(crate) fn limit_bytes() -> u64 {
    limit_below(Path::new("/"))
}

/// The least of what the machine has to give, and what the process's control group (version 2 or 1) and those around it allow.
fn limit_below(root: &Path) -> u64 {
    let text = |path: &Path| fs::read_to_string(root.join(path)).ok();
    let machine = text(Path::new("proc/meminfo")).and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
        Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
    });
    let groups = text(Path::new("proc/self/cgroup")).unwrap_or_default();
    let limits = groups.lines().filter_map(|line| line.splitn(3, ':').nth(1).zip(line.splitn(3, ':').nth(2)));
    let limits = limits.filter_map(|(controllers, path)| {
        let (base, name) = match controllers {
            "" => ("sys/fs/cgroup", "memory.max"),
            _ if controllers.split(',').any(|controller| controller == "memory") => {
                ("sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => return None,
        };
        let around = Path::new(path.trim_start_matches('/')).ancestors();
        around
            .filter_map(|group| text(&Path::new(base).join(group).join(name))?.trim().parse::<u64>().ok())
            .min()
    });
    limits.chain(machine).min().unwrap_or(FALLBACK_BYTES)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Limits of control groups of both versions hold, those around included.
    #[test]
    fn the_least_limit_of_memory_holds() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        assert_eq!(limit_below(root.path()), FALLBACK_BYTES);
        write("proc/meminfo", "MemTotal: 9000 kB\nMemAvailable:    8000 kB\n");
        assert_eq!(limit_below(root.path()), 8000 * 1024);
        write("proc/self/cgroup", "5:cpu,memory:/old\n0::/a/b\n");
        write("sys/fs/cgroup/a/b/memory.max", "max\n");
        assert_eq!(limit_below(root.path()), 8000 * 1024);
        write("sys/fs/cgroup/a/memory.max", "4096000\n");
        assert_eq!(limit_below(root.path()), 4_096_000);
        write("sys/fs/cgroup/memory/old/memory.limit_in_bytes", "1024000\n");
        assert_eq!(limit_below(root.path()), 1_024_000);
        assert!(limit_bytes() > 1 << 20);
    }
}
