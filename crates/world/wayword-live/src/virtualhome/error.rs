//! What can go wrong with VirtualHome.

/// Why VirtualHome does not give what it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum HomeError {
    /// The simulator does not answer.
    #[error(
        "action {action}: {reason}; start VirtualHome with -batchmode -http-port=PORT, where PORT is the port in --at"
    )]
    Unreachable {
        /// What was asked.
        action: &'static str,
        /// What happened.
        reason: String,
    },
    /// An answer with another status than 200.
    #[error("action {action}: the simulator answered with status {status}: {message}")]
    Status {
        /// What was asked.
        action: &'static str,
        /// The HTTP status.
        status: u16,
        /// The beginning of what it said.
        message: String,
    },
    /// The simulator says that the action failed.
    #[error("action {action}: the simulator says that it failed: {message}")]
    Failed {
        /// What was asked.
        action: &'static str,
        /// The beginning of what it said.
        message: String,
    },
    /// An answer that cannot be read.
    #[error("action {action}: the answer is not {expected}: {reason}")]
    Malformed {
        /// What was asked.
        action: &'static str,
        /// What it should be.
        expected: &'static str,
        /// What is wrong, and where.
        reason: String,
    },
    /// A home in which the agent cannot walk.
    #[error("the home's graph {0}")]
    Floor(String),
}
