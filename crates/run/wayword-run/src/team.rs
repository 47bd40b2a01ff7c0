//! Fills the roles of a run with models, labels or rules: asker, answerer, summariser, writer, and the writer by rules that
//! finishes when a model's texts fail.

use crate::{
    calibration,
    calls::ModelCalls,
    error::CommandError,
    lookout::DetectorLookout,
    settings::{FailureFinish, RolePlayer, RunSettings},
    text_file,
};
use std::{fs, path::Path, sync::Arc};
use wayword_checks::open::Calibration;
use wayword_core::{LanguageModel, ModelError, ModelReply, ModelRequest, Platform, ViewAnswerer};
use wayword_ledger::CallContext;
use wayword_synthesis::{
    dialogue::{CaptionSummariser, DialogueMode, QuestionAsker, RulesAsker, RulesSummariser},
    models::{ModelAnswerer, ModelAsker, ModelSummariser, ModelWriter},
    observe::ObservationRoles,
    offline::LabelAnswerer,
    prompts::{PromptManner, Prompts},
    repair::WriterPair,
    writer::{InstructionWriter, RulesWriter},
};

/// The players of the roles of a run.
pub struct RoleTeam {
    asker: Box<dyn QuestionAsker>,
    answerer: Box<dyn ViewAnswerer>,
    /// Whether labels answer, and no model.
    sees_labels: bool,
    summariser: Box<dyn CaptionSummariser>,
    writer: Box<dyn InstructionWriter>,
    /// Writes if all texts of a model failed.
    finisher: Option<RulesWriter>,
    mode: DialogueMode,
    /// The hash of the prompts, for provenance; `None` if no model takes part.
    prompts_hash: Option<String>,
    /// A detector that looks along the paths.
    lookout: Option<DetectorLookout>,
    /// The name of the lookout's detector with the meaning of its scores, for provenance.
    detector: Option<String>,
}

impl RoleTeam {
    /// The roles that the settings name. `calls` is needed if a model plays one.
    ///
    /// # Errors
    /// When a model cannot be reached by its name, a prompt cannot be used, or a calibration has no effect.
    pub fn new(
        settings: &RunSettings,
        calls: Option<&ModelCalls>,
        platform: &dyn Platform,
    ) -> Result<Self, CommandError> {
        Self::for_sample(settings, calls, platform, 0)
    }

    /// As [`Self::new`], with another sample of the answers of each model: 0 is the first sample. Studies of randomness use it.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn for_sample(
        settings: &RunSettings,
        calls: Option<&ModelCalls>,
        platform: &dyn Platform,
        sample: u32,
    ) -> Result<Self, CommandError> {
        let labels = LabelAnswerer {
            list_everything: platform.catalogue().lists_everything(),
            calibration: settings_calibration(settings, platform)?,
        };
        let prompts = Arc::new(settings_prompts(settings)?);
        let roles = &settings.roles;
        let model = |player: &RolePlayer, purpose| -> Result<Option<Arc<dyn LanguageModel>>, CommandError> {
            match calls.zip(player.model_name()) {
                Some((calls, name)) => {
                    Ok(Some(Arc::new(PurposeModel { model: sample_model(calls.open_model(name)?, sample), purpose })))
                }
                None => Ok(None),
            }
        };
        let prompts_hash = (!roles.model_names().is_empty()).then(|| prompts.hash().to_owned());
        let shared_prompts = || Arc::clone(&prompts);
        let seeing_model = model(&roles.see, "see")?;
        let sees_labels = seeing_model.is_none();
        // Without a dialogue there is no asker and no summariser.
        let in_dialogue =
            |player: &RolePlayer, purpose| if settings.has_dialogue() { model(player, purpose) } else { Ok(None) };
        let writing_model = model(&roles.write, "write")?;
        let has_finisher = writing_model.is_some() && roles.finish == FailureFinish::Rules;
        Ok(Self {
            asker: match in_dialogue(&roles.ask, "ask")? {
                Some(model) => Box::new(ModelAsker::new(model, shared_prompts())),
                // The rules ask labels and models in different ways.
                None if sees_labels => Box::new(RulesAsker::default()),
                None => Box::new(RulesAsker::for_models()),
            },
            summariser: match in_dialogue(&roles.summarise, "summarise")? {
                Some(model) => Box::new(ModelSummariser::new(model, shared_prompts())),
                None => Box::new(RulesSummariser),
            },
            answerer: match seeing_model {
                Some(model) => {
                    let manner =
                        calls.map_or(Ok(PromptManner::Chat), |calls| calls.prompt_manner(roles.see.as_str()))?;
                    if settings.perception.is_structured() && manner != PromptManner::Chat {
                        return Err(CommandError::usage(
                            format!("{} answers in words alone, and --perception asks for JSON", roles.see),
                            "give --perception dialogue or single",
                        ));
                    }
                    Box::new(ModelAnswerer::new(model, shared_prompts(), manner))
                }
                None => Box::new(labels),
            },
            sees_labels,
            writer: match writing_model {
                Some(model) => Box::new(ModelWriter::new(model, shared_prompts())),
                None => Box::new(RulesWriter),
            },
            finisher: has_finisher.then_some(RulesWriter),
            mode: settings.dialogue_mode(),
            prompts_hash,
            lookout: None,
            detector: None,
        })
    }

    /// Adds a detector that looks along the paths.
    #[must_use]
    pub fn with_lookout(self, lookout: Option<DetectorLookout>) -> Self {
        let named = |lookout: &DetectorLookout| {
            format!("{} ({})", lookout.name(), lookout.to_seeker().detector.scoring().means)
        };
        Self { detector: lookout.as_ref().map(named), lookout, ..self }
    }

    /// The detector that looks along the paths, if there is one.
    #[must_use]
    pub fn lookout(&self) -> Option<&DetectorLookout> {
        self.lookout.as_ref()
    }

    /// Whether the platform's labels answer about the views, and no model.
    #[must_use]
    pub fn sees_labels(&self) -> bool {
        self.sees_labels
    }

    /// Who asks, sees and summarises.
    #[must_use]
    pub fn observers(&self) -> ObservationRoles<'_> {
        ObservationRoles {
            asker: self.asker.as_ref(),
            answerer: self.answerer.as_ref(),
            summariser: self.summariser.as_ref(),
            mode: self.mode,
            prompts_hash: self.prompts_hash.as_deref(),
            detector: self.detector.as_deref(),
        }
    }

    /// Who writes, and who writes if that fails.
    #[must_use]
    pub fn writers(&self) -> WriterPair<'_> {
        let finisher = self.finisher.as_ref().map(|finisher| finisher as &dyn InstructionWriter);
        WriterPair { writer: self.writer.as_ref(), finisher }
    }
}

