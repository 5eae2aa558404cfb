//! Memory that the system still grants this process: free memory, and the limits of the process
//! (`ulimit -v`, `ulimit -d`) and of its control group (a container's, on Linux).

use std::fs;
use std::path::{Path, PathBuf};

/// Number of bytes available, and a description of the limit.
pub type Limit = (u64, &'static str);

/// Description of the limit on the address space.
const SPACE: &str = "what the limit of this process (ulimit -v) leaves";
/// Least memory reserved for what no plan counts: stacks, allocator overhead, a driver's compiler.
pub const KEPT: u64 = 32 << 20;
/// Reciprocal of the fraction of the limit reserved for the same.
const KEPT_PART: u64 = 8;

/// Bytes of free main memory, including free swap space; `None` if the system does not report it.
pub fn free() -> Option<Limit> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let bytes = |name| kilobytes(&text, name);
    Some((bytes("MemAvailable:")? + bytes("SwapFree:").unwrap_or(0), "what the system has left"))
}

/// Tightest limit of the process or its control groups, less the reserve, if there is any limit.
pub fn limited() -> Option<Limit> {
    let process = process_limits(Path::new("/proc/self"));
    let groups = group_limits(Path::new("/"));
    process
        .into_iter()
        .chain(groups)
        .map(|(left, whose)| (kept_back(left), whose))
        .min_by_key(|limit| limit.0)
}

fn kept_back(left: u64) -> u64 {
    left.saturating_sub((left / KEPT_PART).max(KEPT))
}

/// Value of a line `name 123 kB`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib << 10)
}

/// Checks that the limits of the process leave the memory that no plan counts.
///
/// # Errors
/// The number of bytes left, and a description of the limit.
pub fn check_reserve() -> Result<(), Limit> {
    let least = process_limits(Path::new("/proc/self")).into_iter().min_by_key(|limit| limit.0);
    least.filter(|limit| limit.0 < KEPT).map_or(Ok(()), Err)
}

/// Bytes of address space that the limit of the process leaves (`ulimit -v`), if there is one.
pub fn address_space() -> Option<u64> {
    process_limits(Path::new("/proc/self"))
        .into_iter()
        .find(|limit| limit.1 == SPACE)
        .map(|limit| limit.0)
}

/// Bytes that the resource limits of a process leave, from its folder in /proc.
fn process_limits(process: &Path) -> Vec<Limit> {
    let read = |name| fs::read_to_string(process.join(name)).unwrap_or_default();
    let (limits, status) = (read("limits"), read("status"));
    let left = |name: &str, used: &str, whose| {
        // name, soft limit, hard limit, unit; `unlimited` does not parse
        let line = limits.lines().find_map(|line| line.strip_prefix(name))?;
        let soft = line.split_whitespace().next()?.parse::<u64>().ok()?;
        Some((soft.saturating_sub(kilobytes(&status, used)?), whose))
    };
    let space = left("Max address space", "VmSize:", SPACE);
    let data =
        left("Max data size", "VmData:", "what the limit of this process (ulimit -d) leaves");
    space.into_iter().chain(data).collect()
}

/// Bytes that the control groups of this process and their ancestors leave. `root` is the root of
/// the file system.
fn group_limits(root: &Path) -> Vec<Limit> {
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).unwrap_or_default();
    let mounts = fs::read_to_string(root.join("proc/self/mountinfo")).unwrap_or_default();
    let mut found = Vec::new();
    for line in groups.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(group)) = (parts.next(), parts.next()) else { continue };
        let version = match controllers {
            "" => &V2,
            list if list.split(',').any(|name| name == "memory") => &V1,
            _ => continue,
        };
        let Some((mounted_root, mount)) = mount_of(&mounts, version) else { continue };
        // inside a container the group's path may be that on the host, of which the mount shows a
        // part
        let inside = Path::new(group).strip_prefix(&mounted_root).unwrap_or(Path::new(""));
        let top = root.join(mount.strip_prefix("/").unwrap_or(&mount));
        let here = top.join(inside.strip_prefix("/").unwrap_or(inside));
        let folders = here.ancestors().take_while(|folder| folder.starts_with(&top));
        found.extend(folders.filter_map(|folder| version.left(folder)));
    }
    found
}

/// Mount of a version's files: the group at the mount's root, and the mount point.
fn mount_of(mounts: &str, version: &Version) -> Option<(PathBuf, PathBuf)> {
    mounts.lines().find_map(|line| {
        let (mount, filesystem) = line.split_once(" - ")?;
        let mut fields = filesystem.split_whitespace();
        let (kind, options) = (fields.next()?, fields.nth(1).unwrap_or_default());
        let ours = kind == version.filesystem
            && (version.option.is_empty()
                || options.split(',').any(|option| option == version.option));
        let mut fields = mount.split_whitespace().skip(3);
        ours.then(|| Some((fields.next()?.into(), fields.next()?.into()))).flatten()
    })
}

