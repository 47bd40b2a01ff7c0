//! Measures what judging and writing again mends: a scripted author makes a known fault in every first text about walks through generated
//! houses, and a follower walks by the first text and by the one that is kept.
//!
//! The right texts are those of the rules. The author mends its fault when it is told of the words where it lies, and else only varies
//! its words.

use crate::{
    house_faults::{HouseFaultKind, plant_fault},
    stage::{MeasuredWorldArgs, MeasurementStage},
};
use serde::Serialize;
use std::{
    fmt,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_checks::Evidence;
use wayword_core::Path;
use wayword_run::{
    error::CommandError,
    follow::{KnownScenes, shares_of_arriving},
    pipeline::{MadeItem, path_panoramas},
    settings::FailureFinish,
};
use wayword_synthesis::repair::WritingOutcome;
use wayword_testkit::provider::{ScriptRequest, scripts::FlawedEye};

/// A walk counts as followed where a text leads to its end with this probability.
const FOLLOWED_SHARE: f64 = 0.5;
/// The scripted eye's errors, as shares: things that it is unsure of, and leaves out.
const HEDGED: f64 = 0.1;
const MISSED: f64 = 0.15;

/// What an author makes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum AuthorFault {
    /// A turn to the other side.
    TurnFlipped,
    /// A landmark of another part of the walk.
    LandmarkOfOtherPart,
    /// The last sentence is missing.
    EndLeftOut,
}

impl AuthorFault {
    const ALL: [Self; 3] = [Self::TurnFlipped, Self::LandmarkOfOtherPart, Self::EndLeftOut];

    /// The text with the fault; `None` where it cannot have it.
    fn plant(self, walk: &Path, text: &str, seed: u64) -> Option<String> {
        match self {
            Self::TurnFlipped => plant_fault(walk, text, HouseFaultKind::TurnFlipped, seed),
            Self::LandmarkOfOtherPart => plant_fault(walk, text, HouseFaultKind::LandmarkOfOtherPart, seed),
            Self::EndLeftOut => {
                let kept = text.trim_end_matches('.').strip_suffix(last_sentence(text))?.trim_end();
                (!kept.is_empty()).then(|| kept.to_owned())
            }
        }
    }
}

/// What the author writes about a walk.
#[derive(Debug, Clone)]
struct AuthorTask {
    fault: AuthorFault,
    right: String,
    faulty: String,
}

impl AuthorTask {
    /// The text that the author answers a prompt with.
    fn answer(&self, prompt: &str) -> String {
        let reasons: Vec<&str> = prompt.split("It was refused because: ").skip(1).collect();
        match reasons.iter().any(|reasons| self.is_told_of(reasons.lines().next().unwrap_or_default())) {
            true => self.right.clone(),
            false if reasons.is_empty() => self.faulty.clone(),
            false => self.faulty.replace("Walk", "Go").replace("Turn", "Then turn"),
        }
    }

    /// Whether reasons quote words of the clause with the fault. Of an end that is left out they quote the last sentence, or say that
    /// more has to be told.
    fn is_told_of(&self, reasons: &str) -> bool {
        let lacks_end = self.fault == AuthorFault::EndLeftOut;
        if lacks_end && ["stop", "end", "how far", "sentence"].iter().any(|word| reasons.contains(word)) {
            return true;
        }
        let clause = if lacks_end { last_sentence(&self.faulty) } else { changed_clause(&self.right, &self.faulty) };
        let clause = clause.to_lowercase();
        let quotes = reasons.split('"').skip(1).step_by(2).map(str::to_lowercase);
        quotes.into_iter().any(|quote| !quote.is_empty() && (clause.contains(&quote) || quote.contains(&clause)))
    }
}

/// The last sentence of a text.
fn last_sentence(text: &str) -> &str {
    let text = text.trim_end_matches('.');
    text.rsplit_once(". ").map_or(text, |(_, last)| last)
}

/// The clause of a text in which it differs from another one.
fn changed_clause<'t>(right: &str, faulty: &'t str) -> &'t str {
    let same = |(at, (a, b)): (usize, (char, char))| (a != b).then_some(at);
    let first = right.chars().zip(faulty.chars()).enumerate().find_map(same).unwrap_or_default();
    let at = faulty.char_indices().nth(first).map_or(0, |(at, _)| at);
    let is_mark = |c: char| matches!(c, '.' | ',');
    let from = faulty[..at].rfind(is_mark).map_or(0, |mark| mark + 1);
    let to = faulty[at..].find(is_mark).map_or(faulty.len(), |mark| at + mark);
    faulty[from..to].trim()
}

/// What writing again mends.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct RefinementFigures {
    /// Walks with a text of the rules that a follower arrives by, and that can have the fault.
    walks: usize,
    /// Walks that are followed by the first text, in which the author erred.
    followed_before: usize,
    /// Walks that are followed by the text that is kept.
    followed_after: usize,
    /// Walks that were followed before and are not after.
    lost: usize,
    /// Walks without a text in the end.
    rejected: usize,
    /// Walks whose kept text has no fault any more, whether a follower minds it or not.
    repaired: usize,
}

impl RefinementFigures {
    /// The share of walks that were not followed before, and are after.
    fn mended_share(self) -> f64 {
        let failures = self.walks - self.followed_before;
        (self.followed_after + self.lost).saturating_sub(self.followed_before) as f64 / failures.max(1) as f64
    }
}

