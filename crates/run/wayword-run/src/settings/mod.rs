//! Settings of a run: flags and a TOML file, resolved once into [`RunSettings`], which the run folder keeps.

mod asked_settings;
mod group;
pub(crate) mod houses;
mod role_player;
mod roles;
mod service;
mod sources;

use crate::error::CommandError;
use serde::{Deserialize, Serialize};
use std::{
    borrow::Cow,
    collections::BTreeMap,
    ops::RangeInclusive,
    path::{Path, PathBuf},
    str::FromStr,
};
use wayword_core::{PathRequest, SceneLack};
use wayword_synthesis::{
    dialogue::{DEFAULT_MAX_QUESTIONS, DialogueMode},
    walk::FrameSelection,
};
use wayword_world::mask_credentials;

pub use asked_settings::{AskedFrames, AskedPlatform, AskedSettings, Draw, Walks, Writing};
pub use role_player::{RolePlayer, UnknownPlayer, is_in_process};
pub use roles::{AskedPrecision, AskedRoles, FailureFinish, RunRoles};
pub use service::{CallKeeping, ProviderTables, Service};
pub use sources::EvidenceSources;

/// The resolved settings of a run. They decide its results, so a run cannot be continued with others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSettings {
    /// Name of the platform: see `wayword platforms`.
    pub platform: String,
    /// Folder of the platform's data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data: Option<PathBuf>,
    /// Address of a running simulator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<String>,
    /// The island of a Habitat navmesh that paths are taken on; chosen by the platform if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub island: Option<usize>,
    /// Folder of the viewpoint graphs along which Habitat's scenes are walked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub connectivity: Option<PathBuf>,
    /// Dataset file that the paths are taken from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub episodes: Option<PathBuf>,
    /// Number of random paths; 0 with episodes.
    pub paths: usize,
    /// Numbers of random paths that earlier commands asked for, ascending: later paths come after theirs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub raised_from: Vec<usize>,
    /// Number of generated houses that random paths lie in, with seeds from `seed` on; the platform's own choice if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub houses: Option<usize>,
    /// Scenes to use; none means all.
    pub scan: Vec<String>,
    /// The lengths that random paths may have.
    pub request: PathRequest,
    /// Style names, files, or NAME=DATASET.
    pub style: Vec<String>,
    /// Tags of the languages that each style is written in; empty for the style's own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub language: Vec<String>,
    /// Which views are captioned.
    pub frames: FrameSelection,
    /// Dialogue or fixed queries.
    pub perception: Perception,
    /// Most questions of a dialogue.
    pub questions: usize,
    /// Whether the object of the closing task is given.
    pub target: TargetMode,
    /// How often a text that failed a check is written again.
    pub repairs: u32,
    /// How often a text that passed is written again, if a follower does not arrive by it surely.
    #[serde(default, skip_serializing_if = "is_no_round")]
    pub refine: u32,
    /// How many texts are written, of which one is kept.
    #[serde(default = "one")]
    pub candidates: u32,
    /// How many texts each path gets in each style.
    #[serde(default = "one_text", skip_serializing_if = "is_one")]
    pub per_path: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// Only this many items.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<usize>,
    /// The sources of evidence that texts are checked against.
    #[serde(default)]
    pub evidence: EvidenceSources,
    /// The file with the measured figures of the detector.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detector_figures: Option<PathBuf>,
    /// The names that the detector looks for in every view: none (`off`), or those of a file; `None` for the built-in names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proposals: Option<PathBuf>,
    /// A calibration from the user's own data: how far labels can be trusted for single names of objects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<PathBuf>,
    /// Whether a text that may mean several places or objects fails.
    #[serde(default, skip_serializing_if = "is_false")]
    pub reject_ambiguous: bool,
    /// Whether no text is followed.
    #[serde(default, skip_serializing_if = "is_false")]
    pub no_route: bool,
    /// Whether no picture is drawn, kept or shown.
    #[serde(default, skip_serializing_if = "is_false")]
    pub no_pictures: bool,
    /// Who asks, sees, summarises and writes.
    #[serde(default)]
    pub roles: RunRoles,
    /// Hashes of the files and styles that the run began with, by name. A run is not continued with others.
    #[serde(default)]
    pub inputs: BTreeMap<String, String>,
    /// The scenes that the run leaves out because they could not be used when it began, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub left_out: BTreeMap<String, SceneLack>,
}

