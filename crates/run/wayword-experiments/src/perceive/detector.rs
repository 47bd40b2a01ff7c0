//! Measures a detector against labels: its recall of the things that labels list, and its false alarms for things that they do
//! not list.

use super::views::path;
use rand::seq::SliceRandom;
use serde::Serialize;
use std::{collections::BTreeSet, fmt};
use wayword_checks::{
    Evidence, FrameEvidence,
    detected::{DetectorFigures, Rates},
};
use wayword_core::{Platform, SceneId, View, rng};
use wayword_language::lexicon::{agree, normal, thing};
use wayword_run::{error::Error, looking_for::Lookout, output::Output, plan::Plan, platforms::Remembering};
use wayword_synthesis::{detection::usual, observe::gazes};

/// The figures of a detector, with their basis.
#[derive(Debug, Clone, Serialize)]
pub struct OfDetector {
    /// Views that it looked at.
    pub views: usize,
    /// The meaning of its scores.
    pub scores: String,
    /// Its recall and false alarms.
    #[serde(flatten)]
    pub figures: DetectorFigures,
}

/// A path's pictures, and the things in them according to the labels.
struct Known {
    scene: SceneId,
    id: String,
    views: Vec<Vec<View>>,
    frames: Vec<FrameEvidence>,
}

/// Lets the detector look at the views along the paths of a plan until `most_views` are reached. In those of each path it looks
/// for the things that labels list, and for as many others, chosen at random among the usual nouns.
///
/// # Errors
/// When a view cannot be had, the detector fails, or no view has both a picture and labels.
pub fn measure(plan: &Plan<'_>, most_views: usize, lookout: &Lookout, output: &Output) -> Result<OfDetector, Error> {
    let seeker = lookout.seeker();
    let mut figures = DetectorFigures {
        detector: lookout.name().to_owned(),
        platforms: vec![plan.job.settings.platform.clone()],
        found_from: seeker.figures.found_from,
        ..DetectorFigures::default()
    };
    let nouns = usual(plan.styles.iter().map(|measured| &measured.style));
    let bar = output.progress(most_views, "views");
    let mut views = 0;
    for item in &plan.items {
        if views >= most_views {
            break;
        }
        let world = Remembering::new(plan.platform);
        let Some(path) = path(item, &plan.job.settings, &world)? else { continue };
        let Some(known) = known(plan, &world, &path)? else { continue };
        let there = names(&known);
        let names = looked_for(&there, &nouns, &known, plan.job.settings.seed);
        count(&mut figures, &known, &names, lookout)?;
        let looked_at = known.views.iter().map(Vec::len).sum::<usize>();
        views += looked_at;
        bar.inc(looked_at as u64);
    }
    bar.finish_and_clear();
    if views == 0 {
        return Err(Error::usage(
            "--detector: no view has both a picture and labels to hold the detector against",
            "give a platform or data folder with pictures and labels, as in --platform house",
        ));
    }
    figures.settle();
    Ok(OfDetector { views, scores: seeker.detector.scoring().means.to_owned(), figures })
}

/// Looks along a path, at the frames that have pictures; `None` if there are none, or their labels are incomplete.
fn known(plan: &Plan<'_>, world: &dyn Platform, path: &wayword_core::Path) -> Result<Option<Known>, Error> {
    let mut path = path.clone();
    let mut views = Vec::new();
    let mut frames = Vec::new();
    for frame in std::mem::take(&mut path.frames) {
        let seen: Vec<View> = gazes(&frame, plan.job.settings.frames)
            .into_iter()
            .map(|gaze| world.look(&path.scene, &frame, gaze))
            .collect::<Result<_, _>>()?;
        if seen.iter().all(|view| view.image.is_some()) {
            views.push(seen);
            frames.push(frame);
        }
    }
    path.frames = frames;
    let evidence = Evidence::from_labels(&path, &views).filter(|evidence| evidence.frames_without_things().is_empty());
    let known = evidence.filter(|evidence| !evidence.frames.is_empty());
    Ok(known.map(|known| Known { scene: path.scene, id: path.id, views, frames: known.frames }))
}

/// The names in the labels of a path, restricted to things that people use as landmarks.
fn names(known: &Known) -> BTreeSet<String> {
    let things = known.frames.iter().flat_map(|frame| &frame.things);
    things.map(|seen| normal(&seen.name)).filter(|name| is_landmark(name)).collect()
}

fn is_landmark(name: &str) -> bool {
    thing(name).is_some_and(|thing| thing.salience >= 1)
}

/// The names of the things that are there, and as many names of things that are not.
fn looked_for(there: &BTreeSet<String>, nouns: &[String], known: &Known, seed: u64) -> Vec<String> {
    let is_there = |noun: &&String| there.iter().any(|name| agree(name, noun));
    let mut absent: Vec<&String> = nouns.iter().filter(|noun| !is_there(noun)).collect();
    absent.shuffle(&mut rng(seed, &["detector", known.scene.as_str(), &known.id]));
    there.iter().chain(absent.into_iter().take(there.len())).cloned().collect()
}

fn count(figures: &mut DetectorFigures, known: &Known, names: &[String], lookout: &Lookout) -> Result<(), Error> {
    let seeker = lookout.seeker();
    let views: Vec<&View> = known.views.iter().flatten().collect();
    let phrases: Vec<&str> = names.iter().map(String::as_str).collect();
    let found = seeker.detector.detect(&views, &phrases).into_iter().collect::<Result<Vec<_>, _>>()?;
    for (at, name) in names.iter().enumerate() {
        let mut boxes = found.iter();
        let frames: Vec<(bool, bool)> = known
            .frames
            .iter()
            .zip(&known.views)
            .map(|(frame, views)| {
                let of_frame = boxes.by_ref().take(views.len());
                let hits = of_frame.filter(|found| {
                    found.get(at).is_some_and(|found| found.iter().any(|found| found.score >= figures.found_from))
                });
                let is_found = hits.count() > 0;
                (frame.things.iter().any(|thing| agree(&thing.name, name)), is_found)
            })
            .collect();
        figures.count(name, &frames);
    }
    Ok(())
}

impl fmt::Display for OfDetector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { views, scores, figures } = self;
        writeln!(f, "{} on {views} views; {scores}; a find from {:.2}", figures.detector, figures.found_from)?;
        writeln!(f, "name              shown    found   absent   alarms  missed always")?;
        let mut line = |name: &str, rates: &Rates| {
            let Rates { shown, absent, .. } = rates;
            let (found, alarms) = (100.0 * rates.recall(), 100.0 * rates.alarm());
            let blind = 100.0 * rates.blind();
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
