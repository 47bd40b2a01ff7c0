//! Processor time and memory that this process has used, from Linux's `/proc`.

use std::{fs, time::Duration};

/// Processor time of this process so far, user and system. Zero on systems without `/proc`.
#[must_use]
pub fn processor_time() -> Duration {
    // The program's name in brackets may have spaces. The fields from the third on come after it.
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<u64> = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .map(|field| field.parse().unwrap_or(0))
        .collect();
    // The processor time of the program itself (`utime`) and of the system for it (`stime`), in clock ticks.
    let ticks = fields.get(11).copied().unwrap_or(0) + fields.get(12).copied().unwrap_or(0);
    // A hundred ticks a second on every Linux in use.
    Duration::from_millis(ticks * 10)
}

/// Resident memory of this process, MiB. Zero on systems without `/proc`.
#[must_use]
pub fn resident_mib() -> f64 {
    memory_mib("VmRSS:")
}

/// The most resident memory of this process so far, MiB. Zero on systems without `/proc`.
#[must_use]
pub fn peak_mib() -> f64 {
    memory_mib("VmHWM:")
}

/// A line of `/proc/self/status`, which is in KiB, as MiB.
fn memory_mib(name: &str) -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default();
    line.split_whitespace().next().and_then(|kib| kib.parse::<f64>().ok()).unwrap_or(0.0) / 1024.0
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::{hint::black_box, time::Instant};

    /// Other tests of this process may compute at the same time, so there is only a lower bound.
    #[test]
    fn processor_time_grows_with_work() {
        let (before, begun) = (processor_time(), Instant::now());
        let mut sum = 0u64;
        while processor_time() - before < Duration::from_millis(100) && begun.elapsed() < Duration::from_secs(60) {
            sum = (0..1_000_000).fold(sum, |sum, one| sum.wrapping_add(black_box(one)));
        }
        black_box(sum);
        assert!(processor_time() - before >= Duration::from_millis(100));
    }

    #[test]
    fn resident_memory_counts_pages_that_are_written_to() {
        let before = resident_mib();
        let written = black_box(vec![1u8; 256 << 20]);
        let more = resident_mib() - before;
        assert!(written.len() == 256 << 20 && more > 128.0, "{more} MiB");
    }
}
