//! Measures a detector against labels: its recall of the things that labels list, and its false alarms for things that they do
//! not list.

use super::views::item_path;
use rand::seq::SliceRandom;
use serde::Serialize;
use std::{collections::BTreeSet, fmt};
use wayword_checks::{
    Evidence, FrameEvidence,
    detection::{DetectorFigures, DetectorRates},
};
use wayword_core::{Platform, SceneId, View, seeded_rng};
use wayword_language::lexicon::{find_thing, names_agree, normalise_name};
use wayword_run::{
    error::CommandError, lookout::DetectorLookout, output::CommandOutput, plan::RunPlan, platforms::RememberingPlatform,
};
use wayword_synthesis::{detection::usual_nouns, observe::frame_gazes};

/// The figures of a detector, with their basis.
#[derive(Debug, Clone, Serialize)]
pub struct DetectorMeasurement {
    /// Views that it looked at.
    pub views: usize,
    /// The meaning of its scores.
    pub scores: String,
    /// Its recall and false alarms.
    #[serde(flatten)]
    pub figures: DetectorFigures,
}

/// A path's pictures, and the things in them according to the labels.
struct LabelledPath {
    scene: SceneId,
    id: String,
    views: Vec<Vec<View>>,
    frames: Vec<FrameEvidence>,
}

/// Lets the detector look at the views along the paths of a plan until `most_views` are reached. In the views of each
/// path it looks for the things that labels list, and for as many others, chosen at random among the usual nouns.
///
/// # Errors
/// When a view cannot be had, the detector fails, or no view has both a picture and labels.
pub fn measure_detector(
    plan: &RunPlan<'_>,
    most_views: usize,
    lookout: &DetectorLookout,
    output: &CommandOutput,
) -> Result<DetectorMeasurement, CommandError> {
    let seeker = lookout.to_seeker();
    let mut figures = DetectorFigures {
        detector: lookout.name().to_owned(),
        platforms: vec![plan.job.settings.platform.clone()],
        found_from: seeker.figures.found_from,
        ..DetectorFigures::default()
    };
    let nouns = usual_nouns(plan.styles.iter().map(|measured| &measured.style));
    let bar = output.progress_bar(most_views, "views");
    let mut views = 0;
    for item in &plan.items {
        if views >= most_views {
            break;
        }
        let world = RememberingPlatform::new(plan.platform);
        let Some(path) = item_path(item, &plan.job.settings, &world)? else { continue };
        let Some(labelled) = look_along_path(plan, &world, &path)? else { continue };
        let listed = landmark_names(&labelled);
        let names = names_to_look_for(&listed, &nouns, &labelled, plan.job.settings.seed);
        count_finds(&mut figures, &labelled, &names, lookout)?;
        let looked_at = labelled.views.iter().map(Vec::len).sum::<usize>();
        views += looked_at;
        bar.inc(looked_at as u64);
    }
    bar.finish_and_clear();
    if views == 0 {
        return Err(CommandError::usage(
            "--detector: no view has both a picture and labels to hold the detector against",
            "give a platform or data folder with pictures and labels, as in --platform house",
        ));
    }
    figures.drop_rare_names();
    Ok(DetectorMeasurement { views, scores: seeker.detector.scoring().means.to_owned(), figures })
}

/// Looks along a path, at the frames that have pictures; `None` if there are none, or their labels are incomplete.
fn look_along_path(
    plan: &RunPlan<'_>,
    world: &dyn Platform,
    path: &wayword_core::Path,
) -> Result<Option<LabelledPath>, CommandError> {
    let mut path = path.clone();
    let mut views = Vec::new();
    let mut frames = Vec::new();
    for frame in std::mem::take(&mut path.frames) {
        let seen: Vec<View> = frame_gazes(&frame, plan.job.settings.frames)
            .into_iter()
            .map(|gaze| world.look_from(&path.scene, &frame, gaze))
            .collect::<Result<_, _>>()?;
        if seen.iter().all(|view| view.image.is_some()) {
            views.push(seen);
            frames.push(frame);
        }
    }
    path.frames = frames;
    let evidence = Evidence::from_labels(&path, &views).filter(|evidence| evidence.frames_without_things().is_empty());
    let known = evidence.filter(|evidence| !evidence.frames.is_empty());
    Ok(known.map(|known| LabelledPath { scene: path.scene, id: path.id, views, frames: known.frames }))
}

