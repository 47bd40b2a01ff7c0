//! Fills the templates of scripts and manifests, and quotes every value in them.

use super::LaunchError;
use minijinja::{Environment, Error, ErrorKind, Output, State, UndefinedBehavior, Value, value::ValueKind};
use serde::Serialize;

/// The meaning of a worker's exit codes, as comments in both texts.
const EXIT_CODES_TEMPLATE: &str = include_str!("codes.j2");

/// A text out of a template and its values.
pub(super) fn render_template(template: &str, values: impl Serialize) -> Result<String, LaunchError> {
    let mut templates = Environment::new();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    templates.set_trim_blocks(true);
    templates.set_lstrip_blocks(true);
    templates.set_keep_trailing_newline(true);
    templates.set_formatter(write_quoted);
    templates.add_filter("bash", quote_bash);
    templates.add_filter("json", quote_json);
    templates.add_filter("argument", quote_argument);
    templates.add_filter("directive", quote_directive);
    templates.add_template("codes", EXIT_CODES_TEMPLATE)?;
    templates.add_template("text", template)?;
    Ok(templates.get_template("text")?.render(values)?)
}

/// Writes a value. A text must come out of a filter below, so that a template cannot forget to quote one.
fn write_quoted(out: &mut Output<'_>, _state: &State<'_, '_>, value: &Value) -> Result<(), Error> {
    if value.kind() == ValueKind::String && !value.is_safe() {
        return Err(Error::new(ErrorKind::InvalidOperation, "a text is not quoted"));
    }
    out.write_str(&value.to_string()).map_err(Error::from)
}

/// One word of bash. Within single quotes only the quote itself has a meaning.
#[expect(clippy::needless_pass_by_value, reason = "a filter gets its values")]
fn quote_bash(text: String) -> Value {
    Value::from_safe_string(format!("'{}'", text.replace('\'', r"'\''")))
}

/// A string of YAML. Every JSON string is one.
fn quote_json(text: String) -> Value {
    Value::from_safe_string(serde_json::Value::from(text).to_string())
}

/// An argument of a container. Kubernetes replaces `$(NAME)` by a variable, and reads `$$` as `$`.
#[expect(clippy::needless_pass_by_value, reason = "a filter gets its values")]
fn quote_argument(text: String) -> Value {
    quote_json(text.replace('$', "$$"))
}

/// A value after `#SBATCH`. sbatch has its own rules of quoting; values that need more than quotes were refused before.
#[expect(clippy::needless_pass_by_value, reason = "a filter gets its values")]
fn quote_directive(text: String) -> Value {
    Value::from_safe_string(format!("\"{text}\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn render_refuses_a_text_that_no_filter_quoted() {
        let values = || minijinja::context! { text => "a; rm -r ~", number => 3 };
        assert_eq!(render_template("{{ text|bash }} {{ number }}", values()).unwrap(), "'a; rm -r ~' 3");
        let error = render_template("{{ text }}", values()).unwrap_err().to_string();
        assert!(error.contains("not quoted"), "{error}");
    }

    #[test]
    fn every_mark_of_bash_yaml_and_kubernetes_is_quoted() {
        let text = |value: Value| value.as_str().unwrap().to_owned();
        assert_eq!(text(quote_bash("it's $HOME `x` \\".to_owned())), r"'it'\''s $HOME `x` \'");
        assert_eq!(text(quote_json("a\"b\\: #".to_owned())), r#""a\"b\\: #""#);
        assert_eq!(text(quote_argument("$(X) $$ $Y".to_owned())), r#""$$(X) $$$$ $$Y""#);
    }
}
