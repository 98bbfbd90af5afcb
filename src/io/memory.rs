//! What memory there is, asked before much of it is taken.
//!
//! Systems hand out more than they have and end programs later; so what a file or a setting asks
//! for is estimated first, and refused with both figures where the machine cannot hold it.

use std::fs;
use std::path::Path;

/// Less than this is taken without a question.
const SMALL: u64 = 4 << 20;

/// Part of the free memory that is left to everything else, as a divisor.
const LEFT_TO_OTHERS: u64 = 16;

/// More memory than there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("takes {} of memory, and {} are free", size(*.needed), size(*.free))]
pub struct NoMemory {
    /// Bytes that it would take.
    pub needed: u64,
    /// Bytes that are free.
    pub free: u64,
}

/// Refuses what the machine cannot hold now.
///
/// # Errors
/// When `needed` bytes do not fit beside what is in use.
pub fn check(needed: u64) -> Result<(), NoMemory> {
    if needed <= SMALL {
        return Ok(());
    }
    fits(needed, free().unwrap_or(u64::MAX))
}

/// Refuses what does not fit into what is free, part of which is left to everything else.
///
/// # Errors
/// When `needed` bytes do not fit.
pub fn fits(needed: u64, free: u64) -> Result<(), NoMemory> {
    if free - free / LEFT_TO_OTHERS < needed {
        return Err(NoMemory { needed, free });
    }
    Ok(())
}

/// Bytes that this process could still take: of the machine, of the control groups that it runs in,
/// and within the limits set for it, whichever is least. `None` where the system does not say.
pub fn free() -> Option<u64> {
    free_under(Path::new("/"))
}

/// The same, of the system whose files are there.
fn free_under(root: &Path) -> Option<u64> {
    let machine = kibibytes_after(&read(root, "proc/meminfo"), "MemAvailable:");
    let Limited { addresses, data, file: _ } = Limited::under(root);
    let groups = read(root, "proc/self/cgroup");
    let groups = groups.lines().flat_map(|line| free_in_groups(&root.join("sys/fs/cgroup"), line));
    [machine, addresses, data].into_iter().flatten().chain(groups).min()
}

/// Bytes that are left within the limits set for this process; `None` where one is not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limited {
    /// Of the addresses that it may reserve, used or not.
    pub addresses: Option<u64>,
    /// Of those that it may write to.
    pub data: Option<u64>,
    /// Of any file; the system ends a program that writes more to one, without a word.
    pub file: Option<u64>,
}

impl Limited {
    /// As it is now.
    pub fn now() -> Self {
        Self::under(Path::new("/"))
    }

    fn under(root: &Path) -> Self {
        let (limits, status) = (read(root, "proc/self/limits"), read(root, "proc/self/status"));
        let left = |most, used| {
            Some(number_after(&limits, most)?.saturating_sub(kibibytes_after(&status, used)?))
        };
        Self {
            addresses: left("Max address space", "VmSize:"),
            data: left("Max data size", "VmData:"),
            file: number_after(&limits, "Max file size"),
        }
    }
}

fn read(root: &Path, path: &str) -> String {
    fs::read_to_string(root.join(path)).unwrap_or_default()
}

fn kibibytes_after(text: &str, key: &str) -> Option<u64> {
    number_after(text, key)?.checked_mul(1024)
}

/// What is left of the control group in a line `NUMBER:KINDS:/PATH` of `/proc/self/cgroup`, and of
/// those around it. What holds files only is given back when it is needed.
fn free_in_groups(mounted: &Path, line: &str) -> Vec<u64> {
    let mut parts = line.splitn(3, ':').skip(1);
    let (Some(kinds), Some(path)) = (parts.next(), parts.next()) else { return Vec::new() };
    let (folder, most, used, files) = match kinds {
        "" => ("", "memory.max", "memory.current", ["inactive_file ", "active_file "]),
        "memory" => (
            "memory",
            "memory.limit_in_bytes",
            "memory.usage_in_bytes",
            ["total_inactive_file ", "total_active_file "],
        ),
        _ => return Vec::new(),
    };
    let free_in = |group: &Path| {
        let group = mounted.join(folder).join(group);
        let read = |name| fs::read_to_string(group.join(name)).ok();
        let number = |name| read(name)?.trim().parse::<u64>().ok();
        let statistics = read("memory.stat").unwrap_or_default();
        let files = files.iter().filter_map(|key| number_after(&statistics, key)).sum();
        Some(number(most)?.saturating_sub(number(used)?.saturating_sub(files)))
    };
    Path::new(path.trim_start_matches('/')).ancestors().filter_map(free_in).collect()
}

