//! Grounders that score phrases by ground-truth labels instead of pictures. Their names begin with `labels`, so that no reader takes
//! their figures for those of perception.

mod encoder_grounder;
mod lexical_grounder;
mod view_labels;

pub use encoder_grounder::EncoderGrounder;
pub use lexical_grounder::LexicalGrounder;
pub(crate) use view_labels::labels_of;

/// The part of a view that a phrase is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum GrounderScope {
    /// The names of its things, and the room of the viewpoint: the whole phrase against the whole view, as CLIP does
    /// it.
    Views,
    /// Each place that the phrase names against the named boxes, without a room: as a detector does it.
    Boxes,
}

#[cfg(test)]
mod tests;
