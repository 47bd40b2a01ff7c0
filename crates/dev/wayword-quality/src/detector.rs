//! Measures the use of a detector with a known recall and a known rate of false alarms.
//!
//! The test kit plays the detector. Its figures are measured on half of the paths. On the other half, true and wrong landmarks
//! are checked by its finds. At the end, texts are written from a flawed eye's captions with the detector and without, and the
//! hallucinated objects in them are counted.

use crate::{
    eye::NamedObjectCounts,
    stage::{MeasuredWorldArgs, MeasurementStage},
};
use rand::seq::SliceRandom;
use std::{collections::BTreeSet, sync::Arc};
use wayword_checks::{CheckSubject, Evidence, check_text, detection::DetectorFigures};
use wayword_core::{CheckKind, InstructionStyle, Path, Verdict, seeded_rng};
use wayword_experiments::perceive::measure_detector;
use wayword_language::lexicon::{find_thing, names_agree, normalise_name};
use wayword_run::{
    error::CommandError,
    lookout::DetectorLookout,
    output::CommandOutput,
    pipeline::{item_path, path_panoramas},
    plan::RunPlan,
    platforms::RememberingPlatform,
    settings::{Perception, RunJob, RunSettings},
};
use wayword_synthesis::{
    detection::{seek_claims, usual_nouns},
    walk::FrameSelection,
};
use wayword_testkit::PlayedDetector;

/// The flags of `detector`.
#[derive(Debug, clap::Args)]
pub struct DetectorArgs {
    /// The platform.
    #[command(flatten)]
    world: MeasuredWorldArgs,
    /// Paths: the detector's figures are measured on every second one, and claims are made about the others.
    #[arg(long, default_value_t = 80)]
    paths: usize,
    /// Right and wrong landmarks about each path, at most so many of each.
    #[arg(long, default_value_t = 6)]
    claims: usize,
    /// The share of what a view shows that the detector finds.
    #[arg(long, default_value_t = 0.8)]
    recall: f64,
    /// The share of names, of those of things that a place does not show, that it finds there.
    #[arg(long, default_value_t = 0.1)]
    alarms: f64,
    /// Let it miss a thing from everywhere, once it misses it.
    #[arg(long)]
    repeats: bool,
    /// Share of the objects named by the eye that are not there.
    #[arg(long, default_value_t = 0.15)]
    hallucinated: f64,
    /// Paths that texts are written for.
    #[arg(long, default_value_t = 40)]
    texts: usize,
}

/// How many landmarks of a kind there were, and how many failed and passed.
#[derive(Debug, Clone, Copy, Default)]
struct LandmarkVerdictCount {
    all: usize,
    failed: usize,
    passed: usize,
}

/// Measures the figures of a played detector, and prints how the checks judge right and wrong landmarks by it.
///
/// # Errors
/// When the platform cannot be opened, a view cannot be had, or an item fails.
pub fn measure_played_detector(flags: &DetectorArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let stage = MeasurementStage::new(&flags.world, flags.hallucinated)?;
    let job = stage.writing_job(flags.paths)?;
    let job = RunJob { settings: RunSettings { frames: FrameSelection::Panoramic, ..job.settings }, ..job };
    let mut plan = RunPlan::for_looking(&job, &stage.world)?;
    let items = std::mem::take(&mut plan.items);
    let (measured, claimed): (Vec<_>, Vec<_>) = items.into_iter().enumerate().partition(|(at, _)| at % 2 == 0);
    plan.items = measured.into_iter().map(|(_, item)| item).collect();
    let found = measure_detector(&plan, usize::MAX, &played_lookout(flags, None), output)?;
    plan.items = claimed.into_iter().map(|(_, item)| item).collect();
    let (right, wrong, places) = judge_landmarks(flags, &plan, &found.figures)?;
    let share = |part: usize, whole: usize| 100.0 * part as f64 / whole.max(1) as f64;
    let line = |name: &str, LandmarkVerdictCount { all, failed, passed }: LandmarkVerdictCount| {
        format!(
            "{name:<10} {all:>6} {:>7.1}% {:>10.1}% {:>7.1}%",
            share(passed, all),
            share(all - passed - failed, all),
            share(failed, all)
        )
    };
    let again = if flags.repeats { "that repeat with a thing" } else { "independent of each other" };
    let mut lines = vec![
        format!(
            "a played detector: recall {:.2}, false alarms {:.2}, misses {again}; its figures from {} views of other paths",
            flags.recall, flags.alarms, found.views
        ),
        format!("landmarks along paths with {places} places"),
        "landmarks  number  passed  unverified  failed".to_owned(),
        line("right", right),
        line("wrong", wrong),
        format!("of those that failed, wrong: {:.1}%", share(wrong.failed, right.failed + wrong.failed)),
    ];
    lines.extend(hallucination_lines(flags, &stage, &found.figures)?);
    output.print_result(&(), lines.join("\n"));
    Ok(())
}

