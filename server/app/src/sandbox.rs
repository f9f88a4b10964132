//! Walls around the process that reads uploads, for a raster that takes over a library: the kernel lets it read the upload and what
//! comes with GDAL and PROJ alone, and write in the upload's folder alone (Landlock); no network, no other programs, no signals to
//! others (seccomp); no more memory than it was given.

use landlock::{
    ABI, Access, AccessFs, AccessNet, BitFlags, CompatLevel, Compatible, Ruleset, RulesetAttr,
    RulesetCreatedAttr, RulesetError, RulesetStatus, Scope, path_beneath_rules,
};
use rustix::process::{Resource, Rlimit, getpid, setrlimit};
use seccompiler::{
    BpfProgram, SeccompAction, SeccompCmpArgLen, SeccompCmpOp, SeccompCondition, SeccompFilter, SeccompRule,
    sock_filter,
};
use std::path::{Path, PathBuf};

/// Libraries, and the data of GDAL and PROJ, where systems have them.
const LIBRARIES: [&str; 10] = [
    "/lib",
    "/lib64",
    "/usr/lib",
    "/usr/lib64",
    "/usr/local/lib",
    "/usr/share/gdal",
    "/usr/share/proj",
    "/usr/local/share/gdal",
    "/usr/local/share/proj",
    "/etc/ld.so.cache",
];
/// Variables that name more of those; the only ones that a reader gets of the server's, with [`OTHER_VARIABLES`].
const LIBRARY_VARIABLES: [&str; 5] =
    ["LD_LIBRARY_PATH", "GDAL_DATA", "GDAL_DRIVER_PATH", "PROJ_DATA", "PROJ_LIB"];
/// Variables that name no files.
const OTHER_VARIABLES: [&str; 2] = ["RAYON_NUM_THREADS", "RUST_BACKTRACE"];
/// What is right for every reader: few pools of memory, a cache of a size, no files beside a raster, no network.
const SETTINGS: [(&str, &str); 5] = [
    ("MALLOC_ARENA_MAX", "4"),
    ("GDAL_CACHEMAX", "128"),
    ("GDAL_PAM_ENABLED", "NO"),
    ("GDAL_HTTP_NETRC", "NO"),
    ("PROJ_NETWORK", "OFF"),
];
/// Address space beside the memory: stacks of threads, and pools that are reserved and not used.
const SPACE_BESIDE_BYTES: u64 = 1 << 30;

/// The whole environment of a reader: no secrets of the server, and its files in the upload's folder.
pub(crate) fn environment(folder: &Path) -> Vec<(&'static str, std::ffi::OsString)> {
    let own = LIBRARY_VARIABLES.iter().chain(&OTHER_VARIABLES);
    let own = own.filter_map(|name| Some((*name, std::env::var_os(name)?)));
    let fixed = SETTINGS.iter().map(|(name, value)| (*name, (*value).into()));
    own.chain(fixed).chain([("TMPDIR", folder.into())]).collect()
}

/// Raises the walls around this thread and those that it starts. What the kernel lacks is left out.
///
/// * `folder`: where it may write.
///
/// # Errors
/// Says what is left out.
pub fn raise(folder: &Path) -> Result<(), String> {
    let files = match wall_of_files(folder) {
        Ok(RulesetStatus::NotEnforced) => Err("this kernel has no Landlock".to_owned()),
        Ok(_) => Ok(()),
        Err(error) => Err(format!("Landlock: {error}")),
    };
    // After the other, which makes a call that this one would not let pass on some kernels.
    let calls = wall_of_calls().map_err(|error| format!("seccomp: {error}"));
    match [files, calls].into_iter().filter_map(Result::err).collect::<Vec<_>>() {
        lacking if lacking.is_empty() => Ok(()),
        lacking => Err(lacking.join("; ")),
    }
}

/// Whether the walls can be raised here: tries it on a thread that ends.
///
/// # Errors
/// Says what the kernel lacks.
pub fn probe() -> Result<(), String> {
    let tried = std::thread::spawn(|| raise(Path::new("/nonexistent")));
    tried.join().unwrap_or_else(|_| Err("the thread that tried it broke off".to_owned()))
}

