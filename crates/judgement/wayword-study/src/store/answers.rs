//! Stores the input of participants. Each input is stored once; if a browser sends it again, nothing changes and it is acknowledged
//! again.

use super::{StudyTransaction, stage::StoredSlot};
use crate::study::{EndAnswer, PairChoice, ParticipantAnswer, ParticipantStatus, StudyError, StudyTask, WindowSize};
use rusqlite::params;

/// Most steps of a walk; a further one is refused. Paths of the known datasets have fewer than 20.
pub(crate) const MAX_MOVES_PER_WALK: usize = 200;
/// Longest text that a participant may write, characters. The form refuses a longer one.
pub(crate) const MAX_OWN_TEXT_CHARS: usize = 1000;
/// Most turns that are stored for a walk. A page that reports more counts as this many.
const MAX_STORED_LOOKS: u32 = 100_000;

/// One input of a participant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ParticipantInput {
    /// The answers to the questions about the task, as indices. `attempt` is the number of wrong tries before this one.
    Understood { attempt: u32, answers: Vec<usize> },
    /// A text that the participant wrote, after seeing `pictures` pictures of the film.
    OwnText { slot: String, text: String, pictures: Option<u32> },
    /// A step to neighbour number `to` of the current place, after `seq` steps.
    Move { slot: String, seq: usize, to: usize },
    /// The end of a walk, after `seq` steps and `looks` turns to look around.
    Stop { slot: String, seq: usize, looks: u32 },
    /// The wish to walk a practice item again from its start.
    WalkAgain { slot: String },
    /// The levels of the statements after a walk, 1 to 5, and the window in which the page was shown.
    Followed { slot: String, statements: [u8; 3], window: Option<WindowSize> },
    /// The levels of the questions about a text, 1 to 5, after seeing `pictures` pictures of the film.
    Rated { slot: String, ratings: [u8; 4], pictures: Option<u32> },
    /// Which text is better, after seeing `pictures` pictures of the film.
    Chosen { slot: String, choice: PairChoice, pictures: Option<u32> },
    /// The level that was chosen at an attention check. `number` counts the checks from 0.
    Attention { number: u32, choice: u8 },
    /// The answers to all questions at the end.
    End { answers: Vec<EndAnswer> },
}

/// Why an input is not stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum InputRefusal {
    /// Its item does not belong to this person, or does not exist.
    Unknown,
    /// It comes before a step that must be done first, or after the end.
    OutOfTurn,
    /// The time ran out, and the item went to others.
    Returned,
    /// The study is over.
    Closed,
}

/// The outer error is the database's. The inner one means that the input was refused.
type InputResult = Result<Result<(), InputRefusal>, StudyError>;

