//! Randomness that is the same on every machine and in every order of work.

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

/// A generator for one purpose. Its seed comes from the run's seed and the names of the purpose, so that an item's
/// randomness does not depend on the items before it.
#[must_use]
pub fn seeded_rng(seed: u64, purpose: &[&str]) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(derive_seed(seed, purpose))
}

/// The seed for one purpose: FNV-1a over the run's seed and the purpose's words.
#[must_use]
pub fn derive_seed(seed: u64, purpose: &[&str]) -> u64 {
    const FNV_OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const FNV_PRIME: u64 = 0x0000_0100_0000_01b3;
    // A byte that no UTF-8 has ends each word, so that ["ab", "c"] and ["a", "bc"] differ.
    let words = purpose.iter().flat_map(|word| word.bytes().chain([0xff]));
    seed.to_le_bytes()
        .into_iter()
        .chain(words)
        .fold(FNV_OFFSET_BASIS, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(FNV_PRIME))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn purposes_do_not_run_into_each_other() {
        assert_ne!(derive_seed(1, &["ab", "c"]), derive_seed(1, &["a", "bc"]));
        assert_ne!(derive_seed(1, &["ab"]), derive_seed(2, &["ab"]));
        assert_eq!(derive_seed(7, &["house"]), derive_seed(7, &["house"]));
    }
}
