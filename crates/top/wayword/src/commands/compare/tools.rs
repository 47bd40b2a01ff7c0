//! The agent by a language model: who decides, how it sees, and what its walks take.

use super::kept::{Kept, ToolsKept};
use crate::{
    calls::Calls,
    cli::PICTURES,
    error::Error,
    plan::Models,
    settings::{LABELS, RULES, Roles, Settings},
    team::Team,
};
use std::sync::Arc;
use wayword_core::{LanguageModel, ModelError, Platform, View};
use wayword_navigation::{
    agents::{Describes, Limits, Looks, Tools},
    walk::{Useless, Walk},
};
use wayword_synthesis::observe::talk_about;

/// Who walks by tools, and with what.
pub(super) struct Toolbox {
    pub(super) model: Arc<dyn LanguageModel>,
    sight: Sight,
    limits: Limits,
    seed: u64,
    /// How many walks of one item are made at a time.
    pub(super) at_once: usize,
}

/// How the agent sees.
enum Sight {
    Labels,
    Pictures,
    Captions(Captions),
}

/// The captions that a run would give the views, so that both share the answers in the ledger.
struct Captions(Box<Team>);

impl Toolbox {
    /// Of a comparison; `None` where it has no such agent.
    ///
    /// # Errors
    /// When a model cannot be reached by its name.
    pub(super) fn open(
        kept: &Kept,
        settings: &Settings,
        (calls, items): (Option<&Calls>, usize),
        platform: &dyn Platform,
    ) -> Result<Option<Self>, Error> {
        let Some((tools, calls)) = kept.tools.as_ref().zip(calls) else { return Ok(None) };
        Ok(Some(Self {
            model: calls.model(&tools.llm)?,
            sight: Sight::of(tools, settings, calls, platform)?,
            limits: tools.limits,
            seed: kept.seed,
            at_once: calls.views_at_once(items),
        }))
    }

    /// The agent as it walks.
    pub(super) fn tools(&self) -> Tools<'_> {
        Tools { model: self.model.as_ref(), looks: self.sight.looks(), limits: self.limits, seed: self.seed }
    }

    /// Whether anybody looks at pictures.
    pub(super) fn needs_pictures(&self) -> bool {
        !matches!(self.sight, Sight::Labels)
    }
}

impl Sight {
    fn of(tools: &ToolsKept, settings: &Settings, calls: &Calls, platform: &dyn Platform) -> Result<Self, Error> {
        match tools.see.as_str() {
            LABELS => Ok(Self::Labels),
            PICTURES => Ok(Self::Pictures),
            _ => Ok(Self::Captions(Captions(Box::new(Team::new(&describing(settings), Some(calls), platform)?)))),
        }
    }

    fn looks(&self) -> Looks<'_> {
        match self {
            Self::Labels => Looks::Labels,
            Self::Pictures => Looks::Pictures,
            Self::Captions(captions) => Looks::Captions(captions),
        }
    }
}

impl Describes for Captions {
    fn describe(&self, view: &View) -> Result<String, ModelError> {
        Ok(talk_about(view, self.0.observers())?.text)
    }
}

/// The settings by which views are described: those of the comparison, where nobody but the model that sees takes part.
pub(super) fn describing(settings: &Settings) -> Settings {
    let [ask, summarise, write] = [RULES; 3].map(str::to_owned);
    let roles = Roles { ask, summarise, write, write_sees: false, ..settings.roles.clone() };
    Settings { roles, ..settings.clone() }
}

/// Refuses a limit on the money of a walk where nobody knows what its model costs.
///
/// # Errors
/// When there is such a limit.
pub(super) fn refuse_unknown_price(kept: &Kept, models: &Models<'_>) -> Result<(), Error> {
    match &kept.tools {
        Some(ToolsKept { llm, limits: Limits { max_usd: Some(usd), .. }, .. }) if models.price(llm).is_none() => {
            Err(Error::usage(
                format!("[tools] max_usd = {usd} cannot be kept: the price of {llm} is not known"),
                "add the price to a file, and give the file with --prices FILE",
            ))
        }
        _ => Ok(()),
    }
}

/// Counts walks without a single reply that calls a tool. The first ones of a command say whether the model can do this at
/// all.
#[derive(Debug, Default)]
pub(super) struct Mute {
    walks: usize,
    speaks: bool,
}

/// Walks without such a reply after which the command gives up, where there was none with one.
const FRUITLESS_WALKS: usize = 20;

impl Mute {
    /// Counts the walks of an item.
    ///
    /// # Errors
    /// When all walks so far were mute, and they are enough.
    pub(super) fn count(&mut self, walks: &[Walk]) -> Result<(), Error> {
        for effort in walks.iter().filter_map(|walk| walk.effort.as_ref()) {
            let Useless { no_call, no_way, idle, failed } = effort.useless;
            self.speaks |= effort.calls > no_call + no_way + idle + failed;
            self.walks += 1;
        }
        if self.speaks || self.walks < FRUITLESS_WALKS {
            return Ok(());
        }
        Err(Error::usage(
            format!("--llm: none of the first {} walks had a reply that could be used", self.walks),
            "`wayword ledger list` shows the replies; docs/AGENTS.md says which the agent reads",
        ))
    }
}
