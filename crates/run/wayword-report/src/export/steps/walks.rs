//! Collects the walks of a run's records, and divides each into single actions on the ground of its scene.

use super::{super::items, parts::parts, settings::Steps};
use crate::walking::{Scenes, feet};
use std::collections::BTreeMap;
use wayword_core::{Failure, Heading, Path};
use wayword_formats::{
    jsonl::Record,
    trajectories::{Place, Told, Trajectory, as_written},
};
use wayword_habitat::walk::follow;
use wayword_run::{error::Error, run_folder::FailedItem};

/// A walk, and the texts about it.
pub(super) struct Walk<'a> {
    pub(super) path: &'a Path,
    pub(super) split: &'a str,
    /// The records about the walk, each with the name of its episode.
    pub(super) texts: Vec<(String, &'a Record)>,
}

/// The walks of records, scene by scene. A walk occurs once, with all of its texts and their split.
pub(super) fn walks<'a>(records: &'a [Record], splits: &'a [String]) -> Vec<Walk<'a>> {
    let mut walks: Vec<Walk<'a>> = Vec::new();
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    for ((record, split), name) in records.iter().zip(splits).zip(items::episode_names(records)) {
        let path = &record.path;
        let at = *places.entry(path.id.as_str()).or_insert_with(|| {
            walks.push(Walk { path, split, texts: Vec::new() });
            walks.len() - 1
        });
        walks[at].texts.push((name, record));
    }
    // Sorted by scene, so that each scene is prepared only once.
    walks.sort_by(|a, b| a.path.scene.cmp(&b.path.scene));
    walks
}

/// Divides a walk into single actions that follow its path from frame to frame. The result has no pictures yet. If the actions
/// cannot follow the path, the inner result is a failed item.
pub(super) fn trajectory(
    walk: &Walk<'_>,
    scenes: &Scenes,
    steps: &Steps,
    pictures: Place,
) -> Result<Result<Trajectory, FailedItem>, Error> {
    let (path, gait) = (walk.path, steps.gait()?);
    let failed = |failure, reason: String| FailedItem { item: path.id.clone(), failure, reason };
    let ground = match scenes.ground(&path.scene) {
        Ok(ground) => ground,
        Err(error) if error.failure() == Failure::Lost => return Err(error.into()),
        Err(error) => return Ok(Err(failed(error.failure(), error.to_string()))),
    };
    let heading = path.frames.first().map_or(Heading::NORTH, |frame| frame.pose.heading);
    let walked = match follow(&ground, &feet(path), heading, gait, steps.tolerance_m) {
        Ok(walked) => walked,
        Err(astray) => return Ok(Err(failed(Failure::Broken, astray.to_string()))),
    };
    let stances = walked.stances.iter().map(|stance| as_written(stance.foothold.place, stance.heading(gait)));
    let (positions, headings) = stances.unzip();
    let instructions = walk.texts.iter().map(|(episode_id, record)| Told {
        episode_id: episode_id.clone(),
        style: record.instruction.style.clone(),
        text: record.instruction.text.clone(),
        sub_instructions: parts(&record.instruction, &walked.reached),
    });
    Ok(Ok(Trajectory {
        id: path.id.clone(),
        platform: scenes.platform().name().to_owned(),
        scene: path.scene.clone(),
        split: walk.split.to_owned(),
        positions,
        headings,
        off_m: walked.off_m,
        pictures,
        sha256: String::new(),
        instructions: instructions.collect(),
        frame_steps: walked.reached,
        actions: walked.actions,
    }))
}
