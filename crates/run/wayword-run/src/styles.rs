//! Finds the styles that a run names: built-in ones, TOML files, and the texts of datasets.

use crate::{error::CommandError, similar::did_you_mean, text_file};
use std::path::Path;
use wayword_core::{InstructionStyle, StyleConstraints};
use wayword_synthesis::style::{StyleProfile, built_in, built_in_names, hash_style, parse_style_with, validate_style};

/// A style with the measures of its reference texts.
#[derive(Debug, Clone)]
pub struct MeasuredStyle {
    /// The style.
    pub style: InstructionStyle,
    /// The measures.
    pub profile: StyleProfile,
    /// The style's hash, for provenance.
    pub hash: String,
}

/// The name of a style as a flag takes it: a built-in style, a TOML file, or NAME=DATASET.
///
/// # Errors
/// When it is none of these. Whether a file exists is checked when it is read.
pub(crate) fn check_style_name(name: &str) -> Result<String, String> {
    let names = built_in_names();
    if name.contains('=') || is_toml(name) || names.contains(&name) {
        return Ok(name.to_owned());
    }
    let (all, meant) = (names.join(", "), did_you_mean(name, names));
    Err(format!("give {all}, a file that ends in .toml, or NAME=DATASET{meant}"))
}

fn is_toml(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|end| end == "toml")
}

/// The styles of a run. A name is that of a built-in style, a TOML file, or either with =DATASET behind it. The last takes all
/// instructions of a dataset as reference texts; a name brings the constraints of the built-in style of that name, if there is one.
///
/// # Errors
/// When one cannot be found or read, or two have one name.
pub fn find_styles(names: &[String]) -> Result<Vec<MeasuredStyle>, CommandError> {
    let mut styles: Vec<MeasuredStyle> = Vec::new();
    for name in names {
        let style = find_one(name)?;
        if styles.iter().any(|other| other.style.name == style.name) {
            return Err(CommandError::usage(format!("style {} is given twice", style.name), "give each style once"));
        }
        let (profile, hash) = (StyleProfile::for_style(&style), hash_style(&style));
        styles.push(MeasuredStyle { style, profile, hash });
    }
    Ok(styles)
}

fn find_one(name: &str) -> Result<InstructionStyle, CommandError> {
    let (name, dataset) = match name.split_once('=') {
        Some((name, file)) => (name, Some(Path::new(file))),
        None => (name, None),
    };
    let more = dataset.map(dataset_texts).transpose()?;
    if is_toml(name) {
        let text = text_file::read_text_file(Path::new(name), "read the style")?;
        return Ok(parse_style_with(name, &text, more.unwrap_or_default())?);
    }
    let Some(references) = more else { return Ok(built_in(name)?) };
    let constraints = built_in(name).map_or_else(|_| StyleConstraints::default(), |style| style.constraints);
    Ok(validate_style(InstructionStyle {
        name: name.to_owned(),
        references,
        constraints,
        ..InstructionStyle::default()
    })?)
}

/// The instructions of a dataset, each once.
fn dataset_texts(file: &Path) -> Result<Vec<String>, CommandError> {
    let episodes = wayword_formats::read_any_format(file)?;
    let all = episodes.into_iter().flat_map(|episode| episode.instructions);
    let mut texts: Vec<String> = all.map(|text| one_line(&text)).filter(|text| !text.is_empty()).collect();
    texts.sort();
    texts.dedup();
    Ok(texts)
}

/// A text on one line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
