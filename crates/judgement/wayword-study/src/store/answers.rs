//! Stores the input of participants. Each input is stored once; if a browser sends it again, nothing changes and it is acknowledged
//! again.

use super::{Book, stage::Held};
use crate::study::{Answer, Choice, Mode, Status, StudyError};
use rusqlite::params;

/// Most steps of a walk. Paths of the known datasets have fewer than 20.
pub(crate) const MOST_MOVES: usize = 200;
/// Longest text that a participant may write, characters.
pub(crate) const LONGEST_TEXT: usize = 1000;
/// Upper bound on the number of turns that a page may report.
const MOST_LOOKS: u32 = 100_000;

/// One input of a participant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Given {
    /// The answers to the questions about the task.
    Understood { attempt: u32, answers: Vec<usize> },
    /// A text that the participant wrote.
    OwnText { slot: String, text: String },
    /// A step to neighbour number `to` of the current place, after `seq` steps.
    Move { slot: String, seq: usize, to: usize },
    /// The end of a walk.
    Stop { slot: String, seq: usize, looks: u32 },
    /// The levels of the statements after a walk.
    Followed { slot: String, statements: [u8; 3] },
    /// The levels of a text.
    Rated { slot: String, ratings: [u8; 4] },
    /// Which text is better.
    Chosen { slot: String, choice: Choice },
    /// An attention check.
    Attention { number: u32, choice: u8 },
}

/// Why an input is not stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refusal {
    /// It does not belong to this person, or does not exist.
    Unknown,
    /// It comes before a step that must be done first, or after the end.
    OutOfTurn,
    /// The time ran out, and the item went to others.
    Returned,
    /// The study is over.
    Closed,
}

type Kept = Result<Result<(), Refusal>, StudyError>;

