//! Code that all platforms share.
//!
//! [`files`] reads third-party files up to a size limit. [`said`] does the same for the output of a child process or a
//! socket. [`wander`] makes random paths over open ground, and [`graph_walk`] along a viewpoint graph. [`grid_search`]
//! finds shortest ways over a grid, and [`episode_path`] turns an episode of a dataset into a path.
//! [`seen_from`](mod@seen_from) finds the viewpoints that show an object. [`object_names`] and [`region`] put the names
//! and letters of Matterport3D's annotators, which other scenes have too, into everyday words. [`survey`](mod@survey) gathers
//! what is known of all viewpoints of a scene. [`connectivity`] reads viewpoint graphs in Matterport's format, [`levels`] finds
//! their storeys, and [`values`] takes values out of JSON.
//!
//! Architecture invariant: nothing here depends on a single platform.

pub mod connectivity;
pub mod episode_path;
pub mod files;
pub mod graph_walk;
pub mod grid_search;
pub mod levels;
pub mod object_names;
pub mod region;
pub mod said;
pub mod seen_from;
pub mod survey;
pub mod values;
pub mod wander;

pub use episode_path::{labels_around, path_of};
pub use seen_from::seen_from;
pub use survey::survey;
