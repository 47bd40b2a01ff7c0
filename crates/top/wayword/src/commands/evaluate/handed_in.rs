//! What was handed in, held against the episodes: all of it is scored, or all that is wrong is told.

use super::refusal::Problem;
use crate::{demands::Demands, episodes, error::Error};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use wayword_formats::{
    Episode,
    submission::{Submitted, instr_id},
};
use wayword_metrics::{Score, Trajectory, score};

/// The figures of one instruction's trajectory.
#[derive(Debug, Serialize)]
pub(super) struct Scored<'e> {
    pub(super) instr_id: String,
    /// The item that the instruction belongs to.
    pub(super) item: &'e str,
    /// The path that the item lies on, by its scene.
    pub(super) path: String,
    /// Whether an object was named.
    #[serde(skip)]
    pub(super) names_object: bool,
    #[serde(flatten)]
    pub(super) score: Score,
}

/// Scores every instruction, in the order of the episodes. Where anything is wrong: all problems, in that order too.
///
/// # Errors
/// When a scene cannot be read.
pub(super) fn score_all<'e>(
    episodes: &'e [Episode],
    submitted: Vec<Submitted>,
    demands: &Demands<'_>,
) -> Result<Result<Vec<Scored<'e>>, Vec<Problem>>, Error> {
    let mut problems = unknown(episodes, &submitted);
    let mut by_id: BTreeMap<String, Submitted> =
        submitted.into_iter().map(|submitted| (submitted.instr_id.clone(), submitted)).collect();
    let mut all = Vec::new();
    for episode in episodes {
        let (distances, demand) = demands.of(episode)?;
        for place in places(episode) {
            let instr_id = instr_id(episode, place);
            let Some(submitted) = by_id.remove(&instr_id) else {
                problems.push(Problem::new(instr_id, "it is missing: every instruction needs a trajectory"));
                continue;
            };
            let viewpoints = submitted.trajectory.into_iter().map(|posed| posed.viewpoint).collect();
            let trajectory = Trajectory { viewpoints, object: submitted.object };
            match score(&distances, &demand, &trajectory) {
                Ok(score) => all.push(Scored {
                    instr_id,
                    item: &episode.id,
                    path: episodes::cluster(episode),
                    names_object: trajectory.object.is_some(),
                    score,
                }),
                Err(wrong) => {
                    problems.extend(wrong.iter().map(|wrong| Problem::new(instr_id.clone(), wrong.to_string())));
                }
            }
        }
    }
    Ok(if problems.is_empty() { Ok(all) } else { Err(problems) })
}

/// Trajectories for instructions that the episodes don't have, in the order of the submission.
fn unknown(episodes: &[Episode], submitted: &[Submitted]) -> Vec<Problem> {
    let ids_of = |episode| places(episode).map(move |place| instr_id(episode, place));
    let known: BTreeSet<String> = episodes.iter().flat_map(ids_of).collect();
    let is_unknown = |submitted: &&Submitted| !known.contains(&submitted.instr_id);
    let told = |submitted: &Submitted| {
        Problem::new(submitted.instr_id.clone(), "the episodes have no such instruction: check the split, and the ids")
    };
    submitted.iter().filter(is_unknown).map(told).collect()
}

/// The places of an item's instructions.
fn places(episode: &Episode) -> std::ops::Range<usize> {
    0..episode.instructions.len()
}
