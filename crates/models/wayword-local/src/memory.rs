//! Refuses to load a model that would not fit into the memory.
//!
//! An estimate is made before a checkpoint is read, because a process that runs out of memory is killed without an
//! error.

use crate::{LocalError, ModelDevice, WeightPrecision, weights::CheckpointWeights};
use std::path::Path;

/// The memory that a model needs in addition to its weights, as a share of their size: numerator and denominator.
const WORKING_MEMORY_SHARE: (u64, u64) = (3, 10);

/// The memory that every model needs beside its weights and the share of them, bytes.
const BASE_MEMORY_BYTES: u64 = 300 << 20;

/// Counts the memory that models have taken, against a limit.
#[derive(Debug, Default)]
pub(crate) struct MemoryBudget {
    /// The user's limit for all models together, bytes.
    limit_bytes: Option<u64>,
    /// What the models loaded so far need together, bytes.
    taken_bytes: u64,
}

impl MemoryBudget {
    /// A budget of `most` bytes. Without a number, the limit is the free memory of the machine when a model is loaded.
    pub(crate) fn new(most: Option<u64>) -> Self {
        Self { limit_bytes: most, taken_bytes: 0 }
    }

    /// Reserves the memory for a checkpoint with `weights` bytes of weights. Fails if the rest of the budget is too
    /// small.
    pub(crate) fn reserve_weights(&mut self, name: &str, weights: u64) -> Result<(), LocalError> {
        let needed = weights
            .saturating_add(weights / WORKING_MEMORY_SHARE.1 * WORKING_MEMORY_SHARE.0)
            .saturating_add(BASE_MEMORY_BYTES);
        let available = match self.limit_bytes {
            Some(most) => most.saturating_sub(self.taken_bytes),
            // Earlier models have already reduced the free memory, so `taken` is not subtracted.
            None => free_memory_bytes().unwrap_or(u64::MAX),
        };
        if needed > available {
            let problem = format!(
                "it needs about {} of memory and {} are left; use 16 bits (--precision bf16), a smaller model, or fewer models at once",
                format_gibibytes(needed),
                format_gibibytes(available)
            );
            return Err(LocalError::Compute { model: name.to_owned(), problem });
        }
        self.taken_bytes = self.taken_bytes.saturating_add(needed);
        Ok(())
    }
}

/// The size of a checkpoint's weights at a precision, bytes.
pub(crate) fn checkpoint_bytes(folder: &Path, precision: WeightPrecision) -> Result<u64, LocalError> {
    Ok(CheckpointWeights::open(folder, &ModelDevice::cpu(), precision)?.size_bytes())
}

/// The size of the weights of a checkpoint that is one file, at a precision, bytes.
pub(crate) fn checkpoint_file_bytes(file: &Path, precision: WeightPrecision) -> Result<u64, LocalError> {
    Ok(CheckpointWeights::open_file(file, &ModelDevice::cpu(), precision)?.size_bytes())
}

fn format_gibibytes(bytes: u64) -> String {
    format!("{:.1} GiB", bytes as f64 / (1_u64 << 30) as f64)
}

/// The free memory of the machine, bytes. `None` where the system does not report it: only Linux does.
fn free_memory_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budget_refuses_a_model_that_does_not_fit_with_the_others() {
        let mut budget = MemoryBudget::new(Some(4 << 30));
        budget.reserve_weights("hf/a/b", 1 << 30).unwrap();
        let error = budget.reserve_weights("hf/c/d", 2 << 30).unwrap_err().to_string();
        assert!(error.contains("hf/c/d") && error.contains("2.9 GiB") && error.contains("bf16"), "{error}");
        budget.reserve_weights("hf/e/f", 1 << 30).unwrap();
    }

    #[test]
    fn budget_refuses_an_impossible_size() {
        assert!(MemoryBudget::new(Some(1 << 40)).reserve_weights("hf/a/b", u64::MAX).is_err());
    }
}
