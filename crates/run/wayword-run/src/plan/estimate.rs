//! Estimates how many calls and tokens a run takes and what they cost, without making a call. The real prompts are filled with
//! texts of typical length in place of answers that do not exist yet.

use super::{
    RunPlan,
    bill::{CallLoad, ModelBill, picture_tokens},
    views::{DistinctCounts, DistinctViews},
};
use crate::{
    count::count_phrase,
    error::CommandError,
    item::RunItem,
    lookout::proposed_names,
    pipeline,
    platforms::RememberingPlatform,
    settings::{Perception, RunSettings},
    styles::MeasuredStyle,
    team::settings_prompts,
};
use serde::Serialize;
use std::fmt;
use wayword_core::{
    Caption, CaptionedView, DialogueExchange, FrameObservation, ObjectSighting, Path, ViewGaze, ViewThird,
    WitnessAnswer,
};
use wayword_synthesis::{
    prompts::{PromptError, PromptManner, Prompts},
    walk::ObservedWalk,
    writer::WritingBrief,
};

/// The estimated calls of a run. It assumes that dialogues have their usual length, that as many texts are written again as usual,
/// and that the ledger is empty.
#[derive(Debug, Default, Serialize)]
pub struct RunEstimate {
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
    detector: Option<DetectorEstimate>,
    /// One per model.
    models: ModelBill,
    /// Of a hundred texts of a model, those that are written again for a follower.
    refined: u64,
    /// Of a hundred texts of a model, those about which the model that sees is asked.
    asked: u64,
    /// The surplus of shards over a queue.
    #[serde(skip_serializing_if = "Option::is_none")]
    shards: Option<ShardSurcharge>,
}

/// How much more workers need with `--shard` than with `--queue`: shards share calls only within a chunk.
#[derive(Debug, Serialize)]
struct ShardSurcharge {
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
struct DetectorEstimate {
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
/// The share of its possible follow-up questions that a dialogue asks on average, because it ends after two answers
/// without news.
const USUAL_QUESTION_SHARE: f64 = 0.55;
/// Questions that a structured answer leaves open, for each hundred views. The scripted eye leaves about as many.
const OPEN_PER_HUNDRED_VIEWS: u64 = 60;
/// Tokens of a typical reply of each kind: a question, an answer, a structured answer, and so on.
const QUESTION_TOKENS: u64 = 20;
const ANSWER_TOKENS: u64 = 30;
const STRUCTURED_TOKENS: u64 = 350;
const CAPTION_TOKENS: u64 = 60;
const CONDENSED_TOKENS: u64 = 25;
const INSTRUCTION_TOKENS: u64 = 60;
impl RunEstimate {
    /// The estimate for the whole run. With `chunk`, the number of items in a chunk, it includes the surplus of shards over a
    /// queue.
    pub(super) fn for_plan(plan: &RunPlan<'_>, chunk: Option<usize>) -> Result<Self, CommandError> {
        Self::for_items(plan, plan.items.iter(), chunk)
    }

    /// All calls, where a detector makes `per_view` of them for each view.
    pub(super) fn call_count(&self, per_view: u64) -> u64 {
        self.models.call_count() + per_view * self.views as u64
    }

