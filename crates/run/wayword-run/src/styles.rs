//! Finds the styles that a run names: built-in ones, TOML files, and the texts of datasets.

use crate::{
    error::CommandError, settings::RunSettings, similar::did_you_mean, text_file, text_language::ForeignTexts,
    toml_message::plain_toml_message,
};
use std::path::Path;
use wayword_core::{InstructionStyle, StyleConstraints};
use wayword_language::Language;
use wayword_synthesis::style::{
    LanguageWording, StyleError, StyleProfile, built_in, built_in_names, hash_style, parse_style_with, validate_style,
};

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

impl MeasuredStyle {
    /// Its reference texts, if most of those at the beginning are not English.
    #[must_use]
    pub(crate) fn foreign_references(&self) -> Option<ForeignTexts> {
        ForeignTexts::find(self.style.references.iter().map(String::as_str))
    }
}

/// Refuses styles in a language that rules do not write. `names` are the styles as they were given, without the languages that each is
/// written in.
///
/// # Errors
/// When most of the references of one are not English.
pub(crate) fn refuse_foreign_styles(names: &[String], styles: &[MeasuredStyle]) -> Result<(), CommandError> {
    let languages = (styles.len() / names.len().max(1)).max(1);
    for (name, style) in names.iter().flat_map(|name| std::iter::repeat_n(name, languages)).zip(styles) {
        if !style.style.language.is_empty() {
            continue;
        }
        if let Some(ForeignTexts { language, example }) = style.foreign_references() {
            let problem = format!(
                "{name}: its reference texts are in {language}, such as {example:?}, and rules do not write that"
            );
            let hint = "give a style with English or Chinese texts, or a model that writes (--write)";
            return Err(CommandError::usage(problem, hint));
        }
    }
    Ok(())
}

/// The tag of a language that texts are written in, as a flag takes it.
///
/// # Errors
/// When the program does not write it.
pub(crate) fn check_language(tag: &str) -> Result<String, String> {
    let tag = tag.trim();
    let known = [ENGLISH].into_iter().chain(LanguageWording::written_tags());
    if known.clone().any(|known| known == tag) {
        return Ok(tag.to_owned());
    }
    Err(format!("give {}", known.collect::<Vec<_>>().join(" or ")))
}

/// The tag of English.
const ENGLISH: &str = "en";

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
    find_styles_in(names, &[])
}

/// The styles of a run, each in the languages that the run asks for.
///
/// # Errors
/// As [`find_styles`].
pub fn find_run_styles(settings: &RunSettings) -> Result<Vec<MeasuredStyle>, CommandError> {
    find_styles_in(&settings.style, &settings.language)
}

fn find_styles_in(names: &[String], languages: &[String]) -> Result<Vec<MeasuredStyle>, CommandError> {
    let mut styles: Vec<(InstructionStyle, &String)> = Vec::new();
    for name in names {
        let style = find_one(name)?;
        for style in in_languages(&style, languages) {
            if let Some((_, other)) = styles.iter().find(|(other, _)| other.name == style.name) {
                return Err(same_name_error(&style.name, other, name));
            }
            styles.push((style, name));
        }
    }
    Ok(styles.into_iter().map(|(style, _)| measure_style(style)).collect())
}

/// A style in these languages, each once; in its own if there are none. In its own language it keeps its name.
fn in_languages(style: &InstructionStyle, languages: &[String]) -> Vec<InstructionStyle> {
    let own = if style.language.is_empty() { ENGLISH } else { &style.language };
    let mut all: Vec<InstructionStyle> = Vec::new();
    for tag in languages {
        let is_own = Language::from_tag(tag) == Language::from_tag(own);
        let style = if is_own { style.clone() } else { style.in_language(tag) };
        if !all.contains(&style) {
            all.push(style);
        }
    }
    if languages.is_empty() { vec![style.clone()] } else { all }
}

/// The language of a style's texts, where the program writes it.
fn written_language(references: &[String]) -> Option<&'static str> {
    let foreign = ForeignTexts::find(references.iter().map(String::as_str))?;
    LanguageWording::of_language(foreign.language).map(LanguageWording::tag)
}

/// A style with its measures.
pub(crate) fn measure_style(style: InstructionStyle) -> MeasuredStyle {
    let (profile, hash) = (StyleProfile::for_style(&style), hash_style(&style));
    MeasuredStyle { style, profile, hash }
}

/// The error for two styles with one name; `first` and `second` are how they were given.
fn same_name_error(name: &str, first: &str, second: &str) -> CommandError {
    if first == second {
        return CommandError::usage(format!("style {name} is given twice"), "give each style once");
    }
    let problem = format!("--style {first} and --style {second} are two styles with the name {name}");
    CommandError::usage(problem, "change `name` in a file of one's own, or leave one out")
}

/// Refuses a style of a file that has the name of another, built-in style: records name the style that they were written in.
fn refuse_built_in_name(file: &str, style: &InstructionStyle) -> Result<(), CommandError> {
    match built_in(&style.name) {
        Ok(known) if known.constraints != style.constraints || known.references != style.references => {
            let problem = format!("{file}: it has the name of the built-in style {}, and is another", style.name);
            Err(CommandError::usage(problem, "change `name` in the file"))
        }
        _ => Ok(()),
    }
}

