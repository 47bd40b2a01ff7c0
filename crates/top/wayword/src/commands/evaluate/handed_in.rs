//! Compares a submission with the episodes: all of it is scored, or all its problems are listed.

use super::refusal::{Problem, Problems};
use crate::{demands::Demands, episodes, error::Error};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use wayword_formats::{
    Episode,
    submission::{Reading, Submitted, instr_id},
};
use wayword_metrics::{Score, Trajectory, score};

/// The figures of one instruction's trajectory.
#[derive(Debug, Serialize)]
pub(super) struct Scored<'e> {
    pub(super) instr_id: String,
    /// The item that the instruction belongs to.
    pub(super) item: &'e str,
    /// Scene and path of the item: figures are clustered by it.
    pub(super) path: String,
    /// Whether an object was named.
    #[serde(skip)]
    pub(super) names_object: bool,
    #[serde(flatten)]
    pub(super) score: Score,
}

/// The scored part of a submission.
#[derive(Debug)]
pub(super) struct All<'e> {
    /// In the order of the episodes.
    pub(super) scored: Vec<Scored<'e>>,
    /// Trajectories for items beyond the limit.
    pub(super) left_out: usize,
    /// All instructions, with or without a trajectory.
    pub(super) instructions: usize,
    /// All items.
    pub(super) items: usize,
}

/// Scores every instruction of `episodes`, or if `is_partial` only those that have a trajectory. Trajectories for the
/// items `beyond` these are left out. If anything is wrong, gives all problems: those of the file, then the others in
/// the order of the episodes.
///
/// # Errors
/// When a scene cannot be read.
pub(super) fn score_all<'e>(
    episodes: &'e [Episode],
    beyond: &[Episode],
    reading: Reading,
    demands: &Demands<'_>,
    is_partial: bool,
) -> Result<Result<All<'e>, Problems>, Error> {
    let mut problems = Problems::of_file(&reading.problems);
    unknown(episodes, beyond, &reading, &mut problems);
    let Reading { submitted, flawed, is_whole, .. } = reading;
    let flawed: BTreeSet<String> = flawed.into_iter().collect();
    let mut by_id: BTreeMap<String, Submitted> =
        submitted.into_iter().map(|submitted| (submitted.instr_id.clone(), submitted)).collect();
    let mut scored = Vec::new();
    let instructions = episodes.iter().map(|episode| episode.instructions.len()).sum();
    for episode in episodes {
        let (distances, demand) = demands.of(episode)?;
        for instr_id in names(episode) {
            let Some(submitted) = by_id.remove(&instr_id) else {
                // A flawed trajectory is not missing, and after the place where the file broke off it may not be
                // either.
                if is_whole && !is_partial && !flawed.contains(&instr_id) {
                    problems.add_missing(instr_id);
                }
                continue;
            };
            let viewpoints = submitted.trajectory.into_iter().map(|posed| posed.viewpoint).collect();
            let trajectory = Trajectory { viewpoints, object: submitted.object };
            match score(&distances, &demand, &trajectory) {
                Ok(score) => scored.push(Scored {
                    instr_id,
                    item: &episode.id,
                    path: episodes::cluster(episode),
                    names_object: trajectory.object.is_some(),
                    score,
                }),
                Err(wrong) => {
                    for wrong in wrong {
                        problems.add(|| Problem::new(instr_id.clone(), wrong.to_string()));
                    }
                }
            }
        }
    }
    // What is left over are trajectories for the items beyond the limit.
    let all = All { scored, left_out: by_id.len(), instructions, items: episodes.len() };
    Ok(if problems.count() == 0 { Ok(all) } else { Err(problems) })
}

/// Trajectories for instructions that the file of episodes doesn't have, in the order of the submission.
fn unknown(episodes: &[Episode], beyond: &[Episode], reading: &Reading, problems: &mut Problems) {
    let known: BTreeSet<String> = episodes.iter().chain(beyond).flat_map(names).collect();
    let handed_in = reading.submitted.iter().map(|submitted| &submitted.instr_id).chain(&reading.flawed);
    for instr_id in handed_in.filter(|instr_id| !known.contains(*instr_id)) {
        let problem = "the episodes have no such instruction: check the split, and the ids";
        problems.add(|| Problem::new(instr_id.clone(), problem));
    }
}

/// The names of an item's instructions.
fn names(episode: &Episode) -> impl Iterator<Item = String> {
    (0..episode.instructions.len()).map(move |place| instr_id(episode, place))
}
