//! NaVILA's training data. For a policy: an item for each decision, with all pictures up to it and the action in words. For a speaker: an
//! item for each text, with a video; the text is the answer.
//!
//! Source: AnjieCheng/NaVILA, `llava/data/dataset.py` (`LazyVLNCEDataset`, `LazyEnvDropDataset`); the words of actions are those that
//! `evaluation/vlnce_baselines/cma_trainer.py` reads back.

use super::{
    action_runs::{ActionRun, MAX_ANSWER_STEPS, STEP_CM, action_runs, action_sentence},
    put_back::{TextsOfWalk, TextsPutBack},
    streamvln::take_relative_path,
};
use crate::{DatasetItem, Episode, FormatError, input, output};
use serde::Serialize;
use serde_json::{Value, json};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use wayword_core::{AgentAction, SceneId};

/// Angle of a turn, degrees.
const TURN_DEG: usize = 15;
/// Most pictures of one decision.
const MAX_FRAMES: usize = 25_000;

/// A decision of a policy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NavilaSample {
    /// The walk and the text: a name that the samples of one walk by one text share.
    pub video_id: String,
    /// The text.
    pub question: String,
    /// The action in words.
    pub answer: String,
    /// The pictures so far, below the folder of images; the last is the current view.
    pub frames: Vec<String>,
}

/// A text about a video, for speakers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NavilaSpeakerItem {
    /// The video, below the folder of videos.
    pub video: String,
    /// The text, which is the answer.
    pub instruction: String,
}

/// The samples of a walk by one text. `frame` names the picture before an action.
#[must_use]
pub fn navila_samples(
    video_id: &str,
    text: &str,
    actions: &[AgentAction],
    frame: impl Fn(usize) -> String,
) -> Vec<NavilaSample> {
    let sample = |run: ActionRun| NavilaSample {
        video_id: video_id.to_owned(),
        question: text.to_owned(),
        answer: action_sentence(run, TURN_DEG, "degree"),
        frames: (0..=run.first).map(&frame).collect(),
    };
    action_runs(actions, MAX_ANSWER_STEPS).into_iter().map(sample).collect()
}

/// The actions of an answer; `None` if it says none. NaVILA's evaluation reads words in this order, and rounds to whole steps.
#[must_use]
pub fn actions_of_answer(answer: &str) -> Option<Vec<AgentAction>> {
    let answer = answer.to_ascii_lowercase();
    let number_after = |words: &str| -> Option<usize> {
        let rest = answer.split_once(words)?.1.trim_start();
        rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    };
    if answer.split(|c: char| !c.is_alphanumeric()).any(|word| word == "stop") {
        return Some(vec![AgentAction::Stop]);
    }
    let told = [
        ("is move forward", AgentAction::Forward, STEP_CM),
        ("is turn left", AgentAction::Left, TURN_DEG),
        ("is turn right", AgentAction::Right, TURN_DEG),
    ];
    let (words, action, unit) = told.into_iter().find(|(words, ..)| answer.contains(words))?;
    let count = (number_after(words)? + unit / 2) / unit;
    (1..=MAX_ANSWER_STEPS).contains(&count).then(|| vec![action; count])
}

/// Writes `annotations.json` of a policy: one sample a line.
///
/// # Errors
/// When it cannot be written.
pub fn write_navila_samples(file: &Path, samples: impl IntoIterator<Item = NavilaSample>) -> Result<(), FormatError> {
    let line = |sample: NavilaSample| json!({"video_id": sample.video_id, "q": sample.question, "a": sample.answer, "frames": sample.frames});
    output::write_file(file, |out| output::write_list(out, samples.into_iter().map(line)))
}

/// Writes the file of a speaker.
///
/// # Errors
/// When it cannot be written.
pub fn write_navila_speaker(file: &Path, items: &[NavilaSpeakerItem]) -> Result<(), FormatError> {
    output::write_file(file, |out| output::write_list(out, items))
}

/// Passes each sample of `annotations.json` (a list or lines) to `take`, in order. The samples of a file can be larger than memory,
/// because each repeats the pictures before it.
///
/// # Errors
/// When the file cannot be read, or an item breaks a rule of the layout; and the first error of `take`.
pub fn each_navila_sample(
    file: &Path,
    mut take: impl FnMut(NavilaSample) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    input::each_item(file, |mut item| {
        let sample = take_sample(&mut item)?;
        take(sample)
    })
}

fn take_sample(item: &mut DatasetItem<'_>) -> Result<NavilaSample, FormatError> {
    let id = item.take_field("video_id")?;
    let video_id = item.checked_name("video_id", &id)?;
    item.set_id(&video_id);
    let question = item.take_field("q")?;
    let question = item.checked_instruction("q", &question)?;
    let answer = item.take_field("a")?;
    let answer = item.checked_text("a", &answer)?.to_owned();
    let frames = item.take_field("frames")?;
    let list = item.checked_list("frames", &frames, MAX_FRAMES)?;
    let frame = |(at, value): (usize, &Value)| take_relative_path(item, &format!("frames[{at}]"), value);
    let frames = list.iter().enumerate().map(frame).collect::<Result<Vec<_>, _>>()?;
    if frames.is_empty() {
        return Err(item.wrong_field("frames", "it is empty", "the last picture is the current view"));
    }
    Ok(NavilaSample { video_id, question, answer, frames })
}

/// A walk as the samples of one text tell it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NavilaWalk {
    /// The name that its samples share.
    pub video_id: String,
    /// The text.
    pub text: String,
    /// The pictures, one before each action.
    pub frames: Vec<String>,
    /// The actions, if the answers of the samples say every one of them.
    pub actions: Option<Vec<AgentAction>>,
}

