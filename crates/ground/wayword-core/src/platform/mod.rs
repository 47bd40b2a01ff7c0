//! The traits of platforms: [`Platform`] has scenes, their graphs and views; [`Ground`], [`SceneCatalogue`] and [`SceneFiles`]
//! have what only some platforms know, and only some callers need.

mod catalogue;
mod error;
mod files;
mod ground;
#[cfg(test)]
mod tests;

pub use catalogue::SceneCatalogue;
pub use error::{PlatformError, is_lost_disk};
pub use files::SceneFiles;
pub use ground::Ground;

use crate::{CameraMotion, Frame, MotionSource, Path, SceneId, View, ViewGaze, ViewpointGraph};
use catalogue::NoCatalogue;
use files::NoFiles;
use ground::NoGround;
use serde::{Deserialize, Serialize};
use std::{ops::RangeInclusive, sync::Arc};

/// A platform: scenes with a viewpoint graph, paths through them, and views along the paths.
///
/// Blocking and object-safe; threads belong to the caller.
///
/// A platform that knows the ground, objects or files of its scenes implements these traits and returns itself from
/// [`ground`](Self::ground), [`catalogue`](Self::catalogue) or [`files`](Self::files). A wrapper returns the wrapped platform from
/// [`inner`](Self::inner), and implements only the traits with something that it changes.
pub trait Platform: Send + Sync {
    /// Its name, as `--platform` takes it.
    fn name(&self) -> &'static str;

    /// The scenes it can offer, sorted.
    ///
    /// # Errors
    /// When its data cannot be read.
    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError>;

    /// The viewpoint graph of a scene.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError>;

    /// A random path that keeps to `request`; the same seed gives the same path. Where the platform knows objects, the
    /// path's target is visible at its end.
    ///
    /// # Errors
    /// When the scene has no path that fits, or cannot be read.
    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError>;

    /// The path along all of a scene that is one walk, as a recording is; `None` for scenes through which many paths lead.
    ///
    /// # Errors
    /// When the scene does not exist or cannot be read, or has gaps that no path crosses.
    fn whole_path(&self, scene: &SceneId) -> Result<Option<Path>, PlatformError> {
        self.inner().map_or(Ok(None), |inner| inner.whole_path(scene))
    }

    /// How the camera moves over all of a scene that is one film; `None` for other scenes, and where the film has no such source.
    ///
    /// # Errors
    /// When the scene does not exist or its pictures cannot be read.
    fn film_motion(&self, scene: &SceneId, source: MotionSource) -> Result<Option<CameraMotion>, PlatformError> {
        self.inner().map_or(Ok(None), |inner| inner.film_motion(scene, source))
    }

    /// The view from a frame in one direction.
    ///
    /// # Errors
    /// When the frame is not a place of the scene, or its data cannot be read.
    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError>;

    /// The same for a caller that needs no picture: a platform that would have to read one from a file leaves it out.
    ///
    /// By default this is [`look_from`](Self::look_from), also of a wrapper, so that no wrapper that changes views passes on
    /// unchanged ones.
    ///
    /// # Errors
    /// When the frame is not a place of the scene, or its data cannot be read.
    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.look_from(scene, from, gaze)
    }

    /// The platform that this one wraps; `None` if it wraps none. Ground, objects and files come from there, unless this
    /// platform has its own.
    fn inner(&self) -> Option<&dyn Platform> {
        None
    }

    /// The ground of its scenes.
    fn ground(&self) -> &dyn Ground {
        self.inner().map_or(&NoGround, |inner| inner.ground())
    }

    /// The objects of its scenes.
    fn catalogue(&self) -> &dyn SceneCatalogue {
        self.inner().map_or(&NoCatalogue, |inner| inner.catalogue())
    }

    /// The files of its scenes.
    fn files(&self) -> &dyn SceneFiles {
        self.inner().map_or(&NoFiles, |inner| inner.files())
    }
}

/// Implements [`Platform`] for pointers to a platform.
macro_rules! forward_pointers {
    ($($pointer:ty),*) => {$(
        impl<P: Platform + ?Sized> Platform for $pointer {
            fn name(&self) -> &'static str {
                (**self).name()
            }

            fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
                (**self).list_scenes()
            }

            fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
                (**self).graph_for_scene(scene)
            }

            fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
                (**self).sample_path(scene, request, seed)
            }

            fn whole_path(&self, scene: &SceneId) -> Result<Option<Path>, PlatformError> {
                (**self).whole_path(scene)
            }

            fn film_motion(&self, scene: &SceneId, source: MotionSource) -> Result<Option<CameraMotion>, PlatformError> {
                (**self).film_motion(scene, source)
            }

            fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
                (**self).look_from(scene, from, gaze)
            }

            fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
                (**self).look_without_picture(scene, from, gaze)
            }

            fn inner(&self) -> Option<&dyn Platform> {
                (**self).inner()
            }

            fn ground(&self) -> &dyn Ground {
                (**self).ground()
            }

            fn catalogue(&self) -> &dyn SceneCatalogue {
                (**self).catalogue()
            }

            fn files(&self) -> &dyn SceneFiles {
                (**self).files()
            }
        }
    )*};
}

forward_pointers!(&P, Box<P>, Arc<P>);

/// The lengths that a random path may have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PathRequest {
    /// Number of hops on the viewpoint graph. Paths of a continuous platform have no hops: there only the length
    /// counts.
    pub hops: RangeInclusive<usize>,
    /// Length of the path, metres.
    pub length_m: RangeInclusive<f64>,
}

impl Default for PathRequest {
    /// REVERIE's own range of hops, and R2R's of lengths.
    fn default() -> Self {
        Self { hops: 4..=7, length_m: 5.0..=20.0 }
    }
}

impl PathRequest {
    /// Whether a path's length is in the range. An unknown length is not.
    #[must_use]
    pub fn allows_length_of(&self, path: &Path) -> bool {
        path.length_m().is_some_and(|length_m| self.length_m.contains(&length_m))
    }
}
