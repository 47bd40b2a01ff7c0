//! The agent `tools`, which lets a language model decide its moves: the model, how the agent sees, and the limits of its walks.

use super::{
    instruction_sets::ComparisonItem,
    settings::{ComparisonSettings, ToolAgentSettings},
};
use crate::compare::tool_agent_eyes::ToolAgentEyes;
use std::sync::Arc;
use wayword_core::{LanguageModel, ModelError, Platform, View};
use wayword_navigation::{
    agents::{MAX_INSTRUCTION_CHARS, ModelWalker, ToolAgentSight, ToolWalkLimits, ViewDescriber},
    walk::AgentWalkRecord,
};
use wayword_run::{
    calls::ModelCalls,
    count::count_phrase,
    error::CommandError,
    output::CommandOutput,
    plan::JobModels,
    settings::{RolePlayer, RunRoles, RunSettings},
    team::RoleTeam,
};
use wayword_synthesis::observe::caption_view;

/// The agent `tools` with its model, the model's price, its eyes and its limits.
pub(super) struct AgentToolbox {
    model: Arc<dyn LanguageModel>,
    /// The cost in US dollars of so many tokens in and tokens out; `None` if the price of the model is not known.
    price: Option<Box<dyn Fn(u64, u64) -> f64 + Send + Sync>>,
    sight: ToolboxSight,
    limits: ToolWalkLimits,
    seed: u64,
    /// How many walks of one item are made at a time.
    pub(super) at_once: usize,
}

/// How the agent sees.
enum ToolboxSight {
    /// The platform's labels describe the views.
    Labels,
    /// The agent's own model is shown the pictures.
    Pictures,
    /// Another model describes the pictures.
    Captions(TeamCaptions),
}

/// Describes views with captions, which a team of models makes as in a run.
struct TeamCaptions(Box<RoleTeam>);

impl AgentToolbox {
    /// Opens the agent of a comparison; `None` if it does not take part.
    ///
    /// # Errors
    /// When a model cannot be reached by its name.
    pub(super) fn open(
        config: &ComparisonSettings,
        settings: &RunSettings,
        (calls, models, items): (Option<&ModelCalls>, &JobModels<'_>, usize),
        platform: &dyn Platform,
    ) -> Result<Option<Self>, CommandError> {
        let Some((tools, calls)) = config.tools.as_ref().zip(calls) else { return Ok(None) };
        Ok(Some(Self {
            model: calls.open_model(&tools.llm)?,
            price: models
                .model_price(&tools.llm)
                .cloned()
                .map(|price| Box::new(move |tokens_in, tokens_out| price.cost_usd(tokens_in, tokens_out)) as _),
            sight: ToolboxSight::from_settings(tools, settings, calls, platform)?,
            limits: tools.limits,
            seed: config.seed,
            at_once: calls.views_at_once(items),
        }))
    }

    /// The agent in the form that makes walks.
    pub(super) fn model_walker(&self) -> ModelWalker<'_> {
        let (model, price, looks) = (self.model.as_ref(), self.price.as_deref(), self.sight.agent_sight());
        ModelWalker { model, price, looks, limits: self.limits, seed: self.seed }
    }

    /// Whether the agent needs pictures of its views.
    pub(super) fn needs_pictures(&self) -> bool {
        !matches!(self.sight, ToolboxSight::Labels)
    }
}

impl ToolboxSight {
    fn from_settings(
        tools: &ToolAgentSettings,
        settings: &RunSettings,
        calls: &ModelCalls,
        platform: &dyn Platform,
    ) -> Result<Self, CommandError> {
        match &tools.see {
            ToolAgentEyes::Player(RolePlayer::Labels) => Ok(Self::Labels),
            ToolAgentEyes::Pictures => Ok(Self::Pictures),
            ToolAgentEyes::Player(_) => Ok(Self::Captions(TeamCaptions(Box::new(RoleTeam::new(
                &describing_settings(settings),
                Some(calls),
                platform,
            )?)))),
        }
    }

