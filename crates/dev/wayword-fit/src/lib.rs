//! Fits the weights that ship with the program to people's texts of training splits, and prints how they do on buildings that were left
//! out.
//!
//! # Where things are
//! - [`fit_alignment`]: the weights of the alignment, `alignment/fitted.json` of `wayword-follower`, and its figures by people's stretches.
//! - [`fit_evidence`]: the weights of the checks in an open world, `open/weights.toml` of `wayword-checks`.
//! - [`logistic`]: logistic regression.
//! - [`fit_follower`]: the weights of the follower, with the map and without, and the table by which its thresholds are chosen.
//! - [`fit_wording`]: the constructions of `style/builtin/way.toml` of `wayword-synthesis`, with how often people use them.

pub mod fit_alignment;
pub mod fit_evidence;
pub mod fit_follower;
pub mod fit_wording;
pub mod logistic;
mod matterport;
