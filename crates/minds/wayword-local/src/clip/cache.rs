//! Vectors that were computed before.

use sha2::{Digest, Sha256};
use std::{collections::BTreeMap, sync::Arc};

/// A vector, shared with who asked for it.
pub(super) type Vector = Arc<[f32]>;

/// What a vector is of: a hash of its content.
pub(super) type Key = [u8; 32];

/// So many vectors, those that were used last.
pub(super) struct Cache {
    most: usize,
    /// Vectors, and when each was used last.
    vectors: BTreeMap<Key, (u64, Vector)>,
    by_use: BTreeMap<u64, Key>,
    uses: u64,
}

/// Of a text.
pub(super) fn key_of_text(text: &str) -> Key {
    Sha256::digest(text).into()
}

impl Cache {
    /// Of at most so many vectors.
    pub(super) fn new(most: usize) -> Self {
        Self { most, vectors: BTreeMap::new(), by_use: BTreeMap::new(), uses: 0 }
    }

    pub(super) fn get(&mut self, key: &Key) -> Option<Vector> {
        let (used, vector) = self.vectors.get_mut(key)?;
        self.by_use.remove(used);
        self.uses += 1;
        *used = self.uses;
        self.by_use.insert(self.uses, *key);
        Some(vector.clone())
    }

    pub(super) fn put(&mut self, key: Key, vector: Vector) {
        self.uses += 1;
        if let Some((used, _)) = self.vectors.insert(key, (self.uses, vector)) {
            self.by_use.remove(&used);
        }
        self.by_use.insert(self.uses, key);
        while self.vectors.len() > self.most
            && let Some((_, oldest)) = self.by_use.pop_first()
        {
            self.vectors.remove(&oldest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(number: f32) -> Vector {
        Arc::from([number])
    }

    #[test]
    fn what_was_not_used_longest_goes_first() {
        let mut cache = Cache::new(2);
        let [a, b, c] = ["a", "b", "c"].map(key_of_text);
        cache.put(a, of(1.0));
        cache.put(b, of(2.0));
        assert_eq!(cache.get(&a), Some(of(1.0)));
        cache.put(c, of(3.0));
        assert_eq!([a, b, c].map(|key| cache.get(&key)), [Some(of(1.0)), None, Some(of(3.0))]);
        assert_eq!((cache.vectors.len(), cache.by_use.len()), (2, 2));
    }

    #[test]
    fn what_is_put_twice_counts_once() {
        let mut cache = Cache::new(2);
        let [a, b] = ["a", "b"].map(key_of_text);
        for number in [1.0, 2.0, 3.0] {
            cache.put(a, of(number));
        }
        cache.put(b, of(4.0));
        assert_eq!([a, b].map(|key| cache.get(&key)), [Some(of(3.0)), Some(of(4.0))]);
        assert_eq!(cache.by_use.len(), 2);
    }
}
