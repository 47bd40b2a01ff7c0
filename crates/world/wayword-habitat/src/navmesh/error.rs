//! The errors of the navmesh reader.

/// The fault of a `.navmesh` file, and the byte at which it is.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NavMeshError {
    /// The file ends too early.
    #[error(
        "byte {offset}: {what} needs {needed} bytes, and {left} are left: the file is cut off; copy or bake it again"
    )]
    Short {
        /// Where the incomplete item begins.
        offset: usize,
        /// The item that the reader expected there.
        what: &'static str,
        /// Bytes that it needs.
        needed: u64,
        /// Bytes that the file still has.
        left: usize,
    },
    /// A value that is not allowed.
    #[error("byte {offset}: {what} is {found}, expected {expected}")]
    Value {
        /// Where the value is.
        offset: usize,
        /// The name of the value.
        what: &'static str,
        /// The value.
        found: String,
        /// The allowed values, and a remedy if one is known.
        expected: String,
    },
}

impl NavMeshError {
    pub(crate) fn bad_value(
        offset: usize,
        what: &'static str,
        found: impl std::fmt::Display,
        expected: impl Into<String>,
    ) -> Self {
        Self::Value { offset, what, found: found.to_string(), expected: expected.into() }
    }
}
