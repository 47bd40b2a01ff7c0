//! What tells one model from another where there is no commit.

use super::{hash::hex, needs::Gathered};
use crate::LocalError;
use sha2::{Digest, Sha256};
use std::{
    fs::File,
    io::{self, Read, Seek, SeekFrom},
    path::Path,
};

/// Files up to this length count whole.
const WHOLE: u64 = 1 << 20;
/// Places of a longer file that count, from its beginning to its end.
const SAMPLES: u64 = 256;
/// Bytes of each.
const SAMPLE: u64 = 4096;

/// A hash over the names, lengths and contents of the small files, and over lengths and samples of the weights. Headers stand
/// at the beginning of safetensors and GGUF files, and the checksums of a pickled file at its end: both count.
pub(super) fn identity(gathered: &Gathered) -> Result<String, LocalError> {
    let mut hasher = Sha256::new();
    for (name, path) in &gathered.small {
        add(&mut hasher, name, path)?;
    }
    for path in &gathered.weights {
        let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
        add(&mut hasher, &name, path)?;
    }
    Ok(format!("sha256:{}", hex(&hasher.finalize())))
}

fn add(hasher: &mut Sha256, name: &str, path: &Path) -> Result<(), LocalError> {
    read(hasher, name, path).map_err(|error| LocalError::io(path, "read", error))
}

fn read(hasher: &mut Sha256, name: &str, path: &Path) -> io::Result<()> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    // Lengths before contents, so that no two sets of files run together alike.
    hasher.update((name.len() as u64).to_le_bytes());
    hasher.update(name);
    hasher.update(length.to_le_bytes());
    let mut add = |at: u64, most: u64| -> io::Result<()> {
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(at))?;
        file.by_ref().take(most).read_to_end(&mut bytes)?;
        hasher.update(&bytes);
        Ok(())
    };
    if length <= WHOLE {
        return add(0, WHOLE);
    }
    let last = length - SAMPLE;
    (0..SAMPLES).try_for_each(|sample| add(scaled(last, sample), SAMPLE))
}

/// `last` for the last sample, 0 for the first, evenly between them.
fn scaled(last: u64, sample: u64) -> u64 {
    let at = u128::from(last) * u128::from(sample) / u128::from(SAMPLES - 1);
    u64::try_from(at).unwrap_or(last)
}
