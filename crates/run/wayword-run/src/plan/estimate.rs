//! Estimates how many calls and tokens a run takes and what they cost, without making a call. The real prompts are filled with
//! texts of typical length in place of answers that do not exist yet.

use super::{
    Plan,
    bill::{Bill, Load, picture_tokens},
    views::{Different, Views},
};
use crate::{
    count::count,
    error::Error,
    item::Item,
    looking_for::nouns,
    pipeline,
    platforms::Remembering,
    settings::{Perception, Settings, is_model},
    styles::Measured,
    team::prompts,
};
use serde::Serialize;
use std::fmt;
use wayword_core::{Exchange, Observation, Path};
use wayword_synthesis::{
    prompts::{Manner, PromptError, Prompts},
    walk::Walk,
    writer::Brief,
};

/// The estimated calls of a run. It assumes that dialogues have their usual length, that no question or text is repeated, and
/// that the ledger is empty.
#[derive(Debug, Default, Serialize)]
pub struct Estimate {
    /// Items of the run that have a path.
    items: usize,
    /// Frames of their paths.
    frames: usize,
    /// Different views that are captioned, each of them once.
    views: usize,
    /// Most questions per view, the opening among them.
    questions: usize,
    /// The work of the detector, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    detector: Option<Looked>,
    /// One per model.
    models: Bill,
    /// The surplus of shards over a queue.
    #[serde(skip_serializing_if = "Option::is_none")]
    shards: Option<Shards>,
}

/// How much more workers need with `--shard` than with `--queue`: shards share calls only within a chunk.
#[derive(Debug, Serialize)]
struct Shards {
    /// Items in a chunk.
    chunk: usize,
    /// The number of different views in each chunk, summed over the chunks.
    views: usize,
    /// Calls above those of a queue.
    calls: u64,
    /// US dollars above those of a queue; absent if a price is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    usd: Option<f64>,
}

/// The phrases that a detector looks for.
#[derive(Debug, Serialize)]
struct Looked {
    /// The detector.
    model: String,
    /// Names that it looks for in every view by itself; the names of captions come on top.
    phrases: usize,
}

/// Typical texts in place of exchanges and captions that do not exist yet.
const TYPICAL_QUESTION: &str = "What stands on the left side of the room, and what does it look like?";
const TYPICAL_ANSWER: &str = "There is a small wooden table with a lamp on it, and a grey chair stands next to it.";
const TYPICAL_CAPTION: &str = "A living room with a grey sofa on the left, a wooden table in the middle, two chairs on the right and a lamp beside the window. A doorway leads to a hallway.";
const TYPICAL_INSTRUCTION: &str = "Walk past the grey sofa and turn left at the bookcase. Go through the doorway into the hallway and stop next to the small table.";
/// The share of its follow-up questions that a dialogue asks on average, because it ends after two answers without news.
const USUAL_SHARE: f64 = 0.55;
/// Questions that a structured answer leaves open, for each hundred views. The scripted eye leaves about as many.
const OPEN_PER_HUNDRED_VIEWS: u64 = 60;
/// Tokens of a typical reply of each kind.
const QUESTION_TOKENS: u64 = 20;
const ANSWER_TOKENS: u64 = 30;
const STRUCTURED_TOKENS: u64 = 350;
const CAPTION_TOKENS: u64 = 60;
const CONDENSED_TOKENS: u64 = 25;
const INSTRUCTION_TOKENS: u64 = 60;
impl Estimate {
    /// The estimate for the whole run. With `chunk`, the number of items in a chunk, it includes the surplus of shards over a
    /// queue.
    pub(super) fn of(plan: &Plan<'_>, chunk: Option<usize>) -> Result<Self, Error> {
        Self::of_items(plan, plan.items.iter(), chunk)
    }

    /// All calls, where a detector makes `per_view` of them for each view.
    pub(super) fn calls(&self, per_view: u64) -> u64 {
        self.models.calls() + per_view * self.views as u64
    }

