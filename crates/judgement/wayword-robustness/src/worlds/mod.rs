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

pub use altered::{AlteredLook, AlteredPlatform, WorldAlteration};
pub use camera::{CameraHeight, FieldOfView};
pub use edits::{MentionedThing, PathLabels, PathText, can_go};
pub use eye::{EyeQuality, ScriptedEye};
pub use pictures::PictureChange;
pub use poses::HeadingNoise;
pub use space::{QuarterTurn, WorldMirror};
pub use things::{ThingAddition, ThingRecolouring, ThingRemoval};
pub use tilt::{CameraTilt, TiltError};
