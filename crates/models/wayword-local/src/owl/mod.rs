//! OWLv2: finds things in pictures by any phrases. Towers like CLIP's, with a class and a box for each patch.
//!
//! A picture and a phrase meet only in a product of vectors, so a picture is computed once for all phrases, and a phrase
//! scores the same whatever else is looked for. Facts about the network are those of transformers 5.23.

mod boxes;
mod heads;
mod model;
mod picture;

pub use model::{Owl, OwlOutputs};

/// The bytes of pictures' features that an OWLv2 keeps.
pub(crate) const KEPT_BYTES: usize = 256 << 20;