impl fmt::Display for RefinementFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { walks, followed_before, followed_after, lost, rejected, repaired } = self;
        writeln!(f, "{walks} walks, each with a fault in its first text")?;
        writeln!(f, "followed by the first text: {followed_before}")?;
        writeln!(f, "followed by the text that is kept: {followed_after}, without a text: {rejected}")?;
        writeln!(f, "kept texts without the fault: {repaired}")?;
        write!(f, "mended: {:.1} % of the failures, lost: {lost}", 100.0 * self.mended_share())
    }
}

/// Writes texts about `paths` walks through generated houses with an author that errs in every first text, and follows them. A text that
/// fails a check is written again at most `repairs` times, and one that a follower does not arrive by at most `refine` times.
///
/// # Errors
/// When the provider cannot be started, or an item fails.
pub fn measure_refinement(
    paths: usize,
    (repairs, refine): (u32, u32),
    seed: u64,
) -> Result<RefinementFigures, CommandError> {
    let world = MeasuredWorldArgs { platform: "house".to_owned(), data: None, scan: None, seed };
    let now: Arc<Mutex<Option<AuthorTask>>> = Arc::default();
    let asked = Arc::clone(&now);
    let author = move |request: &ScriptRequest| {
        let task = asked.lock().unwrap_or_else(PoisonError::into_inner);
        task.as_ref().map_or_else(|| "There is no task.".to_owned(), |task| task.answer(request.prompt()))
    };
    let eye = |eye| FlawedEye { miss_share: MISSED, hedge_share: HEDGED, ..eye };
    let stage = MeasurementStage::with_author(&world, eye, author)?;
    let mut job = stage.looking_job(paths)?;
    let (right, _) = stage.make_items(&job)?;
    let right: Vec<MadeItem> = right.into_iter().collect::<Result<_, _>>()?;
    let tasks: Vec<Option<AuthorTask>> =
        right.iter().enumerate().map(|(number, item)| plan_task(item, number, seed)).collect();
    job.settings.roles.write = stage.writing_job(paths)?.settings.roles.write;
    // A text that rules wrote in the author's place mends nothing.
    job.settings.roles.finish = FailureFinish::Nobody;
    (job.settings.repairs, job.settings.refine) = (repairs, refine);
    let made = stage.make_items_in_turn(&job, |number| {
        *now.lock().unwrap_or_else(PoisonError::into_inner) = tasks.get(number).cloned().flatten();
    })?;
    let scenes = KnownScenes::new();
    let mut figures = RefinementFigures::default();
    for (task, item) in tasks.iter().zip(&made) {
        let Some(task) = task else { continue };
        let kept = match item.outcomes.first() {
            Some(WritingOutcome::Accepted(instruction)) => Some(instruction.text.as_str()),
            _ => None,
        };
        let texts = [task.right.as_str(), &task.faulty, kept.unwrap_or_default()];
        let path = &item.walk.path;
        let labels = Evidence::from_labels(path, &path_panoramas(&stage.world, path)?);
        let evidence = labels.unwrap_or_else(|| Evidence::for_path_alone(path));
        let shares = shares_of_arriving(&stage.world, &scenes, path, &evidence, &texts)?;
        let is_followed = |at: usize| shares.get(at).copied().flatten().is_some_and(|share| share >= FOLLOWED_SHARE);
        if is_followed(0) {
            let (before, after) = (is_followed(1), kept.is_some() && is_followed(2));
            figures.walks += 1;
            figures.followed_before += usize::from(before);
            figures.followed_after += usize::from(after);
            figures.lost += usize::from(before && !after);
            figures.rejected += usize::from(kept.is_none());
            figures.repaired += usize::from(kept == Some(task.right.as_str()));
        }
    }
    Ok(figures)
}

/// The task about a walk, with the first fault in turn that its text can have.
fn plan_task(item: &MadeItem, number: usize, seed: u64) -> Option<AuthorTask> {
    let Some(WritingOutcome::Accepted(instruction)) = item.outcomes.first() else { return None };
    let right = &instruction.text;
    let kinds = (0..AuthorFault::ALL.len()).map(|at| AuthorFault::ALL[(number + at) % AuthorFault::ALL.len()]);
    kinds.into_iter().find_map(|fault| {
        let faulty = fault.plant(&item.walk.path, right, seed)?;
        Some(AuthorTask { fault, right: right.clone(), faulty })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_author_mends_its_fault_when_it_is_told_of_the_words_where_it_lies() {
        let task = AuthorTask {
            fault: AuthorFault::TurnFlipped,
            right: "Walk past the sofa. Turn left. Stop at the lamp.".into(),
            faulty: "Walk past the sofa. Turn right. Stop at the lamp.".into(),
        };
        let again = |reason: &str| task.answer(&format!("Write.\nIt was refused because: {reason}.\n"));
        assert_eq!(task.answer("Write."), task.faulty);
        assert_eq!(again("you wrote \"turn right\": no move of the path turns right here"), task.right);
        assert_eq!(again("\"lamp\" is not here"), "Go past the sofa. Then turn right. Stop at the lamp.");
    }

    #[test]
    fn writing_again_mends_what_an_author_gets_wrong_and_loses_nothing() {
        let figures = measure_refinement(6, (3, 1), 3).unwrap();
        assert!(figures.walks >= 4, "{figures}");
        assert!(figures.repaired > 0 && (figures.lost, figures.rejected) == (0, 0), "{figures}");
    }
}
