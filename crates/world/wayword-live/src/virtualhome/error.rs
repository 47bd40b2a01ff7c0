//! Errors of VirtualHome's executable.

/// The reason why a request to VirtualHome failed.
#[derive(Debug, thiserror::Error)]
pub enum HomeError {
    /// The simulator does not answer.
    #[error(
        "action {action}: {reason}; start VirtualHome with -batchmode -http-port=PORT, where PORT is the port in --at"
    )]
    Unreachable {
        /// The requested action.
        action: &'static str,
        /// The error of the connection.
        reason: String,
    },
    /// An answer with another status than 200.
    #[error("action {action}: the simulator answered with status {status}: {message}")]
    Status {
        /// The requested action.
        action: &'static str,
        /// The HTTP status.
        status: u16,
        /// The beginning of its message.
        message: String,
    },
    /// The simulator reports that the action failed.
    #[error("action {action}: the simulator says that it failed: {message}")]
    Failed {
        /// The requested action.
        action: &'static str,
        /// The beginning of its message.
        message: String,
    },
    /// An answer that cannot be read.
    #[error("action {action}: the answer is not {expected}: {reason}")]
    Malformed {
        /// The requested action.
        action: &'static str,
        /// The expected content.
        expected: &'static str,
        /// The reason, with the position where it is known.
        reason: String,
    },
    /// A home in which the agent cannot walk.
    #[error("the home's graph {0}")]
    Floor(String),
}
