//! What all platforms share.
//!
//! [`files`] reads other people's files with a bound. [`said`] reads what a child or a socket says, likewise. [`wander`] walks at
//! random over open ground, [`graph_walk`] along a viewpoint graph; [`grid_search`] finds shortest ways over a grid, and
//! [`episode_path`] turns an episode of a dataset into a path.
//! [`seen_from`](mod@seen_from) tells which viewpoints show an object. [`object_names`] and [`region`] put into plain words what Matterport3D's annotators wrote, which other scenes carry too.
//!
//! Architecture invariant: nothing here knows one platform.

pub mod episode_path;
pub mod files;
pub mod graph_walk;
pub mod grid_search;
pub mod object_names;
pub mod region;
pub mod said;
pub mod seen_from;
pub mod wander;

pub use episode_path::{labels_around, path_of};
pub use seen_from::seen_from;
