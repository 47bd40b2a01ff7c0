//! Which values a launcher takes. Each check names the option that the value came from.

use super::LaunchError;

/// Whether a text has a character that ends a line, or that no one can see.
pub(super) fn has_control(text: &str) -> bool {
    text.chars().any(|c| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}'))
}

/// An error about a value. Control characters are shown escaped.
pub(super) fn value_error(option: &'static str, value: &str, problem: &str, hint: &'static str) -> LaunchError {
    let shown: String = value.chars().take(100).collect();
    LaunchError::Value { option, problem: format!("{shown:?} {problem}"), hint }
}

/// Checks that a text is not empty and has no control characters.
pub(super) fn check_text(option: &'static str, value: &str) -> Result<(), LaunchError> {
    match value.is_empty() || has_control(value) {
        true => {
            Err(value_error(option, value, "is empty, or has a line break or another control character", "take it out"))
        }
        false => Ok(()),
    }
}

/// Checks that a text has only ASCII letters, digits and the characters in `marks`, and does not begin with a hyphen.
pub(super) fn check_word(option: &'static str, value: &str, marks: &str) -> Result<(), LaunchError> {
    let fits = |c: char| c.is_ascii_alphanumeric() || marks.contains(c);
    match !value.is_empty() && !value.starts_with('-') && value.chars().all(fits) {
        true => Ok(()),
        false => {
            Err(value_error(option, value, "has a character that is not allowed here", "use ASCII letters and digits"))
        }
    }
}

/// Checks the name of an environment variable.
pub(super) fn check_variable(option: &'static str, value: &str) -> Result<(), LaunchError> {
    match !value.starts_with(|c: char| c.is_ascii_digit()) && check_word(option, value, "_").is_ok() {
        true => Ok(()),
        false => Err(LaunchError::Value {
            option,
            // A wrong name may be NAME=VALUE with a secret as its value, so it is not repeated.
            problem: "this is no name of an environment variable".to_owned(),
            hint: "give only the name (letters, digits and _); its value is never written into the text",
        }),
    }
}

/// Checks a name that must be a DNS label of at most `most` characters. Kubernetes appends to some names, so their limit is lower.
pub(super) fn check_label(option: &'static str, value: &str, most: usize) -> Result<(), LaunchError> {
    match is_label(value) && value.len() <= most {
        true => Ok(()),
        false => Err(value_error(
            option,
            value,
            &format!("is no name in Kubernetes of at most {most} characters"),
            "use small letters, digits and hyphens; begin and end with a letter or a digit",
        )),
    }
}

/// Checks the name of a secret or a claim: DNS labels with dots between them, at most 253 characters together.
pub(super) fn check_dotted(option: &'static str, value: &str) -> Result<(), LaunchError> {
    match value.len() <= 253 && value.split('.').all(is_label) {
        true => Ok(()),
        false => Err(value_error(
            option,
            value,
            "is no name in Kubernetes",
            "use small letters, digits, hyphens and dots; begin and end with a letter or a digit",
        )),
    }
}

/// Whether a text is a DNS label.
fn is_label(value: &str) -> bool {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    (1..=63).contains(&value.len()) && value.chars().all(fits) && !value.starts_with('-') && !value.ends_with('-')
}

/// Checks an amount as Kubernetes writes it: digits, perhaps with a fraction, and a unit. Zero is refused.
pub(super) fn check_amount(
    option: &'static str,
    value: &str,
    units: &[&str],
    hint: &'static str,
) -> Result<(), LaunchError> {
    let number = value.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = value.get(number.len()..).unwrap_or_default();
    let is_digits = |text: &str| !text.is_empty() && text.len() <= 15 && text.chars().all(|c| c.is_ascii_digit());
    let is_number =
        number.split_once('.').map_or_else(|| is_digits(number), |(whole, part)| is_digits(whole) && is_digits(part));
    let is_positive = number.contains(|c: char| matches!(c, '1'..='9'));
    match is_number && is_positive && (unit.is_empty() || units.contains(&unit)) {
        true => Ok(()),
        false => Err(value_error(option, value, "is no amount", hint)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_kubernetes_are_labels() {
        for right in ["a", "wayword-2", "0"] {
            check_label("--name", right, 63).unwrap();
        }
        for wrong in ["", "-a", "a-", "A", "a.b", "a_b", "ä", "a b", &"a".repeat(64)] {
            check_label("--name", wrong, 63).unwrap_err();
        }
        check_dotted("--secret", "a.b-c").unwrap();
        for wrong in ["a..b", ".a", "a.", "a/b"] {
            check_dotted("--secret", wrong).unwrap_err();
        }
    }

    #[test]
    fn amounts_have_a_number_and_a_known_unit() {
        for right in ["1", "0.5", "500m"] {
            check_amount("--cpu", right, &["m"], "").unwrap();
        }
        for wrong in ["", "m", "0", "0.0m", "1.", ".5", "-1", "1 m", "1Gi", "1e3", "1\n"] {
            check_amount("--cpu", wrong, &["m"], "").unwrap_err();
        }
    }

    #[test]
    fn variable_refuses_a_value_and_does_not_repeat_it() {
        check_variable("--export", "PGPASSFILE").unwrap();
        for wrong in ["", "A=geheim", "1A", "A B", "A-B", "ALL,geheim"] {
            let error = check_variable("--export", wrong).unwrap_err().to_string();
            assert!(!error.contains("geheim"), "{error}");
        }
    }
}