fn one() -> u32 {
    1
}

fn one_text() -> usize {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
fn is_no_round(count: &u32) -> bool {
    *count == 0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
fn is_one(number: &usize) -> bool {
    *number == 1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
fn is_false(flag: &bool) -> bool {
    !*flag
}

/// How views are described.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Perception {
    /// One request for everything in a view, as JSON with the model's confidence in each thing. The default for models behind
    /// HTTP.
    Structured,
    /// The same, then questions about everything that it left open: the room, and what is only perhaps there. They are asked at
    /// the same time.
    FollowUp,
    /// Question by question, then a summary. The default for labels and for models in process.
    #[default]
    Dialogue,
    /// Fixed queries for objects and room, without a dialogue: the paper's ablation.
    Fixed,
    /// One request for a description. The answer is the caption.
    Single,
}

impl Perception {
    /// Whether it asks for JSON, which only a model that follows instructions gives.
    #[must_use]
    pub fn is_structured(self) -> bool {
        matches!(self, Self::Structured | Self::FollowUp)
    }

    /// The default for this model, or for labels.
    fn default_for(see: &RolePlayer) -> Self {
        if see.remote_model().is_some() { Self::Structured } else { Self::Dialogue }
    }
}

/// Who chooses the object of the closing task.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum TargetMode {
    /// The target of the episode or of the random path, named to the writer.
    #[default]
    Given,
    /// Chosen by the writer from the things in the last frame. Exports then have no object id.
    Free,
}

/// Default number of random paths, without episodes.
const DEFAULT_PATHS: usize = 10;
/// Default of how often a text that failed is written again.
const DEFAULT_REPAIRS: u32 = 8;
/// Default of the repairs if a model writes: fewer, because each repair costs a call.
const DEFAULT_MODEL_REPAIRS: u32 = 3;
/// Default of how many texts are written, of which one is kept. If a model writes, it is 1, because each costs a call.
const DEFAULT_CANDIDATES: u32 = 4;
/// Largest `--candidates`, texts. A larger number is refused, as for the limits below.
const MAX_CANDIDATES: u32 = 32;
/// Largest `--repairs`.
const MAX_REPAIRS: u32 = 100;
/// Largest `--refine`.
const MAX_REFINEMENTS: u32 = 5;
/// Largest `--questions`: each question carries the whole dialogue before it.
const MAX_QUESTIONS: usize = 100;
/// Largest `--per-path`: later texts of a path differ ever less from the earlier ones.
const MAX_PER_PATH: usize = 9;
/// Largest `--paths`.
const MAX_PATHS: usize = 1_000_000;

/// The settings of a run, and how it may reach models.
#[derive(Debug, Clone, PartialEq)]
pub struct RunJob {
    /// The resolved settings.
    pub settings: RunSettings,
    /// How models are reached, and how much may be spent.
    pub service: Service,
    /// The user's own providers.
    pub providers: ProviderTables,
    /// Which ledger keeps the calls.
    pub keeping: CallKeeping,
}

impl AskedSettings {
    /// Resolves these settings, together with how models are reached.
    ///
    /// # Errors
    /// When a range cannot be read, a number is out of range, or two settings exclude each other.
    pub fn into_job(mut self) -> Result<RunJob, CommandError> {
        let service = std::mem::take(&mut self.service).into_checked()?;
        let providers = std::mem::take(&mut self.providers);
        let settings = self.resolve()?;
        for (flag, path) in [
            ("--data", &settings.data),
            ("--connectivity", &settings.connectivity),
            ("--episodes", &settings.episodes),
            ("--calibration", &settings.calibration),
            ("--detector-figures", &settings.detector_figures),
            ("--proposals", &settings.proposals),
            ("--prompts", &settings.roles.prompts),
        ] {
            refuse_unnameable(flag, path.as_deref())?;
        }
        Ok(RunJob { settings, service, providers, keeping: CallKeeping::Machine })
    }

    /// Resolves these settings. Values that were not given get their defaults.
    ///
    /// # Errors
    /// When a range cannot be read, or two settings exclude each other.
    pub fn resolve(self) -> Result<RunSettings, CommandError> {
        let Self { platform, walks, writing, draw, roles, .. } = self;
        let paths = walks.paths.unwrap_or(if walks.episodes.is_some() { 0 } else { DEFAULT_PATHS });
        if walks.episodes.is_some() && paths > 0 {
            return Err(CommandError::usage("--episodes and --paths cannot be combined", "give one of them"));
        }
        if walks.paths == Some(0) {
            return Err(CommandError::usage(
                "--paths 0 asks for no path",
                "give at least 1, or leave the flag out for 10",
            ));
        }
        if draw.limit == Some(0) {
            return Err(CommandError::usage(
                "--limit 0 leaves no item",
                "give at least 1, or leave the flag out for all",
            ));
        }
        if paths > MAX_PATHS {
            return Err(CommandError::usage(
                format!("--paths {paths} is more than {MAX_PATHS}"),
                "make several runs, each with its own --seed",
            ));
        }
        let seed = draw.seed.unwrap_or(0);
        if let Some(houses) = walks.houses {
            houses::refuse_unfit_houses(houses, paths, seed, platform.name(), &walks)?;
        }
        if writing.reject_ambiguous == Some(true) && writing.no_route == Some(true) {
            return Err(CommandError::usage(
                "--reject-ambiguous and --no-route cannot be combined: a text that is not followed is not known to be ambiguous",
                "give one of them",
            ));
        }
        if let Some(repairs) = writing.repairs.filter(|repairs| *repairs > MAX_REPAIRS) {
            return Err(CommandError::usage(
                format!("--repairs {repairs} is more than {MAX_REPAIRS}"),
                "give fewer: a text that fails that often will not pass later",
            ));
        }
        if let Some(rounds) = writing.refine.filter(|rounds| *rounds > MAX_REFINEMENTS) {
            return Err(CommandError::usage(
                format!("--refine {rounds} is more than {MAX_REFINEMENTS}"),
                "give fewer: each round is a call, and later ones gain little",
            ));
        }
        if let Some(candidates) = writing.candidates.filter(|candidates| !(1..=MAX_CANDIDATES).contains(candidates)) {
            return Err(CommandError::usage(
                format!("--candidates {candidates} is not from 1 to {MAX_CANDIDATES}"),
                "give a number in that range: each further text gains less",
            ));
        }
        if let Some(number) = writing.per_path.filter(|number| !(1..=MAX_PER_PATH).contains(number)) {
            return Err(CommandError::usage(
                format!("--per-path {number} is not from 1 to {MAX_PER_PATH}"),
                "for more texts make several runs, each with its own --seed",
            ));
        }
        if writing.questions == Some(0) {
            return Err(CommandError::usage(
                "--questions 0 asks nothing after the opening question",
                "give 1 or more, or --perception single, which asks one question for each view",
            ));
        }
        if let Some(questions) = writing.questions.filter(|questions| *questions > MAX_QUESTIONS) {
            return Err(CommandError::usage(
                format!("--questions {questions} is more than {MAX_QUESTIONS}"),
                "give fewer: after about nine questions a dialogue brings little that is new",
            ));
        }
        platform.at.as_deref().map_or(Ok(()), |at| refuse_credentials("--at", at))?;
        let request = resolve_request(walks.hops.as_deref(), walks.metres.as_deref())?;
        let roles = roles.resolve()?;
        let looks_at_pictures =
            matches!(roles.see, RolePlayer::Model(_)) || roles.write_sees || roles.detector.is_some();
        if writing.no_pictures == Some(true) && looks_at_pictures {
            return Err(CommandError::usage(
                "--no-pictures leaves nothing to look at for a model that sees, --write-sees or --detector",
                "leave --no-pictures out, or let labels see",
            ));
        }
        let (repairs, candidates, refine) = match roles.write {
            RolePlayer::Model(_) => (DEFAULT_MODEL_REPAIRS, 1, 1),
            RolePlayer::Rules | RolePlayer::Labels => (DEFAULT_REPAIRS, DEFAULT_CANDIDATES, 0),
        };
        let perception = writing.perception.unwrap_or_else(|| Perception::default_for(&roles.see));
        let evidence = resolve_evidence(&writing, &roles)?;
        let styles = writing.style.filter(|styles| !styles.is_empty());
        Ok(RunSettings {
            platform: platform.name().to_owned(),
            data: platform.data,
            at: platform.at,
            island: platform.island,
            connectivity: platform.connectivity,
            episodes: walks.episodes,
            paths,
            raised_from: Vec::new(),
            houses: walks.houses,
            scan: walks.scan.unwrap_or_default(),
            request,
            style: styles.unwrap_or_else(|| vec!["r2r".into(), "reverie".into()]),
            language: writing.language.unwrap_or_default(),
            frames: writing.frames.map(FrameSelection::from).unwrap_or_default(),
            perception,
            questions: writing.questions.unwrap_or(DEFAULT_MAX_QUESTIONS),
            target: writing.target.unwrap_or_default(),
            repairs: writing.repairs.unwrap_or(repairs),
            refine: writing.refine.unwrap_or(refine),
            candidates: writing.candidates.unwrap_or(candidates),
            per_path: writing.per_path.unwrap_or(1),
            seed,
            limit: draw.limit,
            evidence,
            detector_figures: writing.detector_figures,
            proposals: writing.proposals,
            calibration: writing.calibration,
            reject_ambiguous: writing.reject_ambiguous.unwrap_or(false),
            no_route: writing.no_route.unwrap_or(false),
            no_pictures: writing.no_pictures.unwrap_or(false),
            roles,
            inputs: BTreeMap::new(),
            left_out: BTreeMap::new(),
        })
    }
}

/// Resolves the sources of evidence. Refuses settings for a detector if there is none.
fn resolve_evidence(writing: &Writing, roles: &RunRoles) -> Result<EvidenceSources, CommandError> {
    let evidence = writing.evidence.unwrap_or_else(|| EvidenceSources::usual_sources(roles.detector.is_some()));
    let without = [
        ("--evidence detector", evidence.detector),
        ("--detector-figures", writing.detector_figures.is_some()),
        ("--proposals", writing.proposals.is_some()),
    ];
    match without.iter().find(|(_, is_asked)| *is_asked && roles.detector.is_none()) {
        Some((flag, _)) => Err(CommandError::usage(
            format!("{flag} has no effect without a detector"),
            "name one, as in --detector hf/google/owlv2-base-patch16-ensemble, or leave it out",
        )),
        None => Ok(evidence),
    }
}

/// Refuses a path that a run folder cannot keep: settings are UTF-8 text, and a file's name need not be. An address must not hold a
/// secret, as in [`refuse_credentials`].
pub fn refuse_unnameable(flag: &str, path: Option<&Path>) -> Result<(), CommandError> {
    match path {
        Some(path) if path.to_str().is_none() => Err(CommandError::usage(
            format!("{flag} {}: this name is not valid UTF-8, and a run keeps it as text", path.display()),
            "rename it, or make a symbolic link to it with a plain name and give that",
        )),
        Some(path) if path.to_string_lossy().contains("://") => refuse_credentials(flag, &path.to_string_lossy()),
        _ => Ok(()),
    }
}

/// Refuses an address with a password or a key in it, because run folders, reports and lists of processes would show it.
///
/// # Errors
/// When it has one.
pub fn refuse_credentials(flag: &str, address: &str) -> Result<(), CommandError> {
    match mask_credentials(address) {
        Cow::Borrowed(_) => Ok(()),
        Cow::Owned(masked) => Err(CommandError::usage(
            format!("{flag} {masked}: a password, a key or a token stands in the address (here as ***)"),
            "leave it out: a run keeps the address in its folder, and others can read it there",
        )),
    }
}

/// The lengths that random paths may have, from `--hops` and `--metres`.
fn resolve_request(hops: Option<&str>, metres: Option<&str>) -> Result<PathRequest, CommandError> {
    let default = PathRequest::default();
    let length_m: RangeInclusive<f64> = metres.map_or(Ok(default.length_m), |text| parse_range("--metres", text))?;
    if !length_m.end().is_finite() {
        return Err(CommandError::usage("--metres must be finite", "write it as in --metres 5..20"));
    }
    let hops = hops.map_or(Ok(default.hops), |text| parse_range("--hops", text))?;
    if *hops.end() == 0 {
        return Err(CommandError::usage("--hops 0: a path has at least 1 hop", "write it as in --hops 4..7"));
    }
    if *length_m.end() <= 0.0 {
        return Err(CommandError::usage(
            format!("--metres {}: a path is longer than 0", metres.unwrap_or_default()),
            "write it as in --metres 5..20",
        ));
    }
    Ok(PathRequest { hops, length_m })
}

impl RunSettings {
    /// Whether there is a dialogue.
    #[must_use]
    pub fn has_dialogue(&self) -> bool {
        self.perception == Perception::Dialogue
    }

    /// These settings with the numbers of paths and items of others, if those are larger.
    #[must_use]
    pub fn raised_to(&self, other: &Self) -> Self {
        let mut raised = self.clone();
        if other.paths > self.paths && self.paths > 0 {
            raised.paths = other.paths;
            raised.raised_from.push(self.paths);
        }
        let grows = |before: usize| other.limit.is_none_or(|limit| limit > before);
        if self.limit.is_some_and(grows) {
            raised.limit = other.limit;
        }
        raised
    }

    /// How views are described.
    #[must_use]
    pub fn dialogue_mode(&self) -> DialogueMode {
        match self.perception {
            Perception::Dialogue => DialogueMode::Dialogue { questions: self.questions },
            Perception::Fixed => DialogueMode::Fixed,
            Perception::Single => DialogueMode::Single,
            Perception::Structured => DialogueMode::Structured { questions: 0 },
            Perception::FollowUp => DialogueMode::Structured { questions: self.questions },
        }
    }
}

/// A range as typed: "4..7", both ends included, or one number.
fn parse_range<N: FromStr + PartialOrd + Copy>(flag: &str, text: &str) -> Result<RangeInclusive<N>, CommandError> {
    let (from, to) = text.split_once("..").unwrap_or((text, text));
    let parsed = from.trim().parse::<N>().ok().zip(to.trim_start_matches('=').trim().parse::<N>().ok());
    let problem = match parsed {
        Some((from, to)) if from <= to => return Ok(from..=to),
        Some((from, to)) if from > to => "the first number is larger than the second",
        _ => "this is not a range",
    };
    Err(CommandError::usage(
        format!("{flag} {text}: {problem}"),
        format!("write it as in {flag} 4..7, the smaller number first"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolve_prefers_flags_to_the_file_and_the_file_to_defaults() {
        let flags = AskedSettings { draw: Draw { seed: Some(7), ..Draw::default() }, ..AskedSettings::default() };
        let file: AskedSettings = toml::from_str("seed = 1\nrepairs = 2\nhops = \"2..3\"").unwrap();
        let settings = flags.or_file(file).resolve().unwrap();
        assert_eq!(
            (settings.seed, settings.repairs, settings.request.hops, settings.questions),
            (7, 2, 2..=3, DEFAULT_MAX_QUESTIONS)
        );
    }

    #[test]
    fn ranges_are_read_or_refused() {
        assert_eq!(parse_range::<usize>("--hops", "4..7").unwrap(), 4..=7);
        assert_eq!(parse_range::<f64>("--metres", "5").unwrap(), 5.0..=5.0);
        for bad in ["7..4", "x", "", "1..", "NaN..3"] {
            assert!(parse_range::<f64>("--metres", bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn ranges_that_no_path_fits_are_refused() {
        let told = |hops, metres| resolve_request(hops, metres).unwrap_err().to_string();
        assert!(told(Some("9..3"), None).contains("first number is larger"));
        assert!(told(Some("9-3"), None).contains("not a range"));
        assert!(told(None, Some("20..5")).contains("--metres 20..5"));
        assert!(told(Some("0"), None).contains("--hops 0"));
        assert!(told(None, Some("-3..0")).contains("--metres -3..0"));
        assert!(resolve_request(Some("0..3"), Some("0..5")).is_ok());
    }

    #[test]
    fn lengths_are_finite() {
        let asked = |text: &str| resolve_request(None, Some(text));
        assert!(asked("5..1e400").is_err() && asked("5..20").is_ok());
    }

    #[test]
    fn dialogues_are_bounded() {
        let asked = |questions| {
            AskedSettings {
                writing: Writing { questions: Some(questions), ..Writing::default() },
                ..AskedSettings::default()
            }
            .resolve()
        };
        assert!(
            asked(MAX_QUESTIONS).is_ok()
                && asked(0).is_err()
                && asked(MAX_QUESTIONS + 1).is_err()
                && asked(usize::MAX).is_err()
        );
    }

    #[test]
    fn a_misspelt_key_of_the_file_is_refused() {
        assert!(toml::from_str::<AskedSettings>("sed = 1").is_err());
    }
}
