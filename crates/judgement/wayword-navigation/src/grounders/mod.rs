//! Grounders that use labels. They are called `labels` wherever they take part, because they perceive nothing.

mod labels_of;
mod lexical;
mod similar;

pub(crate) use labels_of::labels_of;
pub use lexical::Lexical;
pub use similar::Similar;

/// What of a view a phrase is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sees {
    /// The names of its things, and the room of the viewpoint: the whole phrase against the whole view, as CLIP does
    /// it.
    Views,
    /// Each place that the phrase names against the named boxes, without a room: as a detector does it.
    Boxes,
}

#[cfg(test)]
mod tests;
