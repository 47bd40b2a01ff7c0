//! The agent `tools`, which lets a language model decide its moves: the model, how the agent sees, and the limits of its walks.

use super::{
    kept::{Kept, ToolsKept},
    sets::Item,
};
use crate::compare::args::PICTURES;
use std::sync::Arc;
use wayword_core::{LanguageModel, ModelError, Platform, View};
use wayword_navigation::{
    agents::{Describes, Limits, Looks, MOST_TEXT_CHARS, ModelWalker},
    walk::Walk,
};
use wayword_run::{
    calls::Calls,
    count::count,
    error::Error,
    output::Output,
    plan::Models,
    settings::{LABELS, RULES, Roles, Settings},
    team::Team,
};
use wayword_synthesis::observe::talk_about;

/// The agent `tools` with its model, the model's price, its eyes and its limits.
pub(super) struct Toolbox {
    model: Arc<dyn LanguageModel>,
    price: Option<Box<dyn Fn(u64, u64) -> f64 + Send + Sync>>,
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

/// Describes views with captions, which a team of models makes as in a run.
struct Captions(Box<Team>);

impl Toolbox {
    /// Opens the agent of a comparison; `None` if it does not take part.
    ///
    /// # Errors
    /// When a model cannot be reached by its name.
    pub(super) fn open(
        kept: &Kept,
        settings: &Settings,
        (calls, models, items): (Option<&Calls>, &Models<'_>, usize),
        platform: &dyn Platform,
    ) -> Result<Option<Self>, Error> {
        let Some((tools, calls)) = kept.tools.as_ref().zip(calls) else { return Ok(None) };
        Ok(Some(Self {
            model: calls.model(&tools.llm)?,
            price: models
                .price(&tools.llm)
                .cloned()
                .map(|price| Box::new(move |tokens_in, tokens_out| price.usd(tokens_in, tokens_out)) as _),
            sight: Sight::of(tools, settings, calls, platform)?,
            limits: tools.limits,
            seed: kept.seed,
            at_once: calls.views_at_once(items),
        }))
    }

    /// The agent in the form that makes walks.
    pub(super) fn walker(&self) -> ModelWalker<'_> {
        let (model, price, looks) = (self.model.as_ref(), self.price.as_deref(), self.sight.looks());
        ModelWalker { model, price, looks, limits: self.limits, seed: self.seed }
    }

    /// Whether the agent needs pictures of its views.
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

/// The settings for describing views: those of the comparison, but only the role that sees is a model's.
pub(super) fn describing(settings: &Settings) -> Settings {
    let [ask, summarise, write] = [RULES; 3].map(str::to_owned);
    let roles = Roles { ask, summarise, write, write_sees: false, ..settings.roles.clone() };
    Settings { roles, ..settings.clone() }
}

/// Refuses a limit on the cost of a walk if the price of its model is unknown.
///
/// # Errors
/// When there is a limit but no price.
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

/// Withholds the first walks of a command until one reply of the model was of use. In this way a model that cannot call tools
/// at all leaves no worthless walks in the folder.
#[derive(Debug, Default)]
pub(super) struct HeldBack {
    items: Vec<Vec<Walk>>,
    walks: usize,
    has_spoken: bool,
}

/// The command gives up after this many walks in which no reply was of use.
const FRUITLESS_WALKS: usize = 20;

impl HeldBack {
    /// Takes the walks of an item. Returns those that can be written to the folder now.
    ///
    /// # Errors
    /// When no reply so far was of use, and there were enough walks.
    pub(super) fn take(&mut self, walks: Vec<Walk>) -> Result<Vec<Vec<Walk>>, Error> {
        let efforts = || walks.iter().filter_map(|walk| walk.effort.as_ref());
        self.has_spoken |= efforts().next().is_none() || efforts().any(|effort| effort.calls > effort.useless.sum());
        self.walks += efforts().count();
        let last = efforts().filter_map(|effort| effort.last_useless.clone()).next_back();
        self.items.push(walks);
        if self.has_spoken {
            return Ok(std::mem::take(&mut self.items));
        }
        if self.walks < FRUITLESS_WALKS {
            return Ok(Vec::new());
        }
        Err(Error::usage(
            format!(
                "--llm: none of the first {} walks had a reply of use; the last one: {}",
                self.walks,
                last.unwrap_or_default()
            ),
            "`wayword ledger show` has the replies, and docs/AGENTS.md says which are read",
        ))
    }

    /// The walks that are still withheld at the end of a command with few walks.
    pub(super) fn rest(self) -> Vec<Vec<Walk>> {
        self.items
    }
}

/// Warns of texts that are longer than the part that the model gets.
pub(super) fn warn_of_long_texts(items: &[Item], output: &Output) {
    let texts = || items.iter().flat_map(|item| &item.texts).map(|text| text.text.chars().count());
    let long = texts().filter(|chars| *chars > MOST_TEXT_CHARS).count();
    if long > 0 {
        let texts = count(long, "text");
        output.say(format_args!("warning: of {texts} the model is told the first {MOST_TEXT_CHARS} characters"));
    }
}