fn wall_of_files(folder: &Path) -> Result<RulesetStatus, RulesetError> {
    let abi = ABI::V6;
    let read: BitFlags<AccessFs> = AccessFs::ReadFile | AccessFs::ReadDir;
    // No links, devices, pipes or sockets: the server reads afterwards what lies there.
    let write = read
        | AccessFs::WriteFile
        | AccessFs::Truncate
        | AccessFs::MakeReg
        | AccessFs::MakeDir
        | AccessFs::RemoveFile
        | AccessFs::RemoveDir
        | AccessFs::Refer;
    let named = LIBRARY_VARIABLES.iter().filter_map(std::env::var_os);
    let named: Vec<PathBuf> =
        named.flat_map(|paths| std::env::split_paths(&paths).collect::<Vec<_>>()).collect();
    let libraries =
        LIBRARIES.iter().map(PathBuf::from).chain(named.into_iter().filter(|path| path.is_absolute()));
    // Without these nothing is walled off. What a kernel before 6.12 lacks beside them (truncation, network, signals) the other
    // wall refuses.
    let needed = AccessFs::from_all(ABI::V2);
    let walls = Ruleset::default()
        .set_compatibility(CompatLevel::HardRequirement)
        .handle_access(needed)?
        .set_compatibility(CompatLevel::BestEffort)
        .handle_access(AccessFs::from_all(abi))?
        .handle_access(AccessNet::from_all(abi))?
        .scope(Scope::from_all(abi))?
        .create()?
        .add_rules(path_beneath_rules(libraries, read))?
        .add_rules(path_beneath_rules([folder], write))?;
    Ok(walls.restrict_self()?.ruleset)
}

/// Calls of the system that no reading of files needs.
const REFUSED_CALLS: &[libc::c_long] = &[
    libc::SYS_socket,
    libc::SYS_socketpair,
    libc::SYS_connect,
    libc::SYS_bind,
    libc::SYS_listen,
    libc::SYS_accept,
    libc::SYS_accept4,
    libc::SYS_io_uring_setup,
    libc::SYS_execve,
    libc::SYS_execveat,
    libc::SYS_ptrace,
    libc::SYS_process_vm_readv,
    libc::SYS_process_vm_writev,
    libc::SYS_pidfd_getfd,
    libc::SYS_kcmp,
    libc::SYS_kill,
    libc::SYS_tkill,
    libc::SYS_pidfd_send_signal,
    libc::SYS_rt_sigqueueinfo,
    libc::SYS_rt_tgsigqueueinfo,
    libc::SYS_symlinkat,
    libc::SYS_linkat,
    libc::SYS_mknodat,
    libc::SYS_mount,
    libc::SYS_umount2,
    libc::SYS_pivot_root,
    libc::SYS_chroot,
    libc::SYS_unshare,
    libc::SYS_setns,
    libc::SYS_bpf,
    libc::SYS_perf_event_open,
    libc::SYS_userfaultfd,
    libc::SYS_add_key,
    libc::SYS_request_key,
    libc::SYS_keyctl,
    libc::SYS_init_module,
    libc::SYS_finit_module,
    libc::SYS_kexec_load,
    libc::SYS_open_by_handle_at,
    libc::SYS_truncate,
    libc::SYS_fchmod,
    libc::SYS_fchmodat,
    libc::SYS_fchmodat2,
    libc::SYS_fchown,
    libc::SYS_fchownat,
    libc::SYS_utimensat,
    libc::SYS_setxattr,
    libc::SYS_lsetxattr,
    libc::SYS_fsetxattr,
    libc::SYS_removexattr,
    libc::SYS_lremovexattr,
    libc::SYS_fremovexattr,
    libc::SYS_sched_setaffinity,
    libc::SYS_setpriority,
    libc::SYS_ioprio_set,
    libc::SYS_migrate_pages,
    libc::SYS_move_pages,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_symlink,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_link,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_mknod,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_fork,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_vfork,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_chmod,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_chown,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_lchown,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_utime,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_utimes,
    #[cfg(target_arch = "x86_64")]
    libc::SYS_futimesat,
];

