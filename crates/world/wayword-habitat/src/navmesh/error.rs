//! Why a file is not a navmesh.

/// What is wrong with a `.navmesh` file, and at which byte.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NavMeshError {
    /// The file ends too early.
    #[error(
        "byte {offset}: {what} needs {needed} bytes, and {left} are left: the file is cut off; copy or bake it again"
    )]
    Short {
        /// Where the missing thing begins.
        offset: usize,
        /// What was to be read.
        what: &'static str,
        /// Bytes that it takes.
        needed: u64,
        /// Bytes that the file still has.
        left: usize,
    },
    /// A value that cannot be.
    #[error("byte {offset}: {what} is {found}, expected {expected}")]
    Value {
        /// Where the value stands.
        offset: usize,
        /// What it is.
        what: &'static str,
        /// The value.
        found: String,
        /// What would do, and what to do where that is known.
        expected: String,
    },
}

impl NavMeshError {
    pub(crate) fn value(
        offset: usize,
        what: &'static str,
        found: impl std::fmt::Display,
        expected: impl Into<String>,
    ) -> Self {
        Self::Value { offset, what, found: found.to_string(), expected: expected.into() }
    }
}