    /// The estimate for some of the items.
    pub(super) fn of_items<'i>(
        plan: &Plan<'_>,
        items: impl Iterator<Item = &'i Item>,
        chunk: Option<usize>,
    ) -> Result<Self, Error> {
        let settings = &plan.job.settings;
        let prompts = prompts(settings)?;
        let mut estimate = Self { questions: questions(settings), ..Self::default() };
        let (mut all, mut here, mut apart) = (Views::default(), Views::default(), Different::default());
        let mut writing = Load::default();
        for (number, item) in items.enumerate() {
            if chunk.is_some_and(|chunk| number.is_multiple_of(chunk)) {
                apart += std::mem::take(&mut here).different();
            }
            let world = Remembering::new(plan.platform);
            // An item without a path fails in the run before any model is called.
            let Ok(path) = pipeline::path(item, settings, &world) else { continue };
            estimate.items += 1;
            estimate.frames += path.frames.len();
            all.add(&path, settings.frames);
            if chunk.is_some() {
                here.add(&path, settings.frames);
            }
            writing.add(write_load(&prompts, settings, &plan.styles, &path)?);
        }
        apart += here.different();
        let different = all.different();
        estimate.views = different.views as usize;
        if let Some(model) = &settings.roles.detector {
            let phrases = nouns(settings, &plan.styles)?.len();
            estimate.detector = Some(Looked { model: model.clone(), phrases });
        }
        let talk = Talk::of(&prompts, settings)?;
        estimate.models = talk.bill(plan, different, writing);
        estimate.shards = chunk.filter(|_| !estimate.models.is_empty()).map(|chunk| {
            let more = talk.bill(plan, apart - different, Load::default());
            Shards { chunk, views: apart.views as usize, calls: more.calls(), usd: more.usd() }
        });
        Ok(estimate)
    }
}

/// The most questions per view, including the fixed ones.
fn questions(settings: &Settings) -> usize {
    match settings.perception {
        Perception::Dialogue => settings.questions + 1,
        Perception::Fixed => 2,
        Perception::Single => 1,
        Perception::Structured => 1,
        Perception::FollowUp => settings.questions + 1,
    }
}

/// The average number of questions per view.
fn usual_questions(settings: &Settings) -> usize {
    match settings.perception {
        Perception::Dialogue => 1 + (settings.questions as f64 * USUAL_SHARE).round() as usize,
        Perception::Fixed | Perception::Single | Perception::Structured => questions(settings),
        Perception::FollowUp => 1,
    }
}

/// The load that the description of one view puts on the model that sees.
///
/// # Errors
/// When a prompt cannot be used.
pub fn seeing(settings: &Settings) -> Result<Load, Error> {
    Ok(Talk::of(&prompts(settings)?, settings)?.seeing)
}

/// The load of the dialogue about one view, by role.
struct Talk {
    asking: Load,
    seeing: Load,
    /// One question about what a structured answer left open.
    settling: Load,
    summing: Load,
    condensing: Load,
}

impl Talk {
    fn of(prompts: &Prompts, settings: &Settings) -> Result<Self, PromptError> {
        let rounds = usual_questions(settings);
        let mut transcript = Vec::new();
        let (mut asking, mut seeing) = (Load::default(), Load::default());
        let picture = picture_tokens(settings.roles.picture_px);
        for round in 0..rounds {
            if round > 0 {
                asking.call(&prompts.question(&transcript)?, QUESTION_TOKENS);
            }
            if round == 0 && settings.perception.is_structured() {
                seeing.call(&prompts.see(None)?, STRUCTURED_TOKENS);
            } else {
                seeing.call(&prompts.answer(Manner::Chat, TYPICAL_QUESTION, &transcript)?, ANSWER_TOKENS);
            }
            seeing.tokens_in += picture;
            transcript.push(Exchange::new(TYPICAL_QUESTION, TYPICAL_ANSWER));
        }
        let mut settling = Load::default();
        settling.call(&prompts.answer(Manner::Chat, TYPICAL_QUESTION, &[])?, ANSWER_TOKENS);
        settling.tokens_in += picture;
        let (mut summing, mut condensing) = (Load::default(), Load::default());
        summing.call(&prompts.summary(&transcript, &[], &[])?, CAPTION_TOKENS);
        let around = [("ahead", TYPICAL_CAPTION); 4];
        condensing.call(&prompts.condense(&around, 20, &[])?, CONDENSED_TOKENS);
        Ok(Self { asking, seeing, settling, summing, condensing })
    }