fn wall_of_calls() -> Result<(), Box<dyn std::error::Error>> {
    let refused = SeccompAction::Errno(libc::EACCES as u32);
    let mut rules: std::collections::BTreeMap<i64, Vec<SeccompRule>> =
        REFUSED_CALLS.iter().map(|&call| (call, Vec::new())).collect();
    // A process that aborts signals itself, and nobody else.
    let own = getpid().as_raw_nonzero().get() as u64;
    let other = SeccompCondition::new(0, SeccompCmpArgLen::Dword, SeccompCmpOp::Ne, own)?;
    rules.insert(libc::SYS_tgkill, vec![SeccompRule::new(vec![other])?]);
    // Limits of this process, and of no other.
    let other = SeccompCondition::new(0, SeccompCmpArgLen::Dword, SeccompCmpOp::Ne, 0)?;
    rules.insert(libc::SYS_prlimit64, vec![SeccompRule::new(vec![other])?]);
    // Threads, and no processes: limits of memory are of one process.
    let threads = libc::CLONE_THREAD as u64;
    let process = SeccompCondition::new(0, SeccompCmpArgLen::Qword, SeccompCmpOp::MaskedEq(threads), 0)?;
    rules.insert(libc::SYS_clone, vec![SeccompRule::new(vec![process])?]);
    seccompiler::apply_filter(&no_other_numbers())?;
    // Its flags lie in memory, where no filter sees them. Without it the C library takes the call before.
    let hidden = [(libc::SYS_clone3, Vec::new())].into();
    for (rules, action) in [(hidden, SeccompAction::Errno(libc::ENOSYS as u32)), (rules, refused)] {
        let architecture = std::env::consts::ARCH.try_into()?;
        let filter = SeccompFilter::new(rules, SeccompAction::Allow, action, architecture)?;
        seccompiler::apply_filter(&BpfProgram::try_from(filter)?)?;
    }
    Ok(())
}

/// The first number of calls of x32, the other interface of x86-64, where each call has a second number that lists do not name. No
/// architecture has a call of its own from here on.
const FIRST_OTHER_NUMBER: u32 = 0x4000_0000;

/// Refuses calls of those numbers.
fn no_other_numbers() -> BpfProgram {
    let step = |code: u32, k: u32, jf: u8| sock_filter { code: code as u16, jt: 0, jf, k };
    let answer = |action: SeccompAction| step(libc::BPF_RET | libc::BPF_K, action.into(), 0);
    vec![
        // The number is the first of what a filter is given.
        step(libc::BPF_LD | libc::BPF_W | libc::BPF_ABS, 0, 0),
        // Below it the next step is left out.
        step(libc::BPF_JMP | libc::BPF_JGE | libc::BPF_K, FIRST_OTHER_NUMBER, 1),
        answer(SeccompAction::Errno(libc::EACCES as u32)),
        answer(SeccompAction::Allow),
    ]
}