/// The names in the labels of a path, restricted to things that people use as landmarks.
fn landmark_names(labelled: &LabelledPath) -> BTreeSet<String> {
    let things = labelled.frames.iter().flat_map(|frame| &frame.things);
    things.map(|seen| normalise_name(&seen.name)).filter(|name| is_landmark(name)).collect()
}

fn is_landmark(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| thing.salience >= 1)
}

/// The names of the things that the labels list, and as many names of things that they do not list.
fn names_to_look_for(listed: &BTreeSet<String>, nouns: &[String], labelled: &LabelledPath, seed: u64) -> Vec<String> {
    let is_listed = |noun: &&String| listed.iter().any(|name| names_agree(name, noun));
    let mut absent: Vec<&String> = nouns.iter().filter(|noun| !is_listed(noun)).collect();
    absent.shuffle(&mut seeded_rng(seed, &["detector", labelled.scene.as_str(), &labelled.id]));
    listed.iter().chain(absent.into_iter().take(listed.len())).cloned().collect()
}

/// Lets the detector look for the names in all views of a path. Counts for each name in how many frames it is labelled, and in how
/// many it is found.
fn count_finds(
    figures: &mut DetectorFigures,
    labelled: &LabelledPath,
    names: &[String],
    lookout: &DetectorLookout,
) -> Result<(), CommandError> {
    let seeker = lookout.to_seeker();
    let views: Vec<&View> = labelled.views.iter().flatten().collect();
    let phrases: Vec<&str> = names.iter().map(String::as_str).collect();
    let detections = seeker.detector.detect_phrases(&views, &phrases).into_iter().collect::<Result<Vec<_>, _>>()?;
    for (at, name) in names.iter().enumerate() {
        let mut in_view_order = detections.iter();
        let frames: Vec<(bool, bool)> = labelled
            .frames
            .iter()
            .zip(&labelled.views)
            .map(|(frame, views)| {
                let frame_detections = in_view_order.by_ref().take(views.len());
                let hits = frame_detections.filter(|by_phrase| {
                    by_phrase.get(at).is_some_and(|boxes| boxes.iter().any(|found| found.score >= figures.found_from))
                });
                let is_found = hits.count() > 0;
                (frame.things.iter().any(|thing| names_agree(&thing.name, name)), is_found)
            })
            .collect();
        figures.count_name(name, &frames);
    }
    Ok(())
}

impl fmt::Display for DetectorMeasurement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { views, scores, figures } = self;
        writeln!(f, "{} on {views} views; {scores}; a find from {:.2}", figures.detector, figures.found_from)?;
        writeln!(f, "name              shown    found   absent   alarms  missed always")?;
        let mut line = |name: &str, rates: &DetectorRates| {
            let DetectorRates { shown, absent, .. } = rates;
            let (found, alarms) = (100.0 * rates.recall(), 100.0 * rates.alarm());
            let blind = 100.0 * rates.blind_share();
            writeln!(f, "{name:<16} {shown:>6} {found:>7.1}% {absent:>8} {alarms:>7.1}% {blind:>13.1}%")
        };
        line("all", &figures.all)?;
        figures.names.iter().try_for_each(|(name, rates)| line(name, rates))?;
        write!(
            f,
            "shown: frames whose labels list it; absent: frames whose labels do not. Labels can leave things out, so some alarms\n\
             may be there. missed always: the share of things that it misses from every frame."
        )
    }
}