    /// The bill for this number of views, and for the texts.
    fn bill(&self, plan: &Plan<'_>, Different { views, panoramas }: Different, writing: Load) -> Bill {
        let settings = &plan.job.settings;
        let roles = &settings.roles;
        let dialogue = settings.has_dialogue();
        let open = if settings.perception == Perception::FollowUp { views * OPEN_PER_HUNDRED_VIEWS / 100 } else { 0 };
        let seeing = self.seeing.times(views).plus(self.settling.times(open));
        let summing = self.summing.times(views).plus(self.condensing.times(panoramas));
        let mut bill = Bill::default();
        for (role, model, load, takes_part) in [
            ("asks", &roles.ask, self.asking.times(views), dialogue),
            ("sees", &roles.see, seeing, true),
            ("summarises", &roles.summarise, summing, dialogue),
            ("writes", &roles.write, writing, true),
        ] {
            if is_model(model) && takes_part {
                bill.add(model, role, load);
            }
        }
        bill.price(&plan.models);
        bill
    }
}

/// The load of writing each text of a path once. Repairs come on top; their number is not known in advance.
fn write_load(prompts: &Prompts, settings: &Settings, styles: &[Measured], path: &Path) -> Result<Load, PromptError> {
    let seen = Observation { summary: TYPICAL_CAPTION.to_owned(), ..Observation::default() };
    let walk = Walk::new(path.clone(), vec![seen; path.frames.len()]);
    let memory = walk.memory();
    let mut load = Load::default();
    let pictures = if settings.roles.write_sees { path.frames.len().min(pipeline::MOST_SHOWN) as u64 } else { 0 };
    for Measured { style, profile, .. } in styles {
        let earlier: Vec<String> = (0..settings.per_path).map(|_| TYPICAL_INSTRUCTION.to_owned()).collect();
        for number in 0..settings.per_path {
            let brief =
                Brief { earlier: &earlier[..number], ..Brief::new(&walk, &memory, style, profile, settings.seed) };
            load.call(&prompts.write(&brief)?, INSTRUCTION_TOKENS);
            load.tokens_in += pictures * picture_tokens(settings.roles.picture_px);
        }
    }
    Ok(load.times(u64::from(settings.candidates)))
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (items, frames) = (count(self.items, "item"), count(self.frames, "frame"));
        writeln!(f, "{items}, {frames}, {} to caption", count(self.views, "different view"))?;
        if let Some(Looked { model, phrases }) = &self.detector {
            writeln!(
                f,
                "{model} looks for {} and what captions name in each of these views, free: it runs in process",
                count(*phrases, "thing")
            )?;
        }
        if self.models.is_empty() {
            let who = if self.detector.is_some() { "no other model" } else { "no model" };
            return write!(f, "{who} takes part, so the run costs nothing");
        }
        writeln!(
            f,
            "estimate, if dialogues end where they usually do, nothing is asked or written twice, and the ledger is empty:"
        )?;
        self.models.fmt(f)?;
        let Some(Shards { chunk, views, calls, usd }) = &self.shards else { return Ok(()) };
        let (views, calls) = (count(*views, "view"), count(*calls, "call"));
        write!(f, "\nwith --shard calls are shared within a chunk of {chunk} alone: {views} to caption, {calls}")?;
        match usd {
            Some(usd) => write!(f, " and ${usd:.2} more than with --queue"),
            None => write!(f, " more than with --queue"),
        }
    }
}
