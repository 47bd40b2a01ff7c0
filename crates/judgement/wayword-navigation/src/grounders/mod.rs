//! Grounders that go by labels. Named `labels` wherever they take part: they perceive nothing.

mod labels_of;
mod lexical;
mod similar;

pub use lexical::Lexical;
pub use similar::Similar;

/// What of a view a phrase is held against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sees {
    /// The names of its things, and the room in which the eye is: the whole phrase against the whole view, as CLIP does it.
    Views,
    /// Each place that the phrase names against the named boxes, without a room: as a detector does it.
    Boxes,
}

#[cfg(test)]
mod tests;
