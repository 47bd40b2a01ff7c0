//! Matterport3D: real buildings, as the dataset, its simulator and REVERIE provide them.
//!
//! What a view shows depends on the files that the user has: photographs (skyboxes or 36-view folders), and labels from
//! REVERIE's boxes, the `.house` file and the rooms of the viewpoints. Photographs are optional.

mod boxes;
mod house_file;
mod labels;
mod layout;
mod object_positions;
mod photographs;
mod platform;
pub(crate) mod read;
mod rooms;
mod scene;
mod thirty_six;

pub use platform::Matterport;