/// Distance between the replicate numbers of two samples of a model: more than the number of times that any request is repeated
/// within a run.
const REPLICATES_PER_SAMPLE: u32 = 1 << 20;

/// A model with shifted replicate numbers, so that the ledger does not reuse the answers of another sample.
struct SampledModel {
    model: Arc<dyn LanguageModel>,
    sample: u32,
}

/// A model's sample of that number; the first is the model itself.
fn sample_model(model: Arc<dyn LanguageModel>, sample: u32) -> Arc<dyn LanguageModel> {
    if sample == 0 { model } else { Arc::new(SampledModel { model, sample }) }
}

impl LanguageModel for SampledModel {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn complete_requests(&self, requests: &[ModelRequest]) -> Vec<Result<ModelReply, ModelError>> {
        let again = |request: &ModelRequest| ModelRequest {
            replicate: request.replicate + self.sample * REPLICATES_PER_SAMPLE,
            ..request.clone()
        };
        self.model.complete_requests(&requests.iter().map(again).collect::<Vec<_>>())
    }

    fn context_tokens(&self) -> Option<u64> {
        self.model.context_tokens()
    }

    fn note(&self, note: String) {
        self.model.note(note);
    }
}

/// A model in a role. The spans of its calls have the role as their purpose.
struct PurposeModel {
    model: Arc<dyn LanguageModel>,
    purpose: &'static str,
}

impl LanguageModel for PurposeModel {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn complete_requests(&self, requests: &[ModelRequest]) -> Vec<Result<ModelReply, ModelError>> {
        CallContext::with_purpose(self.purpose, || self.model.complete_requests(requests))
    }

    fn context_tokens(&self) -> Option<u64> {
        self.model.context_tokens()
    }

    fn note(&self, note: String) {
        self.model.note(note);
    }
}

/// Reads the calibration that the settings name. Only labels that answer the questions of a dialogue use it, so it is refused if a
/// model answers, if the labels list everything, or if there is no dialogue.
fn settings_calibration(
    settings: &RunSettings,
    platform: &dyn Platform,
) -> Result<Option<Arc<Calibration>>, CommandError> {
    let Some(file) = &settings.calibration else { return Ok(None) };
    let reason = match () {
        () if settings.roles.see != RolePlayer::Labels => {
            "only the answers of labels depend on it, and a model answers here".to_owned()
        }
        () if platform.catalogue().lists_everything() => {
            format!("the labels of platform {} list everything", platform.name())
        }
        () if !settings.has_dialogue() => "without a dialogue, labels are not asked for single things".to_owned(),
        () => return Ok(Some(Arc::new(calibration::read_calibration(file, platform.name())?))),
    };
    Err(CommandError::usage(format!("--calibration {} has no effect: {reason}", file.display()), "leave it out"))
}

/// The built-in prompts, replaced by those in the user's folder.
///
/// # Errors
/// When the folder has no prompts, or one of them cannot be used.
pub fn settings_prompts(settings: &RunSettings) -> Result<Prompts, CommandError> {
    let own = settings.roles.prompts.as_deref().map_or_else(|| Ok(Vec::new()), own_prompts)?;
    Ok(Prompts::new(&own)?)
}

/// Every template of a folder. An unknown name is kept here and refused later, so that a misspelt template is not silently
/// ignored.
fn own_prompts(folder: &Path) -> Result<Vec<(String, String)>, CommandError> {
    let mut own = Vec::new();
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    for entry in entries.map_err(CommandError::io(folder, "list the prompts of"))? {
        let file = entry.path();
        if let (Some(name), Some("j2")) = (file.file_stem(), file.extension().and_then(|end| end.to_str())) {
            own.push((name.to_string_lossy().into_owned(), text_file::read_text_file(&file, "read the prompt")?));
        }
    }
    own.sort();
    if own.is_empty() {
        return Err(CommandError::usage(
            format!("--prompts {}: this folder has no prompt", folder.display()),
            format!("put one of these files into it: {}.j2", Prompts::names().collect::<Vec<_>>().join(".j2, ")),
        ));
    }
    Ok(own)
}
