//! What a picture is to a model, kept for the next question: a frame is asked about ten times.

use sha2::{Digest, Sha256};
use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::Image;

/// Tells pictures apart by their size and pixels.
pub(crate) fn digest(picture: &Image) -> [u8; 32] {
    let mut hash = Sha256::new();
    hash.update(picture.width_px().to_le_bytes());
    hash.update(picture.height_px().to_le_bytes());
    hash.update(picture.rgb());
    hash.finalize().into()
}

/// So many pictures are kept: a BLIP's states and keys take about 45 MB each.
const KEPT: usize = 4;

/// The latest pictures.
pub(crate) struct PictureCache<T>(Mutex<VecDeque<([u8; 32], Arc<T>)>>);

impl<T> Default for PictureCache<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> PictureCache<T> {
    /// What is kept of a picture, else what `make` makes of it.
    pub(crate) fn get<E>(&self, picture: &Image, make: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        let name = digest(picture);
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

    #[test]
    fn the_same_pixels_in_another_shape_are_another_picture() {
        let shaped = |width, height| digest(&Image::new(width, height, vec![7; 36]).unwrap());
        assert_ne!(shaped(3, 4), shaped(4, 3));
        assert_eq!(shaped(3, 4), shaped(3, 4));
    }
}