fn find_one(name: &str) -> Result<InstructionStyle, CommandError> {
    let (name, dataset) = match name.split_once('=') {
        Some((name, file)) => (name, Some(Path::new(file))),
        None => (name, None),
    };
    if let Some(file) = dataset.and_then(Path::to_str).filter(|file| is_toml(file)) {
        let problem = format!("--style {name}={file}: after = stands a dataset, and this is the file of a style");
        return Err(CommandError::usage(problem, format!("give the style alone, as in --style {file}")));
    }
    let more = dataset.map(dataset_texts).transpose()?;
    let mut style = find_named(name, more)?;
    if style.language.is_empty()
        && let Some(tag) = written_language(&style.references)
    {
        // A style keeps its name in its own language; a built-in one has its number of sentences for English.
        let constraints = if dataset.is_some() { style.in_language(tag).constraints } else { style.constraints };
        style = InstructionStyle { language: tag.to_owned(), constraints, ..style };
    }
    Ok(style)
}

/// A built-in style, or that of a file, with the texts of a dataset in addition.
fn find_named(name: &str, more: Option<Vec<String>>) -> Result<InstructionStyle, CommandError> {
    if is_toml(name) {
        let text = text_file::read_text_file(Path::new(name), "read the style")?;
        let style = parse_style_with(name, &text, more.unwrap_or_default()).map_err(suggest_field)?;
        refuse_built_in_name(name, &style)?;
        return Ok(style);
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

/// The error about a style with the name of the field that was meant, if one was mistyped.
fn suggest_field(error: StyleError) -> StyleError {
    match error {
        StyleError::Unreadable { name, reason } => StyleError::Unreadable { name, reason: plain_toml_message(&reason) },
        error => error,
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const OWN: &str = "references = [\"Cross the nursery and wait by the crib.\"]";

    fn told(names: &[&str]) -> String {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        find_styles(&names).map_or_else(|error| error.to_string(), |_| String::new())
    }

    #[test]
    fn styles_with_one_name_are_told_apart_from_one_given_twice() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, text: String| {
            let path = folder.path().join(name);
            fs::write(&path, text).unwrap();
            path.display().to_string()
        };
        let (mine, other) = (
            file("mine.toml", format!("name = \"mine\"\n{OWN}")),
            file("other.toml", format!("name = \"mine\"\n{OWN}")),
        );
        assert!(told(&["r2r", "r2r"]).contains("style r2r is given twice"));
        assert!(told(&[&mine, &mine]).contains("style mine is given twice"));
        let both = told(&[&mine, &other]);
        assert!(both.contains("mine.toml") && both.contains("other.toml") && both.contains("two styles"), "{both}");
        assert_eq!(told(&["r2r", &mine]), "");
    }

    #[test]
    fn style_file_in_the_place_of_a_dataset_is_told_apart() {
        let told = told(&["r2r=mine.toml"]);
        assert!(
            told.contains("--style r2r=mine.toml: after = stands a dataset") && told.contains("--style mine.toml"),
            "{told}"
        );
    }

    #[test]
    fn a_mistyped_field_is_told_with_its_line_and_the_field_that_was_meant() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        fs::write(&path, format!("name = \"mine\"\n{OWN}\n[constraints]\nmin_sentence = 5")).unwrap();
        let told = told(&[&path.display().to_string()]);
        assert!(told.contains("at line 4, column 1\n") && told.contains("\n4 | min_sentence = 5\n"), "{told}");
        assert!(told.ends_with("did you mean \"min_sentences\"?"), "{told}");
    }

    #[test]
    fn style_in_another_language_is_refused_with_its_file_and_a_text() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("german.toml");
        let refusal = |references: &str| {
            fs::write(&path, format!("name = \"x\"\nreferences = [{references}]")).unwrap();
            let names = [path.display().to_string()];
            let styles = find_styles(&names).unwrap();
            refuse_foreign_styles(&names, &styles).err().map(|error| error.to_string())
        };
        let (german, english) = ("\"Gehe an der Lampe vorbei und warte am Schreibtisch.\"", "\"Walk past the lamp.\"");
        let told = refusal(german).unwrap();
        assert!(told.contains("german.toml: its reference texts are in German, such as \"Gehe an der Lampe"), "{told}");
        assert!(told.contains("--write"), "{told}");
        assert_eq!(refusal(english), None);
        assert_eq!(refusal(&format!("{english}, {german}")), None);
    }

    #[test]
    fn a_file_does_not_take_the_name_of_a_built_in_style() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r2r.toml");
        fs::write(&path, format!("name = \"r2r\"\n{OWN}")).unwrap();
        let told = told(&[&path.display().to_string()]);
        assert!(told.contains("r2r.toml: it has the name of the built-in style r2r"), "{told}");
        assert!(told.contains("change `name`"), "{told}");
    }
}
