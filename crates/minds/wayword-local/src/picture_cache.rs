//! What a picture is to a model, kept for the next question: a frame is asked about ten times.

use crate::kept::hash;
use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::Image;

/// So many pictures are kept: a BLIP's states and keys take about 45 MB each.
const KEPT: usize = 4;

/// The latest pictures.
pub(crate) struct PictureCache<T>(Mutex<VecDeque<(String, Arc<T>)>>);

impl<T> Default for PictureCache<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> PictureCache<T> {
    /// What is kept of a picture, else what `make` makes of it.
    pub(crate) fn get<E>(&self, picture: &Image, make: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        let name = hash(picture);
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let at = kept.iter().position(|(known, _)| *known == name);
        if let Some(found) = at.and_then(|at| kept.remove(at)) {
            let value = Arc::clone(&found.1);
            kept.push_front(found);
            return Ok(value);
        }
        let made = Arc::new(make()?);
        kept.push_front((name, Arc::clone(&made)));
        kept.truncate(KEPT);
        Ok(made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(red: u8) -> Image {
        Image::new(1, 1, vec![red, 0, 0]).unwrap()
    }

    #[test]
    fn a_picture_is_made_once_and_old_ones_go() {
        let cache = PictureCache::default();
        let get = |red| {
            let mut made = false;
            let make = || {
                made = true;
                Ok::<_, ()>(red)
            };
            assert_eq!(*cache.get(&picture(red), make).unwrap(), red);
            made
        };
        assert!(get(1) && !get(1));
        assert!((2..10).all(get));
        assert!(get(1));
    }

    #[test]
    fn what_failed_is_not_kept() {
        let cache = PictureCache::default();
        assert!(cache.get(&picture(1), || Err(())).is_err());
        assert_eq!(*cache.get(&picture(1), || Ok::<_, ()>(5)).unwrap(), 5);
    }
}