/// The played detector, with its measured figures, or with assumed ones where `figures` is `None`.
fn played_lookout(flags: &DetectorArgs, figures: Option<&DetectorFigures>) -> DetectorLookout {
    let DetectorArgs { recall, alarms, repeats, .. } = *flags;
    let played = PlayedDetector { same: names_agree, recall, alarms, repeats, seed: flags.world.seed };
    let figures = figures.cloned().unwrap_or_else(|| DetectorFigures::for_unmeasured("played/detector", 0.5));
    DetectorLookout::new(Arc::new(played), figures, usual_nouns(std::iter::empty()))
}

/// The verdicts on right landmarks and on wrong ones, and the number of different places on the paths.
fn judge_landmarks(
    flags: &DetectorArgs,
    plan: &RunPlan<'_>,
    figures: &DetectorFigures,
) -> Result<(LandmarkVerdictCount, LandmarkVerdictCount, usize), CommandError> {
    let lookout = played_lookout(flags, Some(figures));
    let pool = usual_nouns(std::iter::empty());
    let (mut right, mut wrong, mut places) =
        (LandmarkVerdictCount::default(), LandmarkVerdictCount::default(), BTreeSet::new());
    for item in &plan.items {
        let world = RememberingPlatform::new(plan.platform);
        let Ok(path) = item_path(item, &plan.job.settings, &world) else { continue };
        let Some(labels) = Evidence::from_labels(&path, &path_panoramas(&world, &path)?) else { continue };
        places.extend(path.frames.iter().map(|frame| (path.scene.clone(), frame.place_key())));
        let things = labels.frames.iter().flat_map(|frame| &frame.things).map(|thing| normalise_name(&thing.name));
        let present: BTreeSet<String> = things.filter(|name| is_landmark(name)).collect();
        let absent =
            pool.iter().filter(|name| is_landmark(name) && !present.iter().any(|other| names_agree(other, name)));
        let mut rng = seeded_rng(flags.world.seed, &["landmarks", &path.id]);
        let mut draw_names = |mut names: Vec<String>| {
            names.shuffle(&mut rng);
            names.truncate(flags.claims);
            names
        };
        let (present, absent) = (draw_names(present.iter().cloned().collect()), draw_names(absent.cloned().collect()));
        let evidence = detect_evidence(&path, &world, present.iter().chain(&absent), &lookout)?;
        present.iter().for_each(|name| right.add_verdict(judge_landmark(name, &evidence)));
        absent.iter().for_each(|name| wrong.add_verdict(judge_landmark(name, &evidence)));
    }
    Ok((right, wrong, places.len()))
}

/// Whether a text would use the thing as a landmark, by its salience in the lexicon.
fn is_landmark(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| thing.salience >= 2)
}

/// The evidence from the finds and misses of the detector, which looks for `names` from every frame of a path.
fn detect_evidence<'a>(
    path: &Path,
    world: &RememberingPlatform<'_>,
    names: impl Iterator<Item = &'a String>,
    lookout: &DetectorLookout,
) -> Result<Evidence, CommandError> {
    let seen = seek_claims(world, path, &names.cloned().collect(), lookout.to_seeker())?;
    Ok(Evidence::from_detector(path, &seen).unwrap_or_else(|| Evidence::for_path_alone(path)))
}

/// The verdict of the checks on a text that names one landmark.
fn judge_landmark(name: &str, evidence: &Evidence) -> Verdict {
    let style = InstructionStyle { name: "claims".to_owned(), ..InstructionStyle::default() };
    let checked = check_text(&format!("Walk past the {name}."), CheckSubject::closed_world(evidence, &style, None));
    let landmarks = checked.findings.iter().filter(|finding| finding.check == CheckKind::Landmarks);
    landmarks.map(|finding| finding.verdict).max().unwrap_or(Verdict::Unverified)
}

impl LandmarkVerdictCount {
    fn add_verdict(&mut self, verdict: Verdict) {
        self.all += 1;
        self.failed += usize::from(verdict == Verdict::Fail);
        self.passed += usize::from(verdict == Verdict::Pass);
    }
}

/// The hallucinated objects of texts that were written from a flawed eye's captions, without the detector and with it.
fn hallucination_lines(
    flags: &DetectorArgs,
    stage: &MeasurementStage,
    figures: &DetectorFigures,
) -> Result<Vec<String>, CommandError> {
    let job = stage.writing_job(flags.texts)?;
    let job = RunJob { settings: RunSettings { perception: Perception::Structured, ..job.settings }, ..job };
    let mut lines = vec![
        format!("texts by an eye that hallucinates {:.0} %", 100.0 * flags.hallucinated),
        "detector  texts  rejected  objects  hallucinated  texts with one".to_owned(),
    ];
    for (name, lookout) in [("without", None), ("with", Some(played_lookout(flags, Some(figures))))] {
        let mut named = NamedObjectCounts::default();
        for made in stage.make_items_with_detector(&job, lookout)?.0 {
            named.count_item(&made?, &stage.world)?;
        }
        lines.push(format!(
            "{name:<8} {:>6} {:>9} {:>8} {:>13} {:>14.1}%",
            named.texts,
            named.rejected,
            named.objects,
            named.hallucinated,
            100.0 * named.with_hallucinations as f64 / named.texts.max(1) as f64
        ));
    }
    Ok(lines)
}
