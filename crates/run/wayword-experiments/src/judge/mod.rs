//! Scores the trajectories of a submission. If anything is wrong with it, there is no score, but a list of all problems.
//!
//! Distances and reference paths are prepared once and used for every submission, so that a program that trains an agent can
//! score after every epoch.

mod problems;
mod scores;

pub use problems::{TrajectoryProblem, TrajectoryProblems};
pub use scores::{CONFIDENCE_LEVEL, ScoredTrajectory, SubmissionScores};

use crate::{demands::PlatformDemands, episodes};
use scores::JudgedInstruction;
use std::{
    collections::{BTreeSet, HashMap},
    sync::Arc,
};
use wayword_core::{ObjectId, Platform};
use wayword_formats::{
    Episode,
    submission::{SubmissionReading, instr_id},
};
use wayword_metrics::{EpisodeScorer, SceneDistances, TrajectoryError, TrajectoryScore};
use wayword_run::error::CommandError;

/// The episodes by which trajectories are scored, prepared for many submissions.
pub struct TrajectoryJudge {
    /// In the order of the episodes.
    items: Vec<JudgedEpisode>,
    instructions: Arc<[JudgedInstruction]>,
    /// The indices of the instructions in that list, by their names.
    places: HashMap<String, usize>,
}

/// An episode, prepared for scoring.
struct JudgedEpisode {
    distances: Arc<SceneDistances>,
    /// The reference path; an error if it leaves the scene's graph.
    course: Result<EpisodeScorer, Vec<TrajectoryError>>,
}

impl TrajectoryJudge {
    /// Prepares the instructions of episodes that name viewpoints.
    ///
    /// # Errors
    /// When a scene cannot be read.
    pub fn new(episodes: &[Episode], platform: &dyn Platform) -> Result<Self, CommandError> {
        let demands = PlatformDemands::new(platform);
        let mut items = Vec::with_capacity(episodes.len());
        let mut instructions = Vec::new();
        for (at, episode) in episodes.iter().enumerate() {
            let (distances, demand) = demands.for_episode(episode)?;
            items.push(JudgedEpisode { course: EpisodeScorer::new(&distances, &demand), distances });
            instructions.extend((0..episode.instructions.len()).map(|place| JudgedInstruction {
                name: instr_id(episode, place),
                item: at,
                item_id: episode.id.clone(),
                path: episodes::episode_path_name(episode),
            }));
        }
        let places = instructions.iter().enumerate().map(|(at, known)| (known.name.clone(), at)).collect();
        Ok(Self { items, instructions: instructions.into(), places })
    }

    /// How many instructions there are.
    #[must_use]
    pub fn instruction_count(&self) -> usize {
        self.instructions.len()
    }

    /// How many items there are.
    #[must_use]
    pub fn item_count(&self) -> usize {
        self.items.len()
    }

    /// Begins to score a submission.
    #[must_use]
    pub fn begin_submission(&self) -> SubmissionScoring<'_> {
        SubmissionScoring {
            judge: self,
            seen: vec![false; self.instructions.len()],
            next: 0,
            rows: Vec::with_capacity(self.instructions.len()),
            unknown: TrajectoryProblems::default(),
            wrong: Vec::new(),
        }
    }

    /// The index of an instruction. It looks at the index `likely` first.
    fn find_place(&self, instruction: &str, likely: usize) -> Option<usize> {
        let is_right = self.instructions.get(likely).is_some_and(|known| known.name == instruction);
        if is_right { Some(likely) } else { self.places.get(instruction).copied() }
    }

    /// Scores a file of trajectories. Those for the instructions in `ignored` are left out; returns their number too.
    ///
    /// # Errors
    /// All problems: those of the file first.
    pub fn score_all(
        &self,
        reading: &SubmissionReading,
        ignored: &BTreeSet<String>,
        is_partial: bool,
    ) -> Result<(SubmissionScores, usize), TrajectoryProblems> {
        let mut scoring = self.begin_submission();
        let mut left_out = 0;
        for submitted in &reading.submitted {
            if ignored.contains(&submitted.instr_id) {
                left_out += 1;
                continue;
            }
            let viewpoints = submitted.trajectory.iter().map(|posed| posed.viewpoint.as_str());
            scoring.take_trajectory(&submitted.instr_id, viewpoints, submitted.object.as_ref().map(ObjectId::as_str));
        }
        for flawed in reading.flawed.iter().filter(|flawed| !ignored.contains(*flawed)) {
            scoring.take_flawed(flawed);
        }
        // If the file breaks off, the lost part may have contained the trajectories that are missing.
        let scores = scoring
            .finish_submission(TrajectoryProblems::from_file(&reading.problems), is_partial || !reading.is_whole)?;
        Ok((scores, left_out))
    }

    fn score_trajectory<'n>(
        &self,
        instruction: usize,
        viewpoints: impl Iterator<Item = &'n str> + Clone,
        object: Option<&str>,
    ) -> Result<TrajectoryScore, Vec<TrajectoryError>> {
        let JudgedEpisode { distances, course } = &self.items[self.instructions[instruction].item];
        course.as_ref().map_err(Clone::clone)?.score_trajectory(distances, viewpoints, object)
    }
}

