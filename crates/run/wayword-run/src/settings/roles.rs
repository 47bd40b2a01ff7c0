//! The roles of a run: which model, or labels or rules, asks, sees, summarises and writes.

use super::{RolePlayer, group::group, is_false, role_player::is_in_process};
use crate::error::CommandError;
use clap::{Args, ValueEnum};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Default for the longer side of the pictures that models are sent, pixels.
const DEFAULT_PICTURE_PX: u32 = 512;
/// Largest `--picture-px`, pixels. A larger number is refused.
const MAX_PICTURE_PX: u32 = 4096;

group! {
    /// Who plays which role in a run: flags, and the table `[roles]` of a settings file.
    #[derive(Debug, Clone, Default, PartialEq, Args, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    pub struct AskedRoles {
        /// Language model that asks, summarises and writes, as provider/model.
        #[arg(long, value_name = "MODEL")]
        pub llm: Option<String>,
        /// Who asks about the views: rules, or a model. [default: the model of --llm, else rules]
        #[arg(long, value_name = "MODEL")]
        pub ask: Option<String>,
        /// Who sees: labels (the platform's ground-truth labels answer), or a model that looks at pictures. [default: labels]
        #[arg(long, value_name = "MODEL")]
        pub see: Option<String>,
        /// Who summarises the answers: rules, or a model. [default: the model of --llm, else rules]
        #[arg(long, value_name = "MODEL")]
        pub summarise: Option<String>,
        /// Who writes: rules, or a model. [default: the model of --llm, else rules]
        #[arg(long, value_name = "MODEL")]
        pub write: Option<String>,
        /// Detector that looks for things in the pictures, as hf/ORG/NAME: what it finds is seen, and a thing that captions name
        /// and it misses is doubted. It runs inside this program.
        #[arg(long, value_name = "MODEL")]
        pub detector: Option<String>,
        /// Show the model that writes the pictures ahead of the frames, at most 16 of a path, in addition to their descriptions:
        /// as in --write openai/gpt-4.1-mini --write-sees. A provider that takes no pictures is refused.
        #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
        pub write_sees: Option<bool>,
        /// What happens if all texts of the model failed a check: rules write the instruction, or with `nobody` it is rejected. The
        /// provenance names the writer. [default: rules]
        #[arg(long)]
        pub finish: Option<FailureFinish>,
        /// Base URL of the provider. For several providers use [providers.NAME] in the settings file.
        #[arg(long, value_name = "URL")]
        pub base_url: Option<String>,
        /// Longer side of the pictures that models get; larger pictures are shrunk. [default: 512]
        #[arg(long, value_name = "PX")]
        pub picture_px: Option<u32>,
        /// Number format of the weights of a model that runs inside this program: f32, bf16 or f16. [default: f32; for BLIP-2, bf16]
        #[arg(long, value_name = "NUMBERS")]
        pub precision: Option<AskedPrecision>,
        /// Folder with your own prompt templates: question.j2, answer.j2, answer_question.j2 (BLIP), answer_completion.j2 (BLIP-2),
        /// summary.j2, condense.j2, write.j2.
        #[arg(long, value_name = "DIR")]
        pub prompts: Option<PathBuf>,
    }
}

/// Number format of a model's weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum AskedPrecision {
    /// 32 bits.
    F32,
    /// 16 bits, with the range of f32.
    Bf16,
    /// 16 bits.
    F16,
}

/// Who finishes if all of a model's texts failed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum FailureFinish {
    /// The writer that works by rules finishes.
    #[default]
    Rules,
    /// The instruction is rejected.
    Nobody,
}

/// Who plays which role in a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRoles {
    /// Who asks.
    pub ask: RolePlayer,
    /// Who sees.
    pub see: RolePlayer,
    /// Who summarises.
    pub summarise: RolePlayer,
    /// Who writes.
    pub write: RolePlayer,
    /// The detector that looks for things in the pictures; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detector: Option<String>,
    /// Whether the model that writes is shown the pictures of the frames.
    #[serde(default, skip_serializing_if = "is_false")]
    pub write_sees: bool,
    /// Who finishes if all texts of a model failed.
    pub finish: FailureFinish,
    /// Base URL, if there is one provider.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_url: Option<String>,
    /// Longer side of the pictures that models are sent.
    pub picture_px: u32,
    /// Number format of the weights of models in process, if not the default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub precision: Option<AskedPrecision>,
    /// Folder of prompt templates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prompts: Option<PathBuf>,
}

impl Default for RunRoles {
    fn default() -> Self {
        Self {
            ask: RolePlayer::Rules,
            see: RolePlayer::Labels,
            summarise: RolePlayer::Rules,
            write: RolePlayer::Rules,
            detector: None,
            write_sees: false,
            finish: FailureFinish::default(),
            base_url: None,
            picture_px: DEFAULT_PICTURE_PX,
            precision: None,
            prompts: None,
        }
    }
}

impl AskedRoles {
    /// The values of flags, completed by those of a file. A flag `--llm` wins over the file's text roles.
    #[must_use]
    pub fn or_file(self, mut file: Self) -> Self {
        if self.llm.is_some() {
            file = Self { ask: None, summarise: None, write: None, ..file };
        }
        self.over(file)
    }