/// Files of a version of control groups.
struct Version {
    filesystem: &'static str,
    option: &'static str,
    limit: &'static str,
    used: &'static str,
    /// Line of `memory.stat` with the bytes that the kernel reclaims when memory is short.
    reclaimable: &'static str,
}

const V1: Version = Version {
    filesystem: "cgroup",
    option: "memory",
    limit: "memory.limit_in_bytes",
    used: "memory.usage_in_bytes",
    reclaimable: "total_inactive_file ",
};
const V2: Version = Version {
    filesystem: "cgroup2",
    option: "",
    limit: "memory.max",
    used: "memory.current",
    reclaimable: "inactive_file ",
};
/// Limits from here on mean none: version 1 reports the greatest number that the kernel can count.
const UNLIMITED: u64 = 1 << 60;

impl Version {
    /// Bytes that the group of a folder leaves, if it has a limit.
    fn left(&self, folder: &Path) -> Option<Limit> {
        let text = |name: &str| fs::read_to_string(folder.join(name)).ok();
        let number = |name: &str| text(name)?.trim().parse::<u64>().ok();
        // `max` does not parse
        let limit = number(self.limit).filter(|limit| *limit < UNLIMITED)?;
        let stat = text("memory.stat").unwrap_or_default();
        let line = stat.lines().find_map(|line| line.strip_prefix(self.reclaimable));
        let reclaimable = line.and_then(|line| line.trim().parse::<u64>().ok()).unwrap_or(0);
        let used = number(self.used)?.saturating_sub(reclaimable);
        Some((
            limit.saturating_sub(used),
            "what the memory limit of this control group (container) leaves",
        ))
    }
}

/// Theory: files as Linux writes them for a process with limits, in nested groups of either
/// version, leave what the tightest limit leaves; files without limits leave everything.
#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str, files: &[(&str, &str)]) -> PathBuf {
        let root = std::env::temp_dir().join(format!("caustica-{}-{name}", std::process::id()));
        for (file, text) in files {
            let path = root.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    fn left(limits: Vec<Limit>) -> Vec<u64> {
        limits.into_iter().map(|limit| limit.0).collect()
    }

    #[test]
    fn limits_of_a_process() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units     \n\
                      Max data size             unlimited            unlimited            bytes     \n\
                      Max address space         300000000            unlimited            bytes     \n";
        let status = "Name:\tcaustica\nVmSize:\t  100000 kB\nVmData:\t   50000 kB\n";
        let root = folder("process", &[("limits", limits), ("status", status)]);
        assert_eq!(left(process_limits(&root)), [300_000_000 - 102_400_000]);
        assert!(process_limits(&root.join("nowhere")).is_empty());
    }

    #[test]
    fn limits_of_groups() {
        let root = folder(
            "v2",
            &[
                ("proc/self/cgroup", "0::/user/job/step\n"),
                (
                    "proc/self/mountinfo",
                    "30 23 0:26 / /sys/fs/cgroup rw,nosuid - cgroup2 cgroup2 rw\n",
                ),
                ("sys/fs/cgroup/user/job/step/memory.max", "max\n"),
                ("sys/fs/cgroup/user/job/memory.max", "500\n"),
                ("sys/fs/cgroup/user/job/memory.current", "300\n"),
                (
                    "sys/fs/cgroup/user/job/memory.stat",
                    "anon 7\ninactive_file 100\nactive_file 9\n",
                ),
                ("sys/fs/cgroup/user/memory.max", "1000\n"),
                ("sys/fs/cgroup/user/memory.current", "400\n"),
            ],
        );
        assert_eq!(left(group_limits(&root)), [300, 600]);
        let root = folder(
            "v1",
            &[
                ("proc/self/cgroup", "5:cpu,cpuacct:/docker/ab\n4:memory:/docker/ab\n"),
                (
                    "proc/self/mountinfo",
                    "31 23 0:27 /docker/ab /sys/fs/cgroup/cpu rw - cgroup cgroup rw,cpu,cpuacct\n\
                     32 23 0:28 /docker/ab /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory\n",
                ),
                ("sys/fs/cgroup/memory/memory.limit_in_bytes", "314572800\n"),
                ("sys/fs/cgroup/memory/memory.usage_in_bytes", "14572800\n"),
            ],
        );
        assert_eq!(left(group_limits(&root)), [300_000_000]);
        let root = folder("none", &[("proc/self/cgroup", "0::/\n"), ("proc/self/mountinfo", "")]);
        assert!(group_limits(&root).is_empty());
    }

    #[test]
    fn some_is_kept_for_what_nobody_counts() {
        assert_eq!(kept_back(10 << 20), 0);
        assert_eq!(kept_back(100 << 20), 68 << 20);
        assert_eq!(kept_back(8 << 30), 7 << 30);
    }
}
