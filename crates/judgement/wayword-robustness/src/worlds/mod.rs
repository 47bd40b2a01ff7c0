//! Changes of worlds, cameras and pictures, as wrappers over any platform.

mod altered;
mod camera;
mod edits;
mod eye;
mod labels;
mod pictures;
mod poses;
mod space;
#[cfg(test)]
mod testing;
mod things;
mod tilt;

pub use altered::{Alter, Altered, Look};
pub use camera::{CameraHeight, FieldOfView};
pub use edits::{Labelled, Telling, Thing, can_go};
pub use eye::{EyeOf, ScriptedEye};
pub use pictures::PictureChange;
pub use poses::HeadingNoise;
pub use space::{Mirror, QuarterTurn};
pub use things::{Added, Recoloured, Removed};
pub use tilt::{Tilt, TiltError};
