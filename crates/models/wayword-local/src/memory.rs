//! Refuses to load a model that would not fit into the memory.
//!
//! An estimate is made before a checkpoint is read, because a process that runs out of memory is killed without an
//! error.

use crate::{Device, LocalError, Precision, weights::Weights};
use std::path::Path;

/// The memory that a model needs in addition to its weights: a share of their size (3/10, as numerator and
/// denominator), and a fixed number of bytes.
const BESIDE: (u64, u64) = (3, 10);
const BASE: u64 = 300 << 20;

/// Counts the memory that models have taken, against a limit.
#[derive(Debug, Default)]
pub(crate) struct Budget {
    /// The user's limit, bytes.
    most: Option<u64>,
    taken: u64,
}

impl Budget {
    /// A budget of `most` bytes. Without a number, the limit is the free memory of the machine when a model is loaded.
    pub(crate) fn new(most: Option<u64>) -> Self {
        Self { most, taken: 0 }
    }

    /// Reserves the memory for a checkpoint.
    pub(crate) fn take(&mut self, name: &str, weights: u64) -> Result<(), LocalError> {
        let needs = weights.saturating_add(weights / BESIDE.1 * BESIDE.0).saturating_add(BASE);
        let left = match self.most {
            Some(most) => most.saturating_sub(self.taken),
            // Earlier models have already reduced the free memory, so `taken` is not subtracted.
            None => free().unwrap_or(u64::MAX),
        };
        if needs > left {
            let problem = format!(
                "it needs about {} of memory and {} are left; use 16 bits (--precision bf16), a smaller model, or fewer models at once",
                gibibytes(needs),
                gibibytes(left)
            );
            return Err(LocalError::Compute { model: name.to_owned(), problem });
        }
        self.taken = self.taken.saturating_add(needs);
        Ok(())
    }
}

/// The size of a checkpoint's weights at a precision, bytes.
pub(crate) fn of_checkpoint(folder: &Path, precision: Precision) -> Result<u64, LocalError> {
    Ok(Weights::open(folder, &Device::cpu(), precision)?.bytes())
}

/// The same for a checkpoint that is one file.
pub(crate) fn of_file(file: &Path, precision: Precision) -> Result<u64, LocalError> {
    Ok(Weights::of_file(file, &Device::cpu(), precision)?.bytes())
}

fn gibibytes(bytes: u64) -> String {
    format!("{:.1} GiB", bytes as f64 / (1_u64 << 30) as f64)
}

/// The free memory of the machine, bytes, where the system reports it (Linux).
fn free() -> Option<u64> {
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
        let mut budget = Budget::new(Some(4 << 30));
        budget.take("hf/a/b", 1 << 30).unwrap();
        let error = budget.take("hf/c/d", 2 << 30).unwrap_err().to_string();
        assert!(error.contains("hf/c/d") && error.contains("2.9 GiB") && error.contains("bf16"), "{error}");
        budget.take("hf/e/f", 1 << 30).unwrap();
    }

    #[test]
    fn budget_refuses_an_impossible_size() {
        assert!(Budget::new(Some(1 << 40)).take("hf/a/b", u64::MAX).is_err());
    }
}
