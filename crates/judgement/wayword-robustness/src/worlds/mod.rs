//! Changes of worlds, cameras and pictures, as wrappers over any platform.

mod altered_platform;
mod camera;
mod edits;
mod eye;
mod heading_noise;
mod labels;
mod pictures;
mod space;
#[cfg(test)]
mod testing;
mod things;
mod tilt;

pub use altered_platform::{AlteredLook, AlteredPlatform, WorldAlteration};
pub use camera::{CameraHeight, FieldOfView};
pub use edits::{MentionedThing, PathLabels, PathText, can_be_removed};
pub use eye::{EyeQuality, ScriptedEye};
pub use heading_noise::HeadingNoise;
pub use pictures::PictureChange;
pub use space::{QuarterTurn, WorldMirror};
pub use things::{ThingAddition, ThingRecolouring, ThingRemoval};
pub use tilt::{CameraTilt, TiltError};
