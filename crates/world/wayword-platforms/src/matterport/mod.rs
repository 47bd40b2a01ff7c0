//! Matterport3D: real buildings, as the dataset, its simulator and REVERIE ship them.
//!
//! What there is to see depends on what the user has: photographs (skyboxes or 36-view folders), or none at all, and then
//! REVERIE's boxes, the `.house` file and the rooms of the viewpoints carry the perception.

mod boxes;
mod connectivity;
mod house_file;
mod labels;
mod layout;
mod levels;
mod object_positions;
mod photographs;
mod platform;
pub(crate) mod read;
mod rooms;
mod scene;
mod thirty_six;

pub use platform::Matterport;
