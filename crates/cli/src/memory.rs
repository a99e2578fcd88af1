//! Memory: how much was used, and how much there is.

use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes that the program may take; `u64::MAX` where nobody set a limit.
static LIMIT: AtomicU64 = AtomicU64::new(u64::MAX);

/// Sets the bytes that the program may take in all.
pub fn limit(bytes: usize) {
    LIMIT.store(bytes as u64, Ordering::Relaxed);
}

/// Bytes that are left of those that the program may take.
fn allowed() -> u64 {
    match LIMIT.load(Ordering::Relaxed) {
        u64::MAX => u64::MAX,
        limit => {
            let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
            limit.saturating_sub(kilobytes(&status, "VmRSS:").unwrap_or(0))
        }
    }
}

/// The largest resident size of this process so far, in bytes; `None` where the system does not tell.
pub fn peak() -> Option<u64> {
    kilobytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// Bytes that can still be had without swapping: of the machine, of the control group, of the address space
/// (`ulimit -v`), and of the [`limit`] of the user; `None` where the system does not tell.
pub fn available() -> Option<u64> {
    let machine = kilobytes(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")?;
    let number = |path: &str| std::fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max")
        .zip(number("/sys/fs/cgroup/memory.current"))
        .map(|(limit, used)| limit.saturating_sub(used));
    let others = [group, address_space()].into_iter().flatten().min().unwrap_or(u64::MAX);
    Some(machine.min(others).min(allowed()))
}

/// Bytes that are left of the address space that this process may have, where that is limited.
fn address_space() -> Option<u64> {
    let limit = address_limit(&std::fs::read_to_string("/proc/self/limits").ok()?)?;
    let used = kilobytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmSize:")?;
    Some(limit.saturating_sub(used))
}

/// The soft limit of the address space in a table of limits, in bytes.
fn address_limit(table: &str) -> Option<u64> {
    let rest = table.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    rest.split_whitespace().next()?.parse().ok()
}

/// The value of a `Name:   123 kB` line, in bytes.
fn kilobytes(table: &str, name: &str) -> Option<u64> {
    let rest = table.lines().find_map(|line| line.strip_prefix(name))?;
    rest.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// A size for people.
pub fn readable(bytes: u64) -> String {
    const UNITS: [&str; 5] = ["B", "KiB", "MiB", "GiB", "TiB"];
    let power = (bytes.max(1).ilog2() / 10).min(4) as usize;
    match power {
        0 => format!("{bytes} B"),
        _ => format!("{:.1} {}", bytes as f64 / (1u64 << (10 * power)) as f64, UNITS[power]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_the_system_are_read() {
        let table = "Name:\tsteradian\nVmHWM:\t    2048 kB\nThreads:\t1\n";
        assert_eq!(kilobytes(table, "VmHWM:"), Some(2048 * 1024));
        assert_eq!(kilobytes(table, "Threads:"), None);
        assert_eq!(kilobytes(table, "VmPeak:"), None);
    }

    #[test]
    fn limits_of_the_address_space_are_read() {
        let table = |limit: &str| {
            format!("Limit  Soft Limit  Hard Limit  Units\nMax address space   {limit}   unlimited   bytes\n")
        };
        assert_eq!(address_limit(&table("1073741824")), Some(1 << 30));
        assert_eq!(address_limit(&table("unlimited")), None);
        assert_eq!(address_limit(""), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_process_has_a_size() {
        assert!(peak().unwrap() > 100_000 && available().unwrap() > 1_000_000);
    }

    #[test]
    fn sizes_are_readable() {
        assert_eq!(readable(0), "0 B");
        assert_eq!(readable(1023), "1023 B");
        assert_eq!(readable(1536), "1.5 KiB");
        assert_eq!(readable(3 << 30), "3.0 GiB");
    }
}