    /// The estimate for some of the items.
    pub(super) fn for_items<'i>(
        plan: &RunPlan<'_>,
        items: impl Iterator<Item = &'i RunItem>,
        chunk: Option<usize>,
    ) -> Result<Self, CommandError> {
        let settings = &plan.job.settings;
        let prompts = settings_prompts(settings)?;
        let refined = refined_per_hundred(settings);
        let asked = asked_per_hundred(settings);
        let mut estimate = Self { questions: max_questions(settings), refined, asked, ..Self::default() };
        let (mut run_views, mut chunk_views, mut chunk_sum) =
            (DistinctViews::default(), DistinctViews::default(), DistinctCounts::default());
        let mut writing = CallLoad::default();
        for (number, item) in items.enumerate() {
            if chunk.is_some_and(|chunk| number.is_multiple_of(chunk)) {
                chunk_sum += std::mem::take(&mut chunk_views).count_distinct();
            }
            let world = RememberingPlatform::new(plan.platform);
            // An item without a path fails in the run before any model is called.
            let Ok(path) = pipeline::item_path(item, settings, &world) else { continue };
            estimate.items += 1;
            estimate.frames += path.frames.len();
            run_views.add_path(&path, settings.frames);
            if chunk.is_some() {
                chunk_views.add_path(&path, settings.frames);
            }
            writing.add(write_load(&prompts, settings, &plan.styles, &path)?);
        }
        let repaired = if settings.repairs > 0 { REPAIRS_PER_HUNDRED } else { 0 };
        writing.add(writing.share(repaired + refined));
        chunk_sum += chunk_views.count_distinct();
        let distinct = run_views.count_distinct();
        estimate.views = distinct.views as usize;
        if let Some(model) = &settings.roles.detector {
            let phrases = proposed_names(settings, &plan.styles)?.len();
            estimate.detector = Some(DetectorEstimate { model: model.clone(), phrases });
        }
        let talk = DialogueLoad::for_settings(&prompts, settings)?;
        estimate.models = talk.make_bill(plan, distinct, writing);
        estimate.shards = chunk.filter(|_| !estimate.models.is_empty()).map(|chunk| {
            let surplus = talk.make_bill(plan, chunk_sum - distinct, CallLoad::default());
            ShardSurcharge {
                chunk,
                views: chunk_sum.views as usize,
                calls: surplus.call_count(),
                usd: surplus.total_usd(),
            }
        });
        Ok(estimate)
    }
}

/// The most questions per view, including the fixed ones.
fn max_questions(settings: &RunSettings) -> usize {
    match settings.perception {
        Perception::Dialogue => settings.questions + 1,
        Perception::Fixed => 2,
        Perception::Single => 1,
        Perception::Structured => 1,
        Perception::FollowUp => settings.questions + 1,
    }
}

/// The average number of questions per view.
fn usual_questions(settings: &RunSettings) -> usize {
    match settings.perception {
        Perception::Dialogue => 1 + (settings.questions as f64 * USUAL_QUESTION_SHARE).round() as usize,
        Perception::Fixed | Perception::Single | Perception::Structured => max_questions(settings),
        Perception::FollowUp => 1,
    }
}

/// The load that the description of one view puts on the model that sees.
///
/// # Errors
/// When a prompt cannot be used.
pub fn seeing_load(settings: &RunSettings) -> Result<CallLoad, CommandError> {
    Ok(DialogueLoad::for_settings(&settings_prompts(settings)?, settings)?.seeing)
}

/// The load of the dialogue about one view, by role.
struct DialogueLoad {
    asking: CallLoad,
    seeing: CallLoad,
    /// One question about what a structured answer left open.
    settling: CallLoad,
    summing: CallLoad,
    condensing: CallLoad,
}

impl DialogueLoad {
    fn for_settings(prompts: &Prompts, settings: &RunSettings) -> Result<Self, PromptError> {
        let rounds = usual_questions(settings);
        let mut transcript = Vec::new();
        let (mut asking, mut seeing) = (CallLoad::default(), CallLoad::default());
        let picture = picture_tokens(settings.roles.picture_px);
        for round in 0..rounds {
            if round > 0 {
                asking.add_call(&prompts.question_prompt(&transcript)?, QUESTION_TOKENS);
            }
            if round == 0 && settings.perception.is_structured() {
                seeing.add_call(&prompts.view_prompt(None)?, STRUCTURED_TOKENS);
            } else {
                seeing.add_call(
                    &prompts.answer_prompt(PromptManner::Chat, TYPICAL_QUESTION, &transcript)?,
                    ANSWER_TOKENS,
                );
            }
            seeing.tokens_in += picture;
            transcript.push(DialogueExchange::new(TYPICAL_QUESTION, TYPICAL_ANSWER));
        }
        let mut settling = CallLoad::default();
        settling.add_call(&prompts.answer_prompt(PromptManner::Chat, TYPICAL_QUESTION, &[])?, ANSWER_TOKENS);
        settling.tokens_in += picture;
        let (mut summing, mut condensing) = (CallLoad::default(), CallLoad::default());
        summing.add_call(&prompts.summary_prompt(&transcript, &[], &[])?, CAPTION_TOKENS);
        // A panorama is condensed to fewer than about 20 words.
        let around = [("ahead", TYPICAL_CAPTION); 4];
        condensing.add_call(&prompts.condense_prompt(&around, 20, &[])?, CONDENSED_TOKENS);
        Ok(Self { asking, seeing, settling, summing, condensing })
    }