/// Lets this process take so many bytes more than it has, and leave no image of its memory.
pub fn limit_memory(bytes: u64) {
    let limit = |most| Rlimit { current: Some(most), maximum: Some(most) };
    // Where the system has no such limits, the reading is what it was before.
    let _best_effort = setrlimit(Resource::Core, limit(0));
    let pages = std::fs::read_to_string("/proc/self/statm")
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse::<u64>().ok());
    let taken = pages.unwrap_or(0) * rustix::param::page_size() as u64;
    let space = taken.saturating_add(SPACE_BESIDE_BYTES).saturating_add(bytes);
    let _best_effort = setrlimit(Resource::As, limit(space));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::ErrorKind::PermissionDenied;
    use std::os::unix::fs::PermissionsExt;

    /// Set where the kernel has no Landlock and the tests are to pass without it.
    const WITHOUT: &str = "SKYGLOW_TEST_WITHOUT_LANDLOCK";

    /// Behind the walls a thread reads and writes its folder and nothing else, reaches no network and starts no program. The control
    /// is the same before they are raised.
    #[test]
    fn behind_the_walls_only_the_folder_is_there() {
        if std::env::var_os(WITHOUT).is_some() {
            return;
        }
        let (own, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        std::fs::write(own.path().join("in"), "own").unwrap();
        std::fs::write(other.path().join("secret"), "secret").unwrap();
        let server = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let address = server.local_addr().unwrap();
        let kind = |result: std::io::Result<()>| result.err().map(|error| error.kind());
        let tries = |own: &Path, name: &str| {
            [
                kind(std::fs::read(other.path().join("secret")).map(drop)),
                kind(std::fs::read("/etc/passwd").map(drop)),
                kind(std::fs::read("/proc/self/environ").map(drop)),
                kind(std::fs::read_dir("/").map(drop)),
                kind(std::fs::write(other.path().join(name), "")),
                kind(std::os::unix::fs::symlink("/etc/passwd", own.join(name))),
                kind(std::net::TcpStream::connect(address).map(drop)),
                kind(std::net::UdpSocket::bind("127.0.0.1:0").map(drop)),
                kind(std::process::Command::new("/bin/true").status().map(drop)),
                kind(std::fs::set_permissions(other.path(), std::fs::Permissions::from_mode(0o700))),
                kind(
                    std::fs::File::open(own)
                        .and_then(|folder| folder.set_modified(std::time::SystemTime::now())),
                ),
                kind(limit_of_parent()),
            ]
        };
        assert_eq!(tries(own.path(), "before"), [None; 12]);
        assert_ne!(call_of_other_number(), Some(PermissionDenied), "the control");
        std::thread::scope(|scope| {
            scope.spawn(|| {
                if let Err(lacking) = raise(own.path()) {
                    panic!("{lacking}; {WITHOUT}=1 leaves this test out");
                }
                assert_eq!(tries(own.path(), "after"), [Some(PermissionDenied); 12]);
                assert_eq!(call_of_other_number(), Some(PermissionDenied));
                assert_eq!(std::fs::read(own.path().join("in")).unwrap(), b"own");
                std::fs::create_dir(own.path().join("made")).unwrap();
                std::fs::write(own.path().join("made/out"), "x").unwrap();
                std::fs::rename(own.path().join("made/out"), own.path().join("out")).unwrap();
                std::fs::remove_dir(own.path().join("made")).unwrap();
                // Threads that it starts stand behind them too.
                let inner =
                    std::thread::scope(|scope| scope.spawn(|| std::fs::read("/etc/passwd")).join().unwrap());
                assert_eq!(kind(inner.map(drop)), Some(PermissionDenied));
            });
        });
        // Around nobody else.
        assert_eq!(tries(own.path(), "beside"), [None; 12]);
    }

    /// Asks for the parent's number as x32 does, which kernels without x32 do not know.
    fn call_of_other_number() -> Option<std::io::ErrorKind> {
        let number = libc::SYS_getppid | libc::c_long::from(FIRST_OTHER_NUMBER);
        #[expect(unsafe_code, reason = "no crate makes such a call, which takes no arguments")]
        // SAFETY: the call reads and writes no memory of this process.
        let result = unsafe { libc::syscall(number) };
        (result < 0).then(|| std::io::Error::last_os_error().kind())
    }

    /// Sets a limit of the process that started this one to what it is.
    fn limit_of_parent() -> std::io::Result<()> {
        let parent = rustix::process::getppid();
        let limit =
            rustix::process::prlimit(parent, Resource::Core, rustix::process::getrlimit(Resource::Core));
        Ok(limit.map(drop)?)
    }

    /// A reader gets none of the server's variables but those that name libraries.
    #[test]
    fn a_reader_gets_no_secrets() {
        let names: Vec<&str> = environment(Path::new("/x")).iter().map(|(name, _)| *name).collect();
        assert!(!names.contains(&"PATH") && !names.contains(&"HOME"), "{names:?}");
        assert!(names.contains(&"TMPDIR") && names.contains(&"PROJ_NETWORK"), "{names:?}");
    }
}
