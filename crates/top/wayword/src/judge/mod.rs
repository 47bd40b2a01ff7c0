//! Scores trajectories of known episodes: all of them, or it lists every problem.
//!
//! What no trajectory changes is computed once, so that a program that trains an agent can score after every epoch.

mod problems;
mod scores;

pub use problems::{Problem, Problems};
pub use scores::{LEVEL, Scored, Scores};

use crate::{demands::Demands, episodes, error::Error};
use scores::Instruction;
use std::{
    collections::{BTreeSet, HashMap},
    sync::Arc,
};
use wayword_core::{ObjectId, Platform};
use wayword_formats::{
    Episode,
    submission::{Reading, instr_id},
};
use wayword_metrics::{Course, Distances, Invalid, Score};

/// The episodes that trajectories are scored by.
pub struct Judge {
    /// In the order of the episodes.
    items: Vec<Item>,
    instructions: Arc<[Instruction]>,
    /// The places of the instructions in that list, by their names.
    places: HashMap<String, usize>,
}

/// An episode.
struct Item {
    distances: Arc<Distances>,
    /// An error if its path is not one of the scene's graph.
    course: Result<Course, Vec<Invalid>>,
}

impl Judge {
    /// Knows the instructions of episodes whose paths name viewpoints.
    ///
    /// # Errors
    /// When a scene cannot be read.
    pub fn new(episodes: &[Episode], platform: &dyn Platform) -> Result<Self, Error> {
        let demands = Demands::new(platform);
        let mut items = Vec::with_capacity(episodes.len());
        let mut instructions = Vec::new();
        for (at, episode) in episodes.iter().enumerate() {
            let (distances, demand) = demands.of(episode)?;
            items.push(Item { course: Course::new(&distances, &demand), distances });
            instructions.extend((0..episode.instructions.len()).map(|place| Instruction {
                name: instr_id(episode, place),
                item: at,
                item_id: episode.id.clone(),
                path: episodes::cluster(episode),
            }));
        }
        let places = instructions.iter().enumerate().map(|(at, known)| (known.name.clone(), at)).collect();
        Ok(Self { items, instructions: instructions.into(), places })
    }

    /// How many instructions there are.
    #[must_use]
    pub fn instructions(&self) -> usize {
        self.instructions.len()
    }

    /// How many items there are.
    #[must_use]
    pub fn items(&self) -> usize {
        self.items.len()
    }

    /// Begins a submission.
    #[must_use]
    pub fn begin(&self) -> Scoring<'_> {
        Scoring {
            judge: self,
            seen: vec![false; self.instructions.len()],
            next: 0,
            rows: Vec::with_capacity(self.instructions.len()),
            unknown: Problems::default(),
            wrong: Vec::new(),
        }
    }

    /// The place of an instruction, which may be `likely`.
    fn find(&self, instruction: &str, likely: usize) -> Option<usize> {
        let is_it = self.instructions.get(likely).is_some_and(|known| known.name == instruction);
        if is_it { Some(likely) } else { self.places.get(instruction).copied() }
    }

    /// Scores what a file of trajectories has. Those for the instructions `beyond` are left out; returns how many these are.
    ///
    /// # Errors
    /// All problems: those of the file first.
    pub fn score_all(
        &self,
        reading: &Reading,
        beyond: &BTreeSet<String>,
        is_partial: bool,
    ) -> Result<(Scores, usize), Problems> {
        let mut scoring = self.begin();
        let mut left_out = 0;
        for submitted in &reading.submitted {
            if beyond.contains(&submitted.instr_id) {
                left_out += 1;
                continue;
            }
            let viewpoints = submitted.trajectory.iter().map(|posed| posed.viewpoint.as_str());
            scoring.take(&submitted.instr_id, viewpoints, submitted.object.as_ref().map(ObjectId::as_str));
        }
        for flawed in reading.flawed.iter().filter(|flawed| !beyond.contains(*flawed)) {
            scoring.take_flawed(flawed);
        }
        // After the place where the file broke off a trajectory may be there all the same.
        let scores = scoring.end(Problems::of_file(&reading.problems), is_partial || !reading.is_whole)?;
        Ok((scores, left_out))
    }

    fn score<'n>(
        &self,
        instruction: usize,
        viewpoints: impl Iterator<Item = &'n str> + Clone,
        object: Option<&str>,
    ) -> Result<Score, Vec<Invalid>> {
        let Item { distances, course } = &self.items[self.instructions[instruction].item];
        course.as_ref().map_err(Clone::clone)?.score(distances, viewpoints, object)
    }
}

/// A submission, trajectory by trajectory.
pub struct Scoring<'j> {
    judge: &'j Judge,
    /// The instructions that were handed in, scored or not.
    seen: Vec<bool>,
    /// The place after that of the last one: submissions are mostly in the order of the episodes.
    next: usize,
    rows: Vec<Scored>,
    unknown: Problems,
    /// The instructions whose trajectory is wrong, and why.
    wrong: Vec<(usize, Problem)>,
}

impl Scoring<'_> {
    /// Takes the trajectory of an instruction: its viewpoints, and the object that the agent names.
    pub fn take<'n>(
        &mut self,
        instruction: &str,
        viewpoints: impl Iterator<Item = &'n str> + Clone,
        object: Option<&str>,
    ) {
        let Some(place) = self.place(instruction) else { return };
        match self.judge.score(place, viewpoints, object) {
            Ok(score) => self.rows.push(Scored { instruction: place, names_object: object.is_some(), score }),
            Err(all) => {
                for wrong in all {
                    self.mark(place, wrong.to_string());
                }
            }
        }
    }

    /// Takes an instruction whose trajectory cannot be read: it is not missing. What is wrong is told elsewhere.
    pub fn take_flawed(&mut self, instruction: &str) {
        self.place(instruction);
    }

    /// The place of an instruction that is handed in for the first time; a problem elsewhere.
    fn place(&mut self, instruction: &str) -> Option<usize> {
        let Some(place) = self.judge.find(instruction, self.next) else {
            let problem = "the episodes have no such instruction: check the split, and the ids";
            self.unknown.add(|| Problem::new(instruction.to_owned(), problem));
            return None;
        };
        self.next = place + 1;
        if std::mem::replace(&mut self.seen[place], true) {
            self.mark(place, "the submission has another trajectory for this instruction: give one".to_owned());
            return None;
        }
        Some(place)
    }

    fn mark(&mut self, place: usize, problem: String) {
        if self.wrong.len() < problems::KEPT {
            self.wrong.push((place, Problem::new(self.judge.instructions[place].name.clone(), problem)));
        } else {
            self.unknown.leave_out();
        }
    }

    /// The figures in the order of the episodes, or all problems: those `before`, the instructions that are not known, and then
    /// the others in the order of the episodes. An instruction without a trajectory is a problem unless `is_partial`.
    ///
    /// # Errors
    /// The problems.
    pub fn end(mut self, before: Problems, is_partial: bool) -> Result<Scores, Problems> {
        let mut problems = before.and(self.unknown);
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
        Ok(Scores { instructions: Arc::clone(&self.judge.instructions), rows: self.rows })
    }
}