    /// Resolves the roles. Values that were not given get their defaults.
    ///
    /// # Errors
    /// When a name is neither built in nor provider/model.
    pub fn resolve(self) -> Result<RunRoles, CommandError> {
        let default = RunRoles::default();
        // Roles that work with texts: `--llm` is the default of all three.
        let text_role = |role: Option<String>, flag, none| match (role, &self.llm) {
            (Some(name), _) => parse_player(flag, &name, RolePlayer::Rules),
            (None, Some(name)) => parse_player("--llm", name, RolePlayer::Rules),
            (None, None) => Ok(none),
        };
        let picture_px = self.picture_px.unwrap_or(default.picture_px);
        if !(32..=MAX_PICTURE_PX).contains(&picture_px) {
            return Err(CommandError::usage(
                format!("--picture-px {picture_px} is not from 32 to {MAX_PICTURE_PX}"),
                "most models look at 300 to 1600 pixels",
            ));
        }
        let write = text_role(self.write, "--write", default.write)?;
        let write_sees = self.write_sees.unwrap_or(false);
        if write_sees && write.remote_model().is_none() {
            return Err(CommandError::usage(
                format!("--write-sees: {write} writes, and cannot be shown pictures"),
                "name a model over HTTP that sees, as in --write openai/gpt-4.1-mini --write-sees",
            ));
        }
        Ok(RunRoles {
            ask: text_role(self.ask, "--ask", default.ask)?,
            see: self.see.map_or(Ok(default.see), |name| parse_player("--see", &name, RolePlayer::Labels))?,
            summarise: text_role(self.summarise, "--summarise", default.summarise)?,
            write,
            detector: self.detector.map(check_detector_name).transpose()?,
            write_sees,
            finish: self.finish.unwrap_or_default(),
            base_url: self.base_url,
            picture_px,
            precision: self.precision,
            prompts: self.prompts,
        })
    }
}

/// Reads the player of a role: the embedded one, or provider/model.
fn parse_player(flag: &str, name: &str, embedded: RolePlayer) -> Result<RolePlayer, CommandError> {
    let (problem, hint) = (
        format!("{flag} {name}: this is neither `{embedded}` nor a model as provider/model"),
        format!("give {embedded}, or a provider and its model, as in {flag} ollama/llava"),
    );
    embedded.or_model(name).ok_or_else(|| CommandError::usage(problem, hint))
}

/// Checks the name of a detector.
fn check_detector_name(name: String) -> Result<String, CommandError> {
    if is_in_process(&name) {
        return Ok(name);
    }
    Err(CommandError::usage(
        format!("--detector {name}: detectors run inside this program, and their names begin with hf/"),
        "give one as in --detector hf/google/owlv2-base-patch16-ensemble",
    ))
}

impl RunRoles {
    /// The models among them, each once, in the order of their work.
    #[must_use]
    pub fn model_names(&self) -> Vec<&str> {
        let mut models: Vec<&str> = Vec::new();
        let players = [&self.ask, &self.see, &self.summarise, &self.write];
        for name in players.into_iter().filter_map(RolePlayer::model_name).chain(self.detector.as_deref()) {
            if !models.contains(&name) {
                models.push(name);
            }
        }
        models
    }

    /// The flags, other than their defaults, that only a model uses.
    pub(crate) fn given_for_models(&self) -> Vec<String> {
        let default = Self::default();
        let given = [
            ("--finish", self.finish != default.finish),
            ("--base-url", self.base_url.is_some()),
            ("--picture-px", self.picture_px != default.picture_px),
            ("--precision", self.precision.is_some()),
            ("--prompts", self.prompts.is_some()),
        ];
        given.into_iter().filter(|(_, is_given)| *is_given).map(|(flag, _)| flag.to_owned()).collect()
    }

    /// The models over HTTP that are shown pictures, each once.
    #[must_use]
    pub fn shown_pictures(&self) -> Vec<&str> {
        let writer = Some(&self.write).filter(|name| self.write_sees && **name != self.see);
        std::iter::once(&self.see).chain(writer).filter_map(RolePlayer::remote_model).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(llm: Option<&str>, write: Option<&str>) -> AskedRoles {
        AskedRoles { llm: llm.map(str::to_owned), write: write.map(str::to_owned), ..AskedRoles::default() }
    }

    #[test]
    fn one_model_takes_the_three_text_roles_unless_one_is_named() {
        let roles = asked(Some("a/b"), Some("c/d:e")).resolve().unwrap();
        let played = [&roles.ask, &roles.see, &roles.summarise, &roles.write].map(RolePlayer::as_str);
        assert_eq!(played, ["a/b", "labels", "a/b", "c/d:e"]);
        assert_eq!(roles.model_names(), ["a/b", "c/d:e"]);
        assert_eq!(AskedRoles::default().resolve().unwrap(), RunRoles::default());
    }

    #[test]
    fn a_flag_for_all_roles_wins_over_the_roles_of_the_file() {
        let roles = asked(Some("a/b"), None).or_file(asked(None, Some("c/d"))).resolve().unwrap();
        assert_eq!(roles.write.as_str(), "a/b");
        let roles = asked(None, None).or_file(asked(Some("e/f"), Some("c/d"))).resolve().unwrap();
        assert_eq!((roles.ask.as_str(), roles.write.as_str()), ("e/f", "c/d"));
    }

    #[test]
    fn names_that_no_role_can_have_are_refused() {
        for bad in ["labels", "gpt", "/x", "x/", ""] {
            let told = |llm, write| asked(llm, write).resolve().unwrap_err().to_string();
            assert!(told(None, Some(bad)).starts_with("--write"), "{bad}");
            assert!(told(Some(bad), None).starts_with("--llm"), "{bad}: the error names the flag that was given");
        }
    }
}