/// The number that begins what follows `key` in its line.
fn number_after(text: &str, key: &str) -> Option<u64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(key))?;
    rest.split_whitespace().next()?.parse().ok()
}

/// A size in words: "812 MiB", "15.1 GiB".
pub fn size(bytes: u64) -> String {
    let mebibytes = bytes as f64 / f64::from(1 << 20);
    if mebibytes < 1024.0 {
        format!("{mebibytes:.0} MiB")
    } else {
        format!("{:.1} GiB", mebibytes / 1024.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_both_figures() {
        assert_eq!(fits(14 << 30, 16 << 30), Ok(()), "there is room");
        let refused = fits(15 << 30, (155 << 30) / 10).unwrap_err().to_string();
        assert_eq!(refused, "takes 15.0 GiB of memory, and 15.5 GiB are free", "a part is kept");
        assert_eq!(check(SMALL), Ok(()), "small things are not asked for");
        if free().is_some() {
            assert!(check(1 << 60).is_err(), "no machine holds an exbibyte");
        }
    }

    /// A system in a folder: 23 GB available, and whatever else these files say.
    fn system(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        let meminfo = "MemTotal:       24000000 kB\nMemAvailable:   23000000 kB\nBuffers: 0 kB\n";
        for (name, text) in [("proc/meminfo", meminfo)].iter().chain(files) {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    #[test]
    fn the_system_tells_what_is_available() {
        let available = Some(23_000_000 * 1024);
        assert_eq!(free_under(system(&[]).path()), available, "in bytes");
        for text in ["", "MemAvailable: x kB", "MemAvailable: 99999999999999999999 kB"] {
            assert_eq!(free_under(system(&[("proc/meminfo", text)]).path()), None, "{text:?}");
        }
        let unlimited = "Max data size   unlimited  unlimited  bytes\n";
        let limits = [("proc/self/limits", unlimited), ("proc/self/status", "VmData: 9 kB\n")];
        assert_eq!(free_under(system(&limits).path()), available, "no limit");
    }

    #[test]
    fn limits_of_the_process_count() {
        let status = "VmPeak:\t  900 kB\nVmSize:\t   500 kB\nVmData:\t   100 kB\n";
        for (limit, expected) in [
            (
                "Max address space         1024000              unlimited            bytes\n",
                512_000,
            ),
            (
                "Max data size             1024000              unlimited            bytes\n",
                921_600,
            ),
            ("Max address space         1000                 unlimited            bytes\n", 0),
        ] {
            let files = [("proc/self/limits", limit), ("proc/self/status", status)];
            assert_eq!(free_under(system(&files).path()), Some(expected), "{limit}");
        }
        let limit = "Max file size             512                  unlimited            bytes\n";
        let system = system(&[("proc/self/limits", limit), ("proc/self/status", status)]);
        let expected = Limited { addresses: None, data: None, file: Some(512) };
        assert_eq!(Limited::under(system.path()), expected, "of files");
    }

    /// Files that the system keeps in memory only because there is room count as free.
    #[test]
    fn control_groups_count_and_those_around_them() {
        let statistics = "anon 100\ninactive_file 600\nactive_file 50\n";
        let inner = [
            ("proc/self/cgroup", "0::/a/b\n"),
            ("sys/fs/cgroup/a/b/memory.max", "1000\n"),
            ("sys/fs/cgroup/a/b/memory.current", "900\n"),
            ("sys/fs/cgroup/a/b/memory.stat", statistics),
        ];
        assert_eq!(free_under(system(&inner).path()), Some(750), "the group of the process");
        let outer =
            [("sys/fs/cgroup/a/memory.max", "500\n"), ("sys/fs/cgroup/a/memory.current", "400\n")];
        let both = [&inner[..], &outer].concat();
        assert_eq!(free_under(system(&both).path()), Some(100), "the group around it has less");
        let older = [
            ("proc/self/cgroup", "9:cpu:/\n4:memory:/not/here\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "1000\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "950\n"),
            ("sys/fs/cgroup/memory/memory.stat", "total_inactive_file 30\ntotal_active_file 7\n"),
        ];
        assert_eq!(free_under(system(&older).path()), Some(87), "groups of the older kind");
        let unlimited = [inner[0], (inner[1].0, "max\n"), inner[2]];
        assert_eq!(free_under(system(&unlimited).path()), Some(23_000_000 * 1024), "no limit");
    }
}
