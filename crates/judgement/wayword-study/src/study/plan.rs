//! The plan of a study, which is fixed when the study is made, and the file `plan.json`.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// The format of a study's folder. `plan.json` contains it, and the version of the program that made the study.
const STUDY_FORMAT: &str = "wayword-study/1";
/// Longest name of a format or a version that an error quotes, characters.
const MAX_QUOTED_CHARS: usize = 60;

/// The task of the participants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StudyTask {
    /// They walk the viewpoint graph by the text alone.
    Follow,
    /// They watch a film of the path and answer four questions about the text.
    Rate,
    /// They watch the film and choose between two texts.
    Pair,
}

impl StudyTask {
    /// Its name, as `--mode` takes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Follow => "follow",
            Self::Rate => "rate",
            Self::Pair => "pair",
        }
    }
}

/// Where the texts of a condition come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConditionKind {
    /// A run, or a file of texts.
    Run,
    /// The people who wrote the dataset.
    People,
    /// Another path in the same scene. This control shows how well a wrong text does.
    OtherPath,
    /// Another condition's texts with their sides turned and their landmarks exchanged. This control too shows how well a wrong text
    /// does.
    Corrupted,
}

/// One of the sets of texts that the study compares.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyCondition {
    /// Its name in the results.
    pub name: String,
    /// Where its texts come from.
    pub kind: ConditionKind,
    /// Where the texts come from, as the user gave it.
    pub source: String,
    /// Whether people see which words to doubt.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub shows_doubts: bool,
}

/// The part of a study that is fixed when it is made, because answers under different plans cannot be combined.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyDesign {
    /// The task of the participants.
    pub mode: StudyTask,
    /// Seed of everything random but tokens.
    pub seed: u64,
    /// How many answers each item shall get.
    pub per_item: u32,
    /// How many items a person gets, at most.
    pub per_participant: u32,
    /// The conditions, in the order of the tables.
    pub conditions: Vec<StudyCondition>,
    /// The style of the texts. Participants see examples of it. Empty if it is not known.
    pub style: String,
}

impl StudyDesign {
    /// The plan as the contents of `plan.json`.
    ///
    /// # Errors
    /// When it cannot be written as JSON.
    pub(super) fn to_file(&self) -> serde_json::Result<Vec<u8>> {
        let mut file = Map::new();
        file.insert("format".to_owned(), STUDY_FORMAT.into());
        file.insert("wayword".to_owned(), env!("CARGO_PKG_VERSION").into());
        if let Value::Object(plan) = serde_json::to_value(self)? {
            file.extend(plan);
        }
        serde_json::to_vec_pretty(&file)
    }

    /// Reads `plan.json`. A file without a format is of the first version, which did not write one.
    ///
    /// # Errors
    /// When it has another format, or is no plan. The text gives the reason.
    pub(super) fn from_file(text: &str) -> Result<Self, String> {
        let mut file: Map<String, Value> = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let program_version = file.shift_remove("wayword");
        match file.shift_remove("format") {
            Some(format) if format != STUDY_FORMAT => {
                let by = program_version.map_or_else(String::new, |version| {
                    format!(" and version {} of this program wrote it", quote_shortened(&version))
                });
                let this = env!("CARGO_PKG_VERSION");
                Err(format!(
                    "its format is {}{by}, and this is version {this}, which reads {STUDY_FORMAT}",
                    quote_shortened(&format)
                ))
            }
            _ => serde_json::from_value(Value::Object(file)).map_err(|error| error.to_string()),
        }
    }
}

/// A value as JSON, cut off after [`MAX_QUOTED_CHARS`] characters.
fn quote_shortened(value: &Value) -> String {
    value.to_string().chars().take(MAX_QUOTED_CHARS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan() -> StudyDesign {
        let conditions = Vec::new();
        StudyDesign {
            mode: StudyTask::Pair,
            seed: 3,
            per_item: 2,
            per_participant: 1,
            conditions,
            style: "r2r".to_owned(),
        }
    }

    fn written() -> String {
        String::from_utf8(plan().to_file().unwrap()).unwrap()
    }

    #[test]
    fn from_file_reads_a_written_plan_and_one_without_a_format() {
        assert!(written().starts_with("{\n  \"format\": \"wayword-study/1\",\n  \"wayword\": "), "{}", written());
        assert_eq!(StudyDesign::from_file(&written()), Ok(plan()));
        assert_eq!(StudyDesign::from_file(&serde_json::to_string(&plan()).unwrap()), Ok(plan()));
    }

    #[test]
    fn a_later_plan_is_refused_with_the_version_that_wrote_it() {
        let later = written().replace("study/1", "study/2").replace(env!("CARGO_PKG_VERSION"), "7.0.3");
        let told = StudyDesign::from_file(&later).unwrap_err();
        assert!(["wayword-study/2", "7.0.3", "reads wayword-study/1"].iter().all(|part| told.contains(part)), "{told}");
    }

    #[test]
    fn a_plan_with_an_unknown_key_is_refused() {
        assert!(StudyDesign::from_file(&written().replace("\"seed\"", "\"sead\"")).unwrap_err().contains("sead"));
    }
}
