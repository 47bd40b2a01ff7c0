//! What this process has used, as Linux tells it.

use std::{fs, time::Duration};

/// Processor time of this process so far, user and system. Zero where the system does not tell.
pub(super) fn cpu() -> Duration {
    // The name in brackets may hold spaces; after it come the fields from the third on.
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<u64> = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .map(|field| field.parse().unwrap_or(0))
        .collect();
    let ticks = fields.get(11).copied().unwrap_or(0) + fields.get(12).copied().unwrap_or(0);
    // A hundred ticks a second on every Linux in use.
    Duration::from_millis(ticks * 10)
}

/// Resident memory of this process, MiB. Zero where the system does not tell.
pub(super) fn resident_mib() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or_default();
    line.split_whitespace().next().and_then(|kib| kib.parse::<f64>().ok()).unwrap_or(0.0) / 1024.0
}
