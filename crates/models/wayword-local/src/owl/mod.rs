//! OWLv2: finds things in pictures by any phrases. It has the towers of CLIP, and gives each patch a class and a box.
//!
//! A picture and a phrase meet only in a product of vectors. So a picture is computed once for all phrases, and the
//! score of a phrase does not depend on the other phrases. The network is implemented as in transformers 5.23.

mod boxes;
mod heads;
mod model;
mod picture;

pub use model::{OwlDetector, OwlOutputs};

/// The most memory for the features of recent pictures, bytes. The oldest are dropped beyond this.
pub(crate) const FEATURE_CACHE_BYTES: usize = 256 << 20;
