//! Puts the errors of the TOML parser into words of the user: with the name that was meant, and without the names of Rust's types.

use crate::similar::did_you_mean;

/// Names of types in the messages of the parser, and what they mean to somebody who writes a file.
const TYPES: [(&str, &str); 7] = [
    ("expected a sequence", "expected a list, as in [\"one\", \"two\"]"),
    ("expected a string", "expected a text in quotes"),
    ("expected usize", "expected a whole number"),
    ("expected u32", "expected a whole number"),
    ("expected u64", "expected a whole number"),
    ("expected f64", "expected a number"),
    ("expected a boolean", "expected true or false"),
];

/// The message of the TOML parser, with the name that was meant if it is about a field or a value that it does not know.
pub(crate) fn plain_toml_message(message: &str) -> String {
    let message = message.trim();
    let unknown = ["unknown field `", "unknown variant `"].iter().find_map(|start| message.find(start));
    if let Some(at) = unknown {
        // The unknown name and the known ones are in backticks.
        let mut quoted = message[at..].split('`').skip(1).step_by(2);
        return quoted.next().map_or_else(String::new, |word| format!("{message}{}", did_you_mean(word, quoted)));
    }
    match TYPES.iter().find(|(name, _)| message.ends_with(name)) {
        Some((name, plain)) => message.replace(name, plain),
        None => message.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_name_is_told_with_the_one_that_was_meant() {
        let told = "at line 2: unknown field `styl`, expected one of `paths`, `style`, `seed`";
        assert_eq!(plain_toml_message(told), format!("{told}; did you mean \"style\"?"));
        let far = "unknown field `poem`, expected `style`";
        assert_eq!(plain_toml_message(far), far);
        assert_eq!(plain_toml_message("expected `=`"), "expected `=`");
    }

    #[test]
    fn types_have_their_plain_names() {
        let told = plain_toml_message("invalid type: string \"ten\", expected usize\n");
        assert_eq!(told, "invalid type: string \"ten\", expected a whole number");
        assert!(
            plain_toml_message("invalid type: integer `1`, expected a sequence").contains("expected a list, as in [")
        );
    }
}
