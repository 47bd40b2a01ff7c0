//! Recordings of robots and phones: pictures in the order of their times, with or without poses.
//!
//! Every kind of recording (`folder`, `video`, `mcap`, `lerobot`) provides the same: pictures, their times, and the track
//! of the camera if it is known (`reel`). From then on all kinds are treated alike. `choose` picks frames at equal
//! distances or times and leaves out blurred and repeated pictures. [`RecordingPlatform`] makes paths of these frames.
//!
//! # Where things are
//! - `open`: which kind of recording a path is.
//! - `file_kind`: files that cannot be read, by their first bytes, and the advice for each.
//! - `poses/`: one file for each format of poses; `poses/find.rs` has the names that are looked for, `axes` their conventions.
//! - `pose_reading`, `pose_plausibility`: the ways to read a pose, and when another way than the present one is likely.
//! - `photographs`: which pictures are depth maps or masks.
//! - `describe`: the keys of `recording.toml`.
//! - `choose/`: which pictures become frames.
//! - `film_motion/`: how the camera moves from picture to picture, by poses or by the pictures.
//! - `training_walks/`: walks of StreamVLN's, NaVILA's and InternNav's training data.
//! - `mcap/topics.rs`, `lerobot/camera.rs`, `lerobot/pose_feature.rs`: which camera and which poses are taken.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod axes;
mod choose;
mod describe;
mod file_kind;
mod film_motion;
mod folder;
#[cfg(feature = "lerobot")]
mod lerobot;
#[cfg(feature = "mcap")]
mod mcap;
mod names;
mod open;
mod photographs;
#[cfg(any(feature = "mcap", feature = "video"))]
mod picture_size;
mod platform;
mod pose_plausibility;
mod pose_reading;
mod poses;
mod reel;
mod shelf;
mod track;
mod training_walks;
#[cfg(feature = "video")]
mod video;

pub use film_motion::estimate_film_steps;
pub use platform::{MAX_OPEN_RECORDINGS, RecordingPlatform};