impl Book<'_> {
    /// Stores an input of a person, once.
    pub(crate) fn give(&self, person: i64, given: Given) -> Kept {
        if self.is_closed()? {
            return Ok(Err(Refusal::Closed));
        }
        match given {
            Given::Understood { attempt, answers } => self.understood(person, attempt, &answers),
            Given::Attention { number, choice } => self.attention(person, number, choice),
            Given::OwnText { slot, text } => self.with(person, &slot, |held| self.own_text(held, &text)),
            Given::Move { slot, seq, to } => self.with(person, &slot, |held| self.step(held, seq, to)),
            Given::Stop { slot, seq, looks } => self.with(person, &slot, |held| self.stop(held, seq, looks)),
            Given::Rated { slot, ratings } => self.with(person, &slot, |held| {
                let is_early = self.study.settings.write_first && held.own_text.is_none();
                self.answer(person, held, Mode::Rate, is_early, &Answer::Rate { ratings })
            }),
            Given::Chosen { slot, choice } => {
                self.with(person, &slot, |held| self.answer(person, held, Mode::Pair, false, &Answer::Pair { choice }))
            }
            Given::Followed { slot, statements } => self.with(person, &slot, |held| {
                let answer = Answer::Follow {
                    statements,
                    looks: held.looks,
                    stopped_ms: held.stopped_ms.unwrap_or(self.now_ms),
                };
                self.answer(person, held, Mode::Follow, held.stopped_ms.is_none(), &answer)
            }),
        }
    }

    /// Runs `work` on an item that the person has. If the item is already answered, it only acknowledges that.
    fn with(&self, person: i64, slot: &str, work: impl FnOnce(&Held) -> Kept) -> Kept {
        let Some(held) = self.named(person, slot)? else { return Ok(Err(Refusal::Unknown)) };
        match held.state.as_str() {
            "answered" => Ok(Ok(())),
            "live" => work(&held),
            _ => Ok(Err(Refusal::Returned)),
        }
    }

    fn understood(&self, person: i64, attempt: u32, answers: &[usize]) -> Kept {
        let find = "SELECT status = 'started' AND NOT understood, misunderstood FROM person WHERE id = ?1";
        let (is_open, now): (bool, u32) = self.db.query_row(find, [person], |row| Ok((row.get(0)?, row.get(1)?)))?;
        if !is_open || attempt < now {
            return Ok(Ok(()));
        }
        if attempt > now {
            return Ok(Err(Refusal::OutOfTurn));
        }
        let right = self.study.settings.questions.iter().map(|question| question.right);
        if right.eq(answers.iter().copied()) {
            self.db.execute("UPDATE person SET understood = 1 WHERE id = ?1", [person])?;
            return Ok(Ok(()));
        }
        self.db.execute("UPDATE person SET misunderstood = misunderstood + 1 WHERE id = ?1", [person])?;
        if now + 1 >= 2 {
            self.end(person, Status::ScreenedOut)?;
        }
        Ok(Ok(()))
    }

    fn attention(&self, person: i64, number: u32, choice: u8) -> Kept {
        let answered: u32 =
            self.db.query_row("SELECT count(*) FROM attention WHERE person = ?1", [person], |row| row.get(0))?;
        if number < answered {
            return Ok(Ok(()));
        }
        let is_due = self.check_due(person, self.done(person)?)? == Some(number);
        if !is_due || self.outcome(person)?.is_some() {
            return Ok(Err(Refusal::OutOfTurn));
        }
        let passed = choice == self.asked_level(person, number)?;
        let kept = "INSERT INTO attention (person, number, passed, at_ms) VALUES (?1, ?2, ?3, ?4)";
        self.db.execute(kept, params![person, number, passed, self.now_ms])?;
        self.end_if_done(person)?;
        Ok(Ok(()))
    }

    fn own_text(&self, held: &Held, text: &str) -> Kept {
        if held.own_text.is_none() {
            let text: String = text.chars().take(LONGEST_TEXT).collect();
            self.db.execute("UPDATE slot SET own_text = ?2 WHERE id = ?1", params![held.id, text])?;
        }
        Ok(Ok(()))
    }

    fn step(&self, held: &Held, seq: usize, to: usize) -> Kept {
        if seq < held.moves.len() {
            return Ok(Ok(()));
        }
        if seq > held.moves.len() || seq >= MOST_MOVES || held.stopped_ms.is_some() {
            return Ok(Err(Refusal::OutOfTurn));
        }
        let Some((_, route, Some(scene))) = self.of(held) else { return Ok(Err(Refusal::Unknown)) };
        let here = held.moves.last().or_else(|| route.viewpoints.first());
        let place = here.and_then(|here| scene.places.get(here));
        let Some(there) = place.and_then(|place| place.neighbours.get(to)) else { return Ok(Err(Refusal::Unknown)) };
        let kept = "INSERT INTO move (slot, seq, viewpoint, at_ms) VALUES (?1, ?2, ?3, ?4)";
        self.db.execute(kept, params![held.id, i64::try_from(seq).unwrap_or(i64::MAX), there.as_str(), self.now_ms])?;
        Ok(Ok(()))
    }

    fn stop(&self, held: &Held, seq: usize, looks: u32) -> Kept {
        if self.study.plan.mode != Mode::Follow {
            return Ok(Err(Refusal::OutOfTurn));
        }
        if held.stopped_ms.is_none() {
            // An old page, of a place that the walker has left, must not end the walk.
            if seq != held.moves.len() {
                return Ok(Err(Refusal::OutOfTurn));
            }
            let stopped = "UPDATE slot SET stopped_ms = ?2, looks = ?3 WHERE id = ?1";
            self.db.execute(stopped, params![held.id, self.now_ms, looks.min(MOST_LOOKS)])?;
        }
        Ok(Ok(()))
    }

    fn answer(&self, person: i64, held: &Held, of: Mode, is_early: bool, answer: &Answer) -> Kept {
        if self.study.plan.mode != of || is_early {
            return Ok(Err(Refusal::OutOfTurn));
        }
        let Ok(answer) = serde_json::to_string(answer) else { return Ok(Err(Refusal::Unknown)) };
        let kept = "UPDATE slot SET state = 'answered', answer = ?2, answered_ms = ?3 WHERE id = ?1";
        self.db.execute(kept, params![held.id, answer, self.now_ms])?;
        self.end_if_done(person)?;
        Ok(Ok(()))
    }
}