    fn agent_sight(&self) -> ToolAgentSight<'_> {
        match self {
            Self::Labels => ToolAgentSight::Labels,
            Self::Pictures => ToolAgentSight::Pictures,
            Self::Captions(captions) => ToolAgentSight::Captions(captions),
        }
    }
}

impl ViewDescriber for TeamCaptions {
    fn describe_view(&self, view: &View) -> Result<String, ModelError> {
        Ok(caption_view(view, self.0.observers())?.text)
    }
}

/// The settings for describing views: those of the comparison, but only the role that sees is a model's.
pub(super) fn describing_settings(settings: &RunSettings) -> RunSettings {
    let roles = RunRoles {
        ask: RolePlayer::Rules,
        summarise: RolePlayer::Rules,
        write: RolePlayer::Rules,
        write_sees: false,
        ..settings.roles.clone()
    };
    RunSettings { roles, ..settings.clone() }
}

/// Refuses a limit on the cost of a walk if the price of its model is unknown.
///
/// # Errors
/// When there is a limit but no price.
pub(super) fn refuse_unknown_price(config: &ComparisonSettings, models: &JobModels<'_>) -> Result<(), CommandError> {
    match &config.tools {
        Some(ToolAgentSettings { llm, limits: ToolWalkLimits { max_usd: Some(usd), .. }, .. })
            if models.model_price(llm).is_none() =>
        {
            Err(CommandError::usage(
                format!("[tools] max_usd = {usd} cannot be kept: the price of {llm} is not known"),
                "add the price to a file, and give the file with --prices FILE",
            ))
        }
        _ => Ok(()),
    }
}

/// Withholds the first walks of a command until one reply of the model was of use. In this way a model that cannot call tools
/// at all leaves no worthless walks in the folder.
#[derive(Debug, Default)]
pub(super) struct WithheldWalks {
    /// The withheld walks, item by item.
    items: Vec<Vec<AgentWalkRecord>>,
    /// How many walks the model has made so far.
    walks: usize,
    /// Whether a reply was of use. From then on no walk is withheld.
    has_spoken: bool,
}

/// The command gives up after this many walks in which no reply was of use.
const MAX_FRUITLESS_WALKS: usize = 20;

impl WithheldWalks {
    /// Takes the walks of an item. Returns those that can be written to the folder now.
    ///
    /// # Errors
    /// When no reply so far was of use, and there were enough walks.
    pub(super) fn take_walks(
        &mut self,
        walks: Vec<AgentWalkRecord>,
    ) -> Result<Vec<Vec<AgentWalkRecord>>, CommandError> {
        let efforts = || walks.iter().filter_map(|walk| walk.effort.as_ref());
        self.has_spoken |= efforts().next().is_none() || efforts().any(|effort| effort.calls > effort.useless.sum());
        self.walks += efforts().count();
        let last = efforts().filter_map(|effort| effort.last_useless.clone()).next_back();
        self.items.push(walks);
        if self.has_spoken {
            return Ok(std::mem::take(&mut self.items));
        }
        if self.walks < MAX_FRUITLESS_WALKS {
            return Ok(Vec::new());
        }
        Err(CommandError::usage(
            format!(
                "--llm: none of the first {} walks had a reply of use; the last one: {}",
                self.walks,
                last.unwrap_or_default()
            ),
            "`wayword ledger show` has the replies, and docs/AGENTS.md says which are read",
        ))
    }

    /// The walks that are still withheld at the end of a command with few walks.
    pub(super) fn into_rest(self) -> Vec<Vec<AgentWalkRecord>> {
        self.items
    }
}

/// Warns of texts that are longer than the part that the model gets.
pub(super) fn warn_of_long_texts(items: &[ComparisonItem], output: &CommandOutput) {
    let texts = || items.iter().flat_map(|item| &item.texts).map(|text| text.text.chars().count());
    let long = texts().filter(|chars| *chars > MAX_INSTRUCTION_CHARS).count();
    if long > 0 {
        let texts = count_phrase(long, "text");
        output.say(format_args!("warning: of {texts} the model is told the first {MAX_INSTRUCTION_CHARS} characters"));
    }
}
