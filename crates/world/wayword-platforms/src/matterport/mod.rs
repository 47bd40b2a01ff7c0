//! Matterport3D: real buildings, from the files of the dataset, its simulator and REVERIE.
//!
//! The contents of a view depend on the files that the user has. Its picture comes from skyboxes or folders of 36 views,
//! which are optional. Its labels come from REVERIE's boxes or the `.house` file, and its room from the file of rooms.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod boxes;
pub(crate) mod file_reading;
mod house_file;
mod labels;
mod layout;
mod object_positions;
mod photographs;
mod platform;
mod rooms;
mod scene;
mod thirty_six;

pub use platform::MatterportPlatform;
