//! One item from path to checked instructions.

use crate::{
    error::Error,
    item::Item,
    pictures::{self, Picture},
    settings::{Settings, TargetMode},
    styles::Measured,
    world::Remembering,
};
use wayword_core::{Frame, Gaze, Path, Platform, PlatformError, View};
use wayword_synthesis::{
    dialogue::{RulesAsker, RulesSummariser},
    evidence::Evidence,
    minds::{Labels, distinguish},
    observe::{Minds, observe},
    repair::{Order, Outcome, write_and_repair},
    walk::Walk,
    writer::RulesWriter,
};

/// What became of an item.
#[derive(Debug)]
pub struct Made {
    /// The path and what was seen along it.
    pub walk: Walk,
    /// One per style, in the order of the run's styles.
    pub outcomes: Vec<Outcome>,
    /// What is seen ahead from each frame, where the platform has pictures.
    pub pictures: Vec<Picture>,
}

/// The embedded default: rules ask, labels answer, rules sum up.
#[must_use]
pub fn offline_minds(settings: &Settings) -> Minds<'static> {
    Minds {
        asker: &RulesAsker,
        answerer: &Labels,
        summariser: &RulesSummariser,
        mode: settings.mode(),
        prompts_hash: None,
    }
}

/// Makes an item's instructions.
///
/// # Errors
/// When its path does not fit the world, or nothing can be seen along it.
pub fn make(item: &Item, settings: &Settings, platform: &dyn Platform, styles: &[Measured]) -> Result<Made, Error> {
    let world = Remembering::new(platform);
    let mut path = item.path(settings, &world)?;
    if settings.target == TargetMode::Free {
        path.target = None;
    }
    let panoramas = panoramas(&world, &path)?;
    if let (Some(target), Some(last), Some(views)) = (&mut path.target, path.frames.last(), panoramas.last()) {
        distinguish(target, last, views);
    }
    let minds = offline_minds(settings);
    let observations = observe(&world, &path, settings.frames, minds)?;
    let walk = Walk::new(path, observations);
    let evidence = evidence(&walk, &panoramas);
    let outcomes = styles.iter().map(|Measured { style, profile }| {
        let order =
            Order { walk: &walk, evidence: &evidence, style, profile, seed: settings.seed, repairs: settings.repairs };
        write_and_repair(&RulesWriter, minds, order)
    });
    let outcomes = outcomes.collect();
    let pictures = pictures::encode(&panoramas)?;
    Ok(Made { walk, outcomes, pictures })
}

/// What is all around each frame: ahead, right, behind, left.
///
/// # Errors
/// When a view cannot be had.
pub fn panoramas(platform: &dyn Platform, path: &Path) -> Result<Vec<Vec<View>>, PlatformError> {
    let around = |frame: &Frame| {
        Gaze::around(frame.pose.heading).map(|gaze| platform.look(&path.scene, frame, gaze)).into_iter().collect()
    };
    path.frames.iter().map(around).collect()
}

/// The best evidence there is: labels, else captions, else the path alone.
#[must_use]
pub fn evidence(walk: &Walk, panoramas: &[Vec<View>]) -> Evidence {
    let labels = Evidence::from_labels(&walk.path, panoramas);
    labels.or_else(|| walk.evidence()).unwrap_or_else(|| Evidence::of_path_alone(&walk.path))
}
