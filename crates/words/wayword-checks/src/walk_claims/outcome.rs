//! What is found about a claim.

/// Whether a claim holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ClaimOutcome {
    /// It holds, at this frame.
    Holds(usize),
    /// It does not hold.
    Fails(String),
    /// No witness confirms it there, but these leave things out.
    IsDoubtful,
    /// It cannot be decided.
    Unknown(String),
    /// Another check decides it: whether there is such a thing along the walk at all.
    Unjudged,
}
