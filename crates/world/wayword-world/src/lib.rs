//! Code that all platforms share.
//!
//! Reading: [`files`] reads third-party files up to a size limit, and [`output_lines`] reads the output of a child process or a
//! socket in the same way. [`connectivity`] reads viewpoint graphs in Matterport's format, and [`json_values`] takes values
//! out of JSON.
//!
//! Paths: [`open_ground`] draws random paths over open ground, and [`graph_walk`] along a viewpoint graph. [`grid_search`]
//! finds shortest ways over a grid. [`episode_path`] turns an episode's viewpoints into a path, and [`floor_path`] positions
//! on a floor. [`graph_route`] finds the route over the viewpoints for a path that lies between them.
//!
//! Scenes: [`survey_scene`](mod@survey) collects the rooms and objects at all viewpoints, and [`seen_from`](mod@seen_from)
//! finds the viewpoints that show an object. [`levels`] finds the storeys of viewpoints. [`object_names`] and [`region_letters`]
//! turn the names and letters of Matterport3D's annotators, which other scenes use too, into everyday words.
//!
//! Architecture invariant: no code here depends on a single platform.

pub mod connectivity;
mod credentials;
pub mod episode_path;
pub mod files;
pub mod floor_path;
pub mod graph_route;
pub mod graph_walk;
pub mod grid_search;
pub mod json_values;
pub mod levels;
pub mod object_names;
pub mod open_ground;
pub mod output_lines;
pub mod picture_end;
pub mod region_letters;
pub mod seen_from;
pub mod survey;

pub use credentials::mask_credentials;
pub use episode_path::{labels_around, path_over_viewpoints};
pub use floor_path::frames_over_floor;
pub use graph_route::route_along_frames;
pub use seen_from::seen_from;
pub use survey::survey_scene;