/// Joins the samples of a file to walks: those of one `video_id` and one text, in the order of their first samples.
///
/// # Errors
/// As [`each_navila_sample`].
pub fn read_navila_walks(file: &Path) -> Result<Vec<NavilaWalk>, FormatError> {
    let mut walks: Vec<((String, String), JoinedSamples)> = Vec::new();
    let mut places: BTreeMap<(String, String), usize> = BTreeMap::new();
    each_navila_sample(file, |sample| {
        let key = (sample.video_id, sample.question);
        let place = *places.entry(key.clone()).or_insert_with(|| {
            walks.push((key, JoinedSamples::default()));
            walks.len() - 1
        });
        let Some((_, walk)) = walks.get_mut(place) else { return Ok(()) };
        let decided_at = sample.frames.len() - 1;
        walk.decisions.insert(decided_at, actions_of_answer(&sample.answer));
        if sample.frames.len() > walk.frames.len() {
            walk.frames = sample.frames;
        }
        Ok(())
    })?;
    let walk = |((video_id, text), joined): ((String, String), JoinedSamples)| NavilaWalk {
        video_id,
        text,
        actions: joined.actions(),
        frames: joined.frames,
    };
    Ok(walks.into_iter().map(walk).collect())
}

/// The samples of one walk by one text.
#[derive(Default)]
struct JoinedSamples {
    frames: Vec<String>,
    /// What is done from a picture on, by its number.
    decisions: BTreeMap<usize, Option<Vec<AgentAction>>>,
}

impl JoinedSamples {
    /// The actions of all decisions, if each begins where the one before ends.
    fn actions(&self) -> Option<Vec<AgentAction>> {
        let mut actions = Vec::new();
        for (decided_at, told) in &self.decisions {
            if *decided_at != actions.len() {
                return None;
            }
            actions.extend(told.clone()?);
        }
        (actions.len() == self.frames.len() && actions.last() == Some(&AgentAction::Stop)).then_some(actions)
    }
}

/// Writes the decisions of the walks of `file` again with other texts, by the name of the walk. A walk without a text, or with answers that
/// do not say every action, is left out. Returns what was put back.
///
/// # Errors
/// When `file` cannot be read, or `out` cannot be written.
pub fn write_navila_texts(file: &Path, out: &Path, texts: TextsOfWalk<'_>) -> Result<TextsPutBack, FormatError> {
    // The walk of each name occurs once for each text that it had.
    let mut seen = BTreeSet::new();
    let (mut walks, mut count) = (Vec::new(), TextsPutBack::default());
    for walk in read_navila_walks(file)? {
        if seen.insert(walk.video_id.clone()) {
            let texts = if walk.actions.is_some() { texts(&walk.video_id) } else { Vec::new() };
            if count.take_walk(texts.len()) {
                walks.push((walk, texts));
            }
        }
    }
    let samples = walks.iter().flat_map(|(walk, texts)| {
        let actions = walk.actions.as_deref().unwrap_or_default();
        let frame = |number: usize| walk.frames.get(number).cloned().unwrap_or_default();
        texts.iter().flat_map(move |text| navila_samples(&walk.video_id, text, actions, frame))
    });
    write_navila_samples(out, samples)?;
    Ok(count)
}

/// Reads the walks as episodes of recordings: the scene of each is its `video_id`.
///
/// # Errors
/// As [`read_navila_walks`]; when a `video_id` is no name of a scene.
pub fn read_navila_episodes(file: &Path) -> Result<Vec<Episode>, FormatError> {
    let mut episodes: Vec<Episode> = Vec::new();
    for walk in read_navila_walks(file)? {
        if let Some(known) = episodes.iter_mut().find(|known| known.id == walk.video_id) {
            known.instructions.push(walk.text);
            continue;
        }
        let scene = SceneId::new(walk.video_id.as_str()).map_err(|error| {
            FormatError::for_document(file, format!("video_id {:?}: {error}", walk.video_id), "give it another name")
        })?;
        episodes.push(Episode::for_recording(scene, vec![walk.text]));
    }
    Ok(episodes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn other_words_of_people_are_read_as_the_evaluation_reads_them() {
        let said = |answer: &str| actions_of_answer(answer).map(|actions| (actions[0], actions.len()));
        assert_eq!(said("The next action is turn left 30 degree."), Some((AgentAction::Left, 2)));
        assert_eq!(said("the next action IS MOVE FORWARD 70 cm"), Some((AgentAction::Forward, 3)));
        assert_eq!(said("The next action is stop."), Some((AgentAction::Stop, 1)));
        assert_eq!(said("The next action is move forward 0.75 m"), None);
        assert_eq!(said("Nonstop!"), None);
    }

    proptest! {
        #[test]
        fn samples_are_joined_to_the_walk_that_they_came_from(moves in proptest::collection::vec(1..=3_u8, 0..40)) {
            let actions: Vec<AgentAction> = moves.iter().chain(&[0]).map(|number| AgentAction::try_from(*number).unwrap()).collect();
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join("annotations.json");
            let samples = navila_samples("a-0", "Go on.", &actions, |number| format!("a/frame_{number}.jpg"));
            write_navila_samples(&file, samples).unwrap();
            let walks = read_navila_walks(&file).unwrap();
            prop_assert_eq!(walks.len(), 1);
            prop_assert_eq!(walks[0].frames.len(), actions.len());
            prop_assert_eq!(walks[0].actions.as_ref(), Some(&actions));
        }
    }
}
