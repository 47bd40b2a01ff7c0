//! A small cache. When it is full, it drops the value that was used least recently.

use hashlink::LruCache;
use std::{
    collections::HashMap,
    fmt,
    hash::Hash,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

/// A cache of a few values by key, for several threads. When it is full, the value that was asked for least recently is
/// dropped.
pub struct RecentCache<K, V> {
    entries: Mutex<RecentEntries<K, V>>,
    /// The lock of the thread that makes a value, where one is made at a time.
    single_maker_lock: Option<Arc<Mutex<()>>>,
}

struct RecentEntries<K, V> {
    kept: LruCache<K, Arc<V>>,
    /// For each value that is being made, the lock of the thread that makes it.
    making: HashMap<K, Arc<Mutex<()>>>,
}

impl<K: Clone + Eq + Hash, V> RecentCache<K, V> {
    /// An empty cache for at most `capacity` values. Values of different keys may be made at the same time.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        let shelf = RecentEntries { kept: LruCache::new(capacity), making: HashMap::new() };
        Self { entries: Mutex::new(shelf), single_maker_lock: None }
    }

    /// The same for values that take much memory to make: one is made at a time.
    #[must_use]
    pub fn one_at_a_time(capacity: usize) -> Self {
        Self { single_maker_lock: Some(Arc::default()), ..Self::new(capacity) }
    }

    /// The value of a key, if the cache has it.
    pub fn get(&self, key: &K) -> Option<Arc<V>> {
        self.lock_entries().kept.get(key).map(Arc::clone)
    }

    /// Keeps a value and returns it. Where the key has a value already, that one is kept and returned.
    pub fn put(&self, key: K, value: V) -> Arc<V> {
        self.lock_entries().put_entry(key, value)
    }

    /// The value of a key; it is made if the cache does not have it. A thread that asks for it meanwhile waits and gets
    /// the same value. `make` must not ask this cache for a value that has to be made; it may [`put`](Self::put)
    /// others.
    ///
    /// # Errors
    /// When it cannot be made. Then the cache stays as it is, and the next caller tries again.
    pub fn get_or_make<E>(&self, key: K, make: impl FnOnce() -> Result<V, E>) -> Result<Arc<V>, E> {
        let maker_lock = {
            let mut shelf = self.lock_entries();
            if let Some(value) = shelf.kept.get(&key) {
                return Ok(Arc::clone(value));
            }
            match &self.single_maker_lock {
                Some(alone) => Arc::clone(alone),
                None => Arc::clone(shelf.making.entry(key.clone()).or_default()),
            }
        };
        let _making = maker_lock.lock().unwrap_or_else(PoisonError::into_inner);
        // Another thread may have made it in the meantime.
        if let Some(value) = self.get(&key) {
            return Ok(value);
        }
        let made = make();
        let mut shelf = self.lock_entries();
        // Where it failed and threads wait for this lock, one of them tries next. The entry stays, so that later
        // callers queue behind them. Without waiting threads there are two pointers to the lock: ours and the entry's.
        if made.is_ok() || Arc::strong_count(&maker_lock) <= 2 {
            shelf.making.remove(&key);
        }
        Ok(shelf.put_entry(key, made?))
    }

    fn lock_entries(&self) -> MutexGuard<'_, RecentEntries<K, V>> {
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<K: Eq + Hash, V> RecentEntries<K, V> {
    fn put_entry(&mut self, key: K, value: V) -> Arc<V> {
        if let Some(first) = self.kept.get(&key) {
            return Arc::clone(first);
        }
        let value = Arc::new(value);
        self.kept.insert(key, Arc::clone(&value));
        value
    }
}

impl<K, V> fmt::Debug for RecentCache<K, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recent").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{
        cell::Cell,
        sync::{
            Barrier,
            atomic::{AtomicUsize, Ordering},
        },
        thread,
        time::Duration,
    };

    #[test]
    fn get_or_make_keeps_recent_values() {
        let recent = RecentCache::new(2);
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

    #[test]
    fn the_value_unused_for_longest_is_dropped_first() {
        let recent = RecentCache::new(2);
        recent.put("a", 1);
        recent.put("b", 2);
        assert_eq!(recent.get(&"a").as_deref(), Some(&1));
        recent.put("c", 3);
        assert_eq!(["a", "b", "c"].map(|key| recent.get(&key).as_deref().copied()), [Some(1), None, Some(3)]);
    }

    #[test]
    fn put_keeps_the_first_of_two_values() {
        let recent = RecentCache::new(2);
        assert_eq!([1, 2, 3].map(|number| *recent.put("a", number)), [1, 1, 1]);
        recent.put("b", 4);
        assert_eq!(["a", "b"].map(|key| recent.get(&key).as_deref().copied()), [Some(1), Some(4)]);
    }

    #[test]
    fn get_or_make_keeps_no_failure() {
        let recent = RecentCache::new(2);
        assert!(recent.get_or_make(1, || Err(())).is_err());
        assert_eq!(recent.get(&1), None);
        assert_eq!(*recent.get_or_make(1, || Ok::<_, ()>(5)).unwrap(), 5);
        assert!(recent.lock_entries().making.is_empty());
    }

    #[test]
    fn a_value_is_made_once_while_others_wait_for_it() {
        for recent in [RecentCache::new(4), RecentCache::one_at_a_time(4)] {
            let (made, together) = (AtomicUsize::new(0), Barrier::new(8));
            let get = || {
                together.wait();
                let make = || {
                    thread::sleep(Duration::from_millis(20));
                    Ok::<_, ()>(made.fetch_add(1, Ordering::SeqCst))
                };
                *recent.get_or_make("key", make).unwrap()
            };
            let values = thread::scope(|scope| {
                let threads: Vec<_> = (0..8).map(|_| scope.spawn(get)).collect();
                threads.into_iter().map(|thread| thread.join().unwrap()).collect::<Vec<_>>()
            });
            assert_eq!((values, made.into_inner()), (vec![0; 8], 1));
        }
    }

    #[test]
    fn values_of_other_keys_are_made_side_by_side_or_one_at_a_time() {
        let most_at_once = |recent: &RecentCache<usize, ()>| {
            let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let make = || {
                most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                thread::sleep(Duration::from_millis(50));
                now.fetch_sub(1, Ordering::SeqCst);
                Ok::<_, ()>(())
            };
            thread::scope(|scope| {
                (0..4).for_each(|key| drop(scope.spawn(move || drop(recent.get_or_make(key, make)))));
            });
            most.into_inner()
        };
        assert_eq!(most_at_once(&RecentCache::one_at_a_time(4)), 1);
        assert!(most_at_once(&RecentCache::new(4)) > 1);
    }

    #[test]
    fn make_may_put_other_values() {
        let recent = RecentCache::new(4);
        let made = recent.get_or_make(1, || {
            recent.put(2, "read along");
            Ok::<_, ()>("asked for")
        });
        assert_eq!((*made.unwrap(), recent.get(&2).as_deref()), ("asked for", Some(&"read along")));
    }
}
