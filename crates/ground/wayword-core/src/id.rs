//! Names of things that come from outside: scenes, viewpoints and objects.
//!
//! They become file names and HTML attributes later. A name that could lead to another folder or break a line is
//! therefore refused when it is read.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Longest id that is accepted, in bytes.
pub const MAX_ID_BYTES: usize = 128;

/// Why a text is not an id.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{kind} {text:?} {reason}")]
pub struct InvalidId {
    kind: &'static str,
    text: String,
    reason: &'static str,
}

/// Returns the text if it can be an id. The error quotes no more than its first 40 characters.
fn validate_id(kind: &'static str, text: String) -> Result<String, InvalidId> {
    let reason = if text.is_empty() {
        "is empty"
    } else if text.len() > MAX_ID_BYTES {
        // A test compares this number with `MAX_ID_BYTES`.
        "is longer than 128 bytes"
    } else if text.contains(['/', '\\']) || text == "." || text == ".." {
        "could name another folder: path separators are not allowed in an id"
    } else if text.chars().any(char::is_control) {
        "holds a control character"
    } else {
        return Ok(text);
    };
    let text = text.chars().take(40).collect();
    Err(InvalidId { kind, text, reason })
}

macro_rules! id_type {
    ($(#[$doc:meta])* $name:ident, $kind:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(try_from = "String", into = "String")]
        pub struct $name(String);

        impl $name {
            /// Accepts `text` as an id.
            ///
            /// # Errors
            /// When it is empty, longer than [`MAX_ID_BYTES`], or holds a path separator or a control character.
            pub fn new(text: impl Into<String>) -> Result<Self, InvalidId> {
                validate_id($kind, text.into()).map(Self)
            }

            /// The id as text.
            #[must_use]
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl TryFrom<String> for $name {
            type Error = InvalidId;
            fn try_from(text: String) -> Result<Self, InvalidId> {
                Self::new(text)
            }
        }

        impl From<$name> for String {
            fn from(id: $name) -> String {
                id.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }
    };
}

id_type!(
    /// A scene: a Matterport3D scan, a generated house, a simulator's level.
    SceneId,
    "scene"
);
id_type!(
    /// A node of a scene's viewpoint graph.
    ViewpointId,
    "viewpoint"
);
id_type!(
    /// An object, unique within its scene.
    ObjectId,
    "object"
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_that_could_leave_a_folder_are_refused() {
        for bad in ["", "..", ".", "a/b", "..\\x", "line\nbreak", &"x".repeat(MAX_ID_BYTES + 1)] {
            assert!(SceneId::new(bad).is_err(), "{bad:?} was accepted");
        }
        let too_long = SceneId::new("x".repeat(MAX_ID_BYTES + 1)).unwrap_err().to_string();
        assert!(too_long.contains(&format!("{MAX_ID_BYTES} bytes")), "{too_long}");
        assert_eq!(SceneId::new("a-scan_7").unwrap().as_str(), "a-scan_7");
    }

    #[test]
    fn deserialising_validates_too() {
        assert!(serde_json::from_str::<ViewpointId>("\"../etc\"").is_err());
        assert!(serde_json::from_str::<ViewpointId>("\"abc\"").is_ok());
    }
}
