//! What memory there is, asked before much of it is taken.
//!
//! Systems hand out more than they have and end programs later; so what a file or a setting asks
//! for is estimated first, and refused with both figures where the machine cannot hold it.

/// Less than this is taken without a question.
const SMALL: u64 = 64 << 20;

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

fn fits(needed: u64, free: u64) -> Result<(), NoMemory> {
    if free - free / LEFT_TO_OTHERS < needed {
        return Err(NoMemory { needed, free });
    }
    Ok(())
}

/// Bytes that this process could still take: of the machine, or of the control group that it runs
/// in, whichever is less. `None` where the system does not say.
pub fn free() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| available_in(&text));
    let number = |path: &str| read(path)?.trim().parse::<u64>().ok();
    let limit = number("/sys/fs/cgroup/memory.max");
    let used = number("/sys/fs/cgroup/memory.current");
    let group = limit.zip(used).map(|(limit, used)| limit.saturating_sub(used));
    machine.into_iter().chain(group).min()
}

/// The line `MemAvailable:    123 kB` of `/proc/meminfo`.
fn available_in(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
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

    #[test]
    fn the_system_tells_what_is_available() {
        let text = "MemTotal:       24000000 kB\nMemAvailable:   23000000 kB\nBuffers: 0 kB\n";
        assert_eq!(available_in(text), Some(23_000_000 * 1024), "in bytes");
        for text in ["", "MemAvailable: x kB", "MemAvailable: 99999999999999999999 kB"] {
            assert_eq!(available_in(text), None, "{text:?}");
        }
    }
}