    /// The bill for this number of views, and for the texts.
    fn make_bill(
        &self,
        plan: &RunPlan<'_>,
        DistinctCounts { views, panoramas }: DistinctCounts,
        writing: CallLoad,
    ) -> ModelBill {
        let settings = &plan.job.settings;
        let roles = &settings.roles;
        let dialogue = settings.has_dialogue();
        let open = if settings.perception == Perception::FollowUp { views * OPEN_PER_HUNDRED_VIEWS / 100 } else { 0 };
        // Rules write what labels show, so nothing is asked about their texts.
        let has_questions = roles.write.model_name().is_some();
        let about_texts = if has_questions { writing.calls * asked_per_hundred(settings) / 100 } else { 0 };
        let seeing = self.seeing.times(views).plus(self.settling.times(open + about_texts));
        let summing = self.summing.times(views).plus(self.condensing.times(panoramas));
        let mut bill = ModelBill::default();
        for (role, player, load, takes_part) in [
            ("asks", &roles.ask, self.asking.times(views), dialogue),
            ("sees", &roles.see, seeing, true),
            ("summarises", &roles.summarise, summing, dialogue),
            ("writes", &roles.write, writing, true),
        ] {
            if let Some(model) = player.model_name().filter(|_| takes_part) {
                bill.add_load(model, role, load);
            }
        }
        bill.fill_prices(&plan.models);
        bill
    }
}

/// Typical things of a frame, which change along the walk.
const TYPICAL_THINGS: [&str; 20] = [
    "sofa",
    "table",
    "lamp",
    "armchair",
    "plant",
    "mirror",
    "picture",
    "bookshelf",
    "clock",
    "rug",
    "bench",
    "vase",
    "cabinet",
    "desk",
    "curtain",
    "door",
    "shelf",
    "stool",
    "window",
    "bed",
];
/// Of a hundred texts of a model so many are written again because a check failed, and so many because a follower does not arrive by
/// them surely. A strong model needs fewer, a small one more.
const REPAIRS_PER_HUNDRED: u64 = 15;
const REFINED_PER_HUNDRED: u64 = 30;

/// Questions to the model that sees about a hundred texts of a model. Structured answers leave less open.
fn asked_per_hundred(settings: &RunSettings) -> u64 {
    if settings.perception.is_structured() { 15 } else { 60 }
}

/// Of a hundred texts, those that are written again for a follower. Where no labels show the scene, none is followed.
fn refined_per_hundred(settings: &RunSettings) -> u64 {
    let follows = settings.refine > 0 && !settings.no_route && settings.evidence.labels;
    if follows && settings.platform != "recording" { REFINED_PER_HUNDRED } else { 0 }
}

/// What a model typically says of the frames of a path.
fn typical_walk(path: &Path) -> ObservedWalk {
    let seen = |at: usize| {
        let sighting = |number: usize| ObjectSighting {
            place: Some([ViewThird::Left, ViewThird::Middle, ViewThird::Right][number % 3]),
            colour: number.is_multiple_of(2).then(|| ["white", "brown", "grey"][number % 3].to_owned()),
            is_far: number % 3 == 1,
            ..ObjectSighting::new(
                TYPICAL_THINGS[(at / 2 * 3 + number) % TYPICAL_THINGS.len()],
                WitnessAnswer::Seen,
                "model",
            )
        };
        let room = ["hallway", "living room", "kitchen"][at / 5 % 3].to_owned();
        let sightings = (0..TYPICAL_SIGHTINGS).map(sighting).collect();
        let caption = Caption { room: Some(room), sightings, is_structured: true, ..Caption::default() };
        let gaze = ViewGaze::quarter_view(path.frames[at].pose.heading);
        FrameObservation { looks: vec![CaptionedView { gaze, caption }], ..FrameObservation::default() }
    };
    ObservedWalk::new(path.clone(), (0..path.frames.len()).map(seen).collect())
}

/// How many things a typical answer names that the writer can use.
const TYPICAL_SIGHTINGS: usize = 8;

/// The load of writing each text of a path once.
fn write_load(
    prompts: &Prompts,
    settings: &RunSettings,
    styles: &[MeasuredStyle],
    path: &Path,
) -> Result<CallLoad, PromptError> {
    let walk = typical_walk(path);
    let memory = walk.memory();
    let mut load = CallLoad::default();
    let pictures =
        if settings.roles.write_sees { path.frames.len().min(pipeline::MAX_SHOWN_PICTURES) as u64 } else { 0 };
    for MeasuredStyle { style, profile, .. } in styles {
        let earlier: Vec<String> = (0..settings.per_path).map(|_| TYPICAL_INSTRUCTION.to_owned()).collect();
        for number in 0..settings.per_path {
            let brief = WritingBrief {
                earlier: &earlier[..number],
                ..WritingBrief::new(&walk, &memory, style, profile, settings.seed)
            };
            load.add_call(&prompts.writing_prompt(&brief)?, INSTRUCTION_TOKENS);
            load.tokens_in += pictures * picture_tokens(settings.roles.picture_px);
        }
    }
    Ok(load.times(u64::from(settings.candidates)))
}

impl fmt::Display for RunEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (items, frames) = (count_phrase(self.items, "item"), count_phrase(self.frames, "frame"));
        writeln!(f, "{items}, {frames}, {} to caption", count_phrase(self.views, "different view"))?;
        if let Some(DetectorEstimate { model, phrases }) = &self.detector {
            writeln!(
                f,
                "{model} looks for {} and what captions name in each of these views, free: it runs in process",
                count_phrase(*phrases, "thing")
            )?;
        }
        if self.models.is_empty() {
            let who = if self.detector.is_some() { "no other model" } else { "no model" };
            return write!(f, "{who} takes part, so the run costs nothing");
        }
        writeln!(
            f,
            "estimate, if dialogues end where they usually do and the ledger is empty; of 100 texts of a model {REPAIRS_PER_HUNDRED} \
             usually fail a check, {} raise a question to the model that sees, and {} are written again for a follower (--refine), \
             which is counted:",
            self.asked, self.refined
        )?;
        self.models.fmt(f)?;
        let Some(ShardSurcharge { chunk, views, calls, usd }) = &self.shards else { return Ok(()) };
        let (views, calls) = (count_phrase(*views, "view"), count_phrase(*calls, "call"));
        write!(f, "\nwith --shard calls are shared within a chunk of {chunk} alone: {views} to caption, {calls}")?;
        match usd {
            Some(usd) => write!(f, " and ${usd:.2} more than with --queue"),
            None => write!(f, " more than with --queue"),
        }
    }
}
