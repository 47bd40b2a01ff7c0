//! Fills the templates of file paths in `meta/info.json`. They are written as Python's format strings:
//! `data/chunk-{episode_chunk:03d}/x.parquet`.

use std::path::{Component, Path, PathBuf};

/// Most digits to which a template may pad a number with zeros; more is an error.
const MAX_DIGITS: usize = 20;

/// The value of a placeholder.
#[derive(Debug, Clone, Copy)]
pub(super) enum TemplateValue<'a> {
    Number(u64),
    Text(&'a str),
}

/// Fills a template with values; returns the path below the dataset's folder.
///
/// # Errors
/// A reason in words, if the template is malformed, needs another value, or leads out of the folder.
pub(super) fn fill_template(template: &str, values: &[(&str, TemplateValue<'_>)]) -> Result<PathBuf, String> {
    let wrong = |reason: String| format!("the path {template:?} {reason}");
    let mut filled = String::new();
    let mut rest = template;
    while let Some((before, from)) = rest.split_once('{') {
        let (placeholder, after) = from.split_once('}').ok_or_else(|| wrong("has a { without a }".to_owned()))?;
        filled.push_str(before);
        filled.push_str(&fill_placeholder(placeholder, values).map_err(wrong)?);
        rest = after;
    }
    filled.push_str(rest);
    let path = PathBuf::from(&filled);
    if filled.is_empty() || !is_below(&path) {
        return Err(wrong(format!("becomes {filled:?}, which does not lie in the dataset")));
    }
    Ok(path)
}

/// Whether a relative path does not lead out of its folder.
fn is_below(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_)))
}

/// Fills one placeholder: `{name}`, `{name:d}` or `{name:03d}`.
fn fill_placeholder(placeholder: &str, values: &[(&str, TemplateValue<'_>)]) -> Result<String, String> {
    let (name, format) = placeholder.split_once(':').unwrap_or((placeholder, ""));
    let value = values.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
    let value = value.ok_or_else(|| {
        let known: Vec<&str> = values.iter().map(|(known, _)| *known).collect();
        format!("needs {name:?}; known values: {}", known.join(", "))
    })?;
    let unknown = || format!("wants {name:?} in the format {format:?}, which is not known");
    match value {
        TemplateValue::Text(text) if format.is_empty() || format == "s" => Ok(text.to_owned()),
        TemplateValue::Text(_) => Err(unknown()),
        TemplateValue::Number(number) => {
            let digits = format.strip_suffix('d').unwrap_or(format);
            let width: usize = if digits.is_empty() { 0 } else { digits.parse().map_err(|_| unknown())? };
            // Without the zero Python pads with spaces, which file names in datasets do not have.
            if width > MAX_DIGITS || (width > 0 && !digits.starts_with('0')) {
                return Err(unknown());
            }
            Ok(format!("{number:0width$}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const VALUES: [(&str, TemplateValue<'_>); 2] =
        [("episode_index", TemplateValue::Number(12)), ("video_key", TemplateValue::Text("images.front"))];

    #[test]
    fn templates_of_the_library_are_filled_as_python_does() {
        let fill = |template| fill_template(template, &VALUES).unwrap();
        assert_eq!(
            fill("videos/{video_key}/episode_{episode_index:06d}.mp4"),
            Path::new("videos/images.front/episode_000012.mp4")
        );
        assert_eq!(fill("{episode_index}/{episode_index:d}/{episode_index:01d}"), Path::new("12/12/12"));
    }

    #[test]
    fn fill_refuses_unknown_values_and_paths_out_of_the_dataset() {
        for (template, said) in [
            ("{x}", "\"x\""),
            ("{episode_index:6d}", "6d"),
            ("{episode_index:0999d}", "0999d"),
            ("{episode_index:03f}", "03f"),
            ("{video_key:03d}", "03d"),
            ("a{episode_index", "without"),
            ("../{video_key}", "does not lie"),
            ("/etc/{video_key}", "does not lie"),
            ("", "does not lie"),
        ] {
            let error = fill_template(template, &VALUES).unwrap_err();
            assert!(error.contains(said), "{template}: {error}");
        }
        assert!(fill_template("{k}", &[("k", TemplateValue::Text("a/../../b"))]).unwrap_err().contains("does not lie"));
    }

    proptest! {
        #[test]
        fn no_template_leads_out(template in "[a./{}:0-9d_]{0,30}|([a./]|\\{video_key\\}|\\{episode_index:02d\\}){0,8}", key in "[a./]{0,5}") {
            if let Ok(path) = fill_template(&template, &[("video_key", TemplateValue::Text(&key)), ("episode_index", TemplateValue::Number(3))]) {
                prop_assert!(is_below(&path));
            }
        }
    }
}
