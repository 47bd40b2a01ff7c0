//! API keys, which are never shown: `Debug` and `Display` print a mask, and texts of a server are scrubbed.

use std::fmt;

/// The text that replaces a key.
const KEY_MASK: &str = "***";

/// The shortest key that is removed from texts, bytes. Shorter keys are placeholders of local servers ("none",
/// "EMPTY"). Removing them from every text would damage the text.
const MIN_SCRUBBED_KEY_BYTES: usize = 8;

/// A key. Neither `Debug` nor `Display` shows it.
#[derive(Clone, PartialEq, Eq)]
pub struct ServiceSecret(String);

impl ServiceSecret {
    /// A key, without white space around it, which copying may add.
    ///
    /// # Errors
    /// When it is empty, or contains characters that an HTTP header cannot have.
    pub(crate) fn new(key: &str) -> Result<Self, &'static str> {
        let key = key.trim();
        if key.is_empty() {
            Err("is empty")
        } else if key.bytes().all(|byte| (0x21..0x7f).contains(&byte)) {
            Ok(Self(key.to_owned()))
        } else {
            Err("contains spaces or characters that no key has")
        }
    }

    /// The key from an environment variable.
    ///
    /// # Errors
    /// When the variable is not set or contains no key. The message names the variable, and never its value.
    pub(crate) fn from_env(variable: &str) -> Result<Self, String> {
        match std::env::var(variable) {
            Ok(key) => Self::new(&key).map_err(|problem| format!("the variable {variable} {problem}")),
            Err(std::env::VarError::NotPresent) => Err(format!("the variable {variable} is not set")),
            Err(std::env::VarError::NotUnicode(_)) => Err(format!("the variable {variable} is not valid text")),
        }
    }

    /// The value of the header that carries the key.
    pub(crate) fn header_value(&self, prefix: &str) -> String {
        format!("{prefix}{}", self.0)
    }

    /// A text with the key removed.
    pub(crate) fn scrub_key(&self, text: String) -> String {
        if self.0.len() >= MIN_SCRUBBED_KEY_BYTES && text.contains(&self.0) {
            text.replace(&self.0, KEY_MASK)
        } else {
            text
        }
    }
}

impl fmt::Debug for ServiceSecret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(KEY_MASK)
    }
}

impl fmt::Display for ServiceSecret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(KEY_MASK)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn secret_is_masked_in_output_and_scrubbed_from_texts() {
        let secret = ServiceSecret::new(" sk-0123456789\n").unwrap();
        assert_eq!(format!("{secret:?} {secret}"), "*** ***");
        assert_eq!(secret.scrub_key("bad key sk-0123456789!".to_owned()), "bad key ***!");
        assert_eq!(secret.header_value("Bearer "), "Bearer sk-0123456789");
        assert!(ServiceSecret::new("two words").is_err());
        assert!(ServiceSecret::new("line\nbreak").is_err());
    }

    #[test]
    fn a_placeholder_is_left_in_texts() {
        assert_eq!(ServiceSecret::new("EMPTY").unwrap().scrub_key("EMPTY room".to_owned()), "EMPTY room");
    }

    #[test]
    fn a_variable_that_is_not_set_is_named() {
        let problem = ServiceSecret::from_env("WAYWORD_NO_SUCH_KEY").unwrap_err();
        assert_eq!(problem, "the variable WAYWORD_NO_SUCH_KEY is not set");
    }
}