/// Scores a submission, trajectory by trajectory.
pub struct SubmissionScoring<'j> {
    judge: &'j TrajectoryJudge,
    /// Whether the submission has a trajectory for each instruction, good or bad.
    seen: Vec<bool>,
    /// The index after that of the last trajectory. Most submissions are in the order of the episodes, so it is tried first.
    next: usize,
    rows: Vec<ScoredTrajectory>,
    /// The problems of unknown instructions, and the number of all problems beyond the limit.
    unknown: TrajectoryProblems,
    /// The instructions whose trajectory is wrong, and why.
    wrong: Vec<(usize, TrajectoryProblem)>,
}

impl SubmissionScoring<'_> {
    /// Takes the trajectory of an instruction: its viewpoints, and the object that the agent names.
    pub fn take_trajectory<'n>(
        &mut self,
        instruction: &str,
        viewpoints: impl Iterator<Item = &'n str> + Clone,
        object: Option<&str>,
    ) {
        let Some(place) = self.claim_place(instruction) else { return };
        match self.judge.score_trajectory(place, viewpoints, object) {
            Ok(score) => self.rows.push(ScoredTrajectory { instruction: place, names_object: object.is_some(), score }),
            Err(errors) => {
                for error in errors {
                    self.add_problem(place, error.to_string());
                }
            }
        }
    }

    /// Notes that an instruction has a trajectory, though it cannot be read. The problem itself comes from the reader of the file.
    pub fn take_flawed(&mut self, instruction: &str) {
        self.claim_place(instruction);
    }

    /// The index of an instruction that gets its first trajectory. Records a problem for an unknown or a repeated instruction.
    fn claim_place(&mut self, instruction: &str) -> Option<usize> {
        let Some(place) = self.judge.find_place(instruction, self.next) else {
            let problem = "the episodes have no such instruction: check the split, and the ids";
            self.unknown.add(|| TrajectoryProblem::new(instruction.to_owned(), problem));
            return None;
        };
        self.next = place + 1;
        if std::mem::replace(&mut self.seen[place], true) {
            self.add_problem(place, "the submission has another trajectory for this instruction: give one".to_owned());
            return None;
        }
        Some(place)
    }

    fn add_problem(&mut self, place: usize, problem: String) {
        if self.wrong.len() < problems::MAX_KEPT_PROBLEMS {
            self.wrong.push((place, TrajectoryProblem::new(self.judge.instructions[place].name.clone(), problem)));
        } else {
            self.unknown.leave_out();
        }
    }

    /// Ends the submission. Returns the figures in the order of the episodes, or all problems: first those in `before`, then
    /// unknown instructions, then the others in the order of the episodes. An instruction without a trajectory is a problem
    /// unless `is_partial`.
    ///
    /// # Errors
    /// The problems.
    pub fn finish_submission(
        mut self,
        before: TrajectoryProblems,
        is_partial: bool,
    ) -> Result<SubmissionScores, TrajectoryProblems> {
        let mut problems = before.followed_by(self.unknown);
        self.wrong.sort_by_key(|(place, _)| *place);
        let mut wrong = self.wrong.into_iter().peekable();
        for (place, is_seen) in self.seen.iter().enumerate() {
            while let Some((_, problem)) = wrong.next_if(|(at, _)| *at == place) {
                problems.add(|| problem);
            }
            if !is_seen && !is_partial {
                problems.add_missing(self.judge.instructions[place].name.clone());
            }
        }
        if problems.count() > 0 {
            return Err(problems);
        }
        self.rows.sort_by_key(|row| row.instruction);
        Ok(SubmissionScores { instructions: Arc::clone(&self.judge.instructions), rows: self.rows })
    }
}
