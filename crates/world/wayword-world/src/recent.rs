//! A small memory of what was read last.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, PoisonError},
};

/// The last few values that were made, by key; the one that was not asked for longest is forgotten first.
pub struct Recent<K, V> {
    capacity: usize,
    kept: Mutex<VecDeque<(K, Arc<V>)>>,
}

impl<K: PartialEq, V> Recent<K, V> {
    /// Nothing remembered yet.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        Self { capacity, kept: Mutex::new(VecDeque::new()) }
    }

    /// The value of a key, made if it is not remembered. Two threads that ask at once may both make it, and the
    /// first one's counts.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn get_or_make<E>(&self, key: K, make: impl FnOnce() -> Result<V, E>) -> Result<Arc<V>, E> {
        if let Some(value) = self.recall(&key) {
            return Ok(value);
        }
        let value = Arc::new(make()?);
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, made)) = kept.iter().find(|(other, _)| *other == key) {
            return Ok(Arc::clone(made));
        }
        kept.push_back((key, Arc::clone(&value)));
        while kept.len() > self.capacity {
            kept.pop_front();
        }
        Ok(value)
    }

    fn recall(&self, key: &K) -> Option<Arc<V>> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let index = kept.iter().position(|(other, _)| other == key)?;
        let entry = kept.remove(index)?;
        let value = Arc::clone(&entry.1);
        kept.push_back(entry);
        Some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn what_was_asked_for_lately_is_not_made_again() {
        let recent = Recent::new(2);
        let made = Cell::new(0);
        let get = |key: u32| {
            let value = recent.get_or_make(key, || {
                made.set(made.get() + 1);
                Ok::<_, ()>(key * 10)
            });
            *value.unwrap()
        };
        assert_eq!([get(1), get(2), get(1), get(3), get(1)], [10, 20, 10, 30, 10]);
        assert_eq!(made.get(), 3);
        get(2);
        assert_eq!(made.get(), 4, "2 was the longest unasked for when 3 came");
    }
}