impl StudyTransaction<'_> {
    /// Stores an input of a person, once.
    pub(crate) fn store_input(&self, person: i64, input: ParticipantInput) -> InputResult {
        if self.is_closed()? {
            return Ok(Err(InputRefusal::Closed));
        }
        match input {
            ParticipantInput::Understood { attempt, answers } => self.store_comprehension(person, attempt, &answers),
            ParticipantInput::Attention { number, choice } => self.store_attention(person, number, choice),
            ParticipantInput::End { answers } => self.store_end_answers(person, &answers),
            ParticipantInput::OwnText { slot, text, pictures } => self.with_slot(person, &slot, |held| {
                self.store_viewing(held, pictures)?;
                self.store_own_text(held, &text)
            }),
            ParticipantInput::Move { slot, seq, to } => {
                self.with_slot(person, &slot, |held| self.store_move(held, seq, to))
            }
            ParticipantInput::Stop { slot, seq, looks } => {
                self.with_slot(person, &slot, |held| self.store_stop(held, seq, looks))
            }
            ParticipantInput::Rated { slot, ratings, pictures } => self.with_slot(person, &slot, |held| {
                self.store_viewing(held, pictures)?;
                let is_early = self.study.settings.write_first && held.own_text.is_none();
                self.store_answer(person, held, StudyTask::Rate, is_early, &ParticipantAnswer::Rate { ratings })
            }),
            ParticipantInput::Chosen { slot, choice, pictures } => self.with_slot(person, &slot, |held| {
                self.store_viewing(held, pictures)?;
                self.store_answer(person, held, StudyTask::Pair, false, &ParticipantAnswer::Pair { choice })
            }),
            ParticipantInput::WalkAgain { slot } => self.with_slot(person, &slot, |held| self.restart_practice(held)),
            ParticipantInput::Followed { slot, statements, window } => self.with_slot(person, &slot, |held| {
                let answer = ParticipantAnswer::Follow {
                    statements,
                    looks: held.looks,
                    stopped_ms: held.stopped_ms.unwrap_or(self.now_ms),
                    window,
                };
                self.store_answer(person, held, StudyTask::Follow, held.stopped_ms.is_none(), &answer)
            }),
        }
    }

    /// Runs `work` on an item that the person has. If the item is already answered, it only acknowledges that.
    fn with_slot(&self, person: i64, slot: &str, work: impl FnOnce(&StoredSlot) -> InputResult) -> InputResult {
        let Some(held) = self.slot_by_name(person, slot)? else { return Ok(Err(InputRefusal::Unknown)) };
        match held.state.as_str() {
            "answered" => Ok(Ok(())),
            "live" => work(&held),
            _ => Ok(Err(InputRefusal::Returned)),
        }
    }

    /// Compares the answers about the task with the right ones. The second wrong try ends the participation.
    fn store_comprehension(&self, person: i64, attempt: u32, answers: &[usize]) -> InputResult {
        let find = "SELECT status = 'started' AND NOT understood, misunderstood FROM person WHERE id = ?1";
        let (is_open, wrong_tries): (bool, u32) =
            self.db.query_row(find, [person], |row| Ok((row.get(0)?, row.get(1)?)))?;
        if !is_open || attempt < wrong_tries {
            return Ok(Ok(()));
        }
        if attempt > wrong_tries {
            return Ok(Err(InputRefusal::OutOfTurn));
        }
        let right = self.study.settings.questions.iter().map(|question| question.right);
        if right.eq(answers.iter().copied()) {
            self.db.execute("UPDATE person SET understood = 1 WHERE id = ?1", [person])?;
            return Ok(Ok(()));
        }
        self.db.execute("UPDATE person SET misunderstood = misunderstood + 1 WHERE id = ?1", [person])?;
        if wrong_tries + 1 >= 2 {
            self.end_participation(person, ParticipantStatus::ScreenedOut)?;
        }
        Ok(Ok(()))
    }

    fn store_attention(&self, person: i64, number: u32, choice: u8) -> InputResult {
        let answered: u32 =
            self.db.query_row("SELECT count(*) FROM attention WHERE person = ?1", [person], |row| row.get(0))?;
        if number < answered {
            return Ok(Ok(()));
        }
        let is_due = self.check_due(person, self.answer_progress(person)?)? == Some(number);
        if !is_due || self.find_outcome(person)?.is_some() {
            return Ok(Err(InputRefusal::OutOfTurn));
        }
        let passed = choice == self.asked_level(person, number)?;
        let insert = "INSERT INTO attention (person, number, passed, at_ms) VALUES (?1, ?2, ?3, ?4)";
        self.db.execute(insert, params![person, number, passed, self.now_ms])?;
        self.end_if_done(person)?;
        Ok(Ok(()))
    }

    /// Stores the answers to the questions at the end. The first ones stand.
    fn store_end_answers(&self, person: i64, answers: &[EndAnswer]) -> InputResult {
        let Some(outcome) = self.find_outcome(person)? else { return Ok(Err(InputRefusal::OutOfTurn)) };
        if self.has_end_questions(person, outcome.status)? {
            let Ok(answers) = serde_json::to_string(answers) else { return Ok(Err(InputRefusal::Unknown)) };
            let insert = "INSERT INTO end_answers (person, answers, at_ms) VALUES (?1, ?2, ?3)";
            self.db.execute(insert, params![person, answers, self.now_ms])?;
        }
        Ok(Ok(()))
    }

    /// Stores how many pictures of the film were seen, if the page counted them. A reload begins to count anew, so the largest number stands.
    fn store_viewing(&self, held: &StoredSlot, pictures: Option<u32>) -> Result<(), StudyError> {
        let Some(pictures) = pictures else { return Ok(()) };
        let frames = self.slot_contents(held).map_or(0, |(_, route, _)| route.film.len());
        let pictures = pictures.min(u32::try_from(frames).unwrap_or(u32::MAX));
        let insert = "INSERT INTO viewing (slot, pictures) VALUES (?1, ?2) \
                      ON CONFLICT (slot) DO UPDATE SET pictures = max(pictures, excluded.pictures)";
        self.db.execute(insert, params![held.id, pictures])?;
        Ok(())
    }

    fn store_own_text(&self, held: &StoredSlot, text: &str) -> InputResult {
        if held.own_text.is_none() {
            let text: String = text.chars().take(MAX_OWN_TEXT_CHARS).collect();
            self.db.execute("UPDATE slot SET own_text = ?2 WHERE id = ?1", params![held.id, text])?;
        }
        Ok(Ok(()))
    }

    /// Stores a step. Repeated steps are only acknowledged, and steps that come too early are refused.
    fn store_move(&self, held: &StoredSlot, seq: usize, to: usize) -> InputResult {
        if seq < held.moves.len() {
            return Ok(Ok(()));
        }
        if seq > held.moves.len() || seq >= MAX_MOVES_PER_WALK || held.stopped_ms.is_some() {
            return Ok(Err(InputRefusal::OutOfTurn));
        }
        let Some((_, route, Some(scene))) = self.slot_contents(held) else { return Ok(Err(InputRefusal::Unknown)) };
        let here = held.moves.last().or_else(|| route.viewpoints.first());
        let place = here.and_then(|here| scene.places.get(here));
        let Some(there) = place.and_then(|place| place.neighbours.get(to)) else {
            return Ok(Err(InputRefusal::Unknown));
        };
        let insert = "INSERT INTO move (slot, seq, viewpoint, at_ms) VALUES (?1, ?2, ?3, ?4)";
        self.db
            .execute(insert, params![held.id, i64::try_from(seq).unwrap_or(i64::MAX), there.as_str(), self.now_ms])?;
        Ok(Ok(()))
    }

    fn store_stop(&self, held: &StoredSlot, seq: usize, looks: u32) -> InputResult {
        if self.study.plan.mode != StudyTask::Follow {
            return Ok(Err(InputRefusal::OutOfTurn));
        }
        if held.stopped_ms.is_none() {
            // An old page, of a place that the walker has left, must not end the walk.
            if seq != held.moves.len() {
                return Ok(Err(InputRefusal::OutOfTurn));
            }
            let update = "UPDATE slot SET stopped_ms = ?2, looks = ?3 WHERE id = ?1";
            self.db.execute(update, params![held.id, self.now_ms, looks.min(MAX_STORED_LOOKS)])?;
        }
        Ok(Ok(()))
    }

    /// Forgets the walk of a practice item that has ended, so that it begins again. A walk that counts is made once.
    fn restart_practice(&self, held: &StoredSlot) -> InputResult {
        if !held.is_practice {
            return Ok(Err(InputRefusal::OutOfTurn));
        }
        if held.stopped_ms.is_some() {
            self.db.execute("DELETE FROM move WHERE slot = ?1", [held.id])?;
            self.db.execute("UPDATE slot SET stopped_ms = NULL, looks = 0 WHERE id = ?1", [held.id])?;
        }
        Ok(Ok(()))
    }

    /// Stores the answer to an item. It is refused if the study has another task than `task`, or if it `is_early`.
    fn store_answer(
        &self,
        person: i64,
        held: &StoredSlot,
        task: StudyTask,
        is_early: bool,
        answer: &ParticipantAnswer,
    ) -> InputResult {
        if self.study.plan.mode != task || is_early {
            return Ok(Err(InputRefusal::OutOfTurn));
        }
        let Ok(answer) = serde_json::to_string(answer) else { return Ok(Err(InputRefusal::Unknown)) };
        let update = "UPDATE slot SET state = 'answered', answer = ?2, answered_ms = ?3 WHERE id = ?1";
        self.db.execute(update, params![held.id, answer, self.now_ms])?;
        self.end_if_done(person)?;
        Ok(Ok(()))
    }
}
