//! Finds out which stage a participant has reached and what comes next. The stage is stored only in the database, so that a reload, a
//! second tab and another device all show the same.

use super::StudyTransaction;
use crate::study::{ParticipantStatus, StudyError, StudyItem, StudyRoute, StudyScene, StudyTask};
use rusqlite::{OptionalExtension as _, params};
use wayword_core::{ViewpointId, seed::derive_seed};

/// Levels that an attention check may ask for. The middle one is left out, because people choose it without reading.
const ATTENTION_LEVELS: [u8; 4] = [1, 2, 4, 5];

/// The stage that a participant has reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ParticipantStage {
    /// At the questions about the task, after `attempt` wrong tries.
    Understood { attempt: u32 },
    /// At an item.
    Item(StoredSlot),
    /// At attention check `number`, from 0, which asks for a level, 1 to 5.
    Attention { number: u32, level: u8 },
    /// At the questions at the end. All items are answered.
    End,
    /// At the end.
    Over(ParticipationOutcome),
}

/// How a participation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ParticipationOutcome {
    pub(crate) status: ParticipantStatus,
    /// How many items the participant has answered.
    pub(crate) answers: u32,
}

/// A slot of the database: an item that was handed out to a person.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct StoredSlot {
    /// The row's id in the database.
    pub(super) id: i64,
    /// Unix time at which the lease ends, milliseconds.
    pub(super) lease_end_ms: i64,
    /// `live`, `answered` or `returned`.
    pub(super) state: String,
    /// Its random name on pages.
    pub(crate) slot: String,
    /// The item's number.
    pub(crate) item: u32,
    pub(crate) is_practice: bool,
    /// In a pair: whether the item's second text is shown as A.
    pub(crate) is_turned: bool,
    /// The text that the participant wrote first, if the study asks for one.
    pub(crate) own_text: Option<String>,
    /// Unix time at which the walker stopped, milliseconds; `None` while the walk goes on.
    pub(crate) stopped_ms: Option<i64>,
    /// How often the walker turned to look around, as the page counted.
    pub(crate) looks: u32,
    /// The viewpoints to which the walker went, without the start.
    pub(crate) moves: Vec<ViewpointId>,
}

/// How many of a person's items are answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct AnswerProgress {
    pub(crate) answered: u32,
    pub(crate) expected: u32,
}

impl StudyTransaction<'_> {
    /// The stage of a person. Hands out the next item if one is due, and ends the participation if all items are answered.
    pub(crate) fn current_stage(&self, person: i64) -> Result<ParticipantStage, StudyError> {
        if let Some(outcome) = self.find_outcome(person)? {
            return self.stage_at_end(person, outcome);
        }
        let find = "SELECT understood, misunderstood FROM person WHERE id = ?1";
        let (understood, attempt) =
            self.db.query_row(find, [person], |row| Ok((row.get::<_, bool>(0)?, row.get(1)?)))?;
        if !understood {
            return Ok(ParticipantStage::Understood { attempt });
        }
        if let Some(held) = self.live_slot(person)?
            && self.renew_lease(held.id, held.item, held.lease_end_ms, held.is_practice)?
        {
            return Ok(ParticipantStage::Item(held));
        }
        let has_slots: bool =
            self.db.query_row("SELECT EXISTS (SELECT 1 FROM slot WHERE person = ?1)", [person], |row| row.get(0))?;
        let is_given = if has_slots { false } else { self.hand_out_practice(person)? };
        let progress = self.answer_progress(person)?;
        if !is_given && let Some(number) = self.check_due(person, progress)? {
            return Ok(ParticipantStage::Attention { number, level: self.asked_level(person, number)? });
        }
        let is_given = is_given || (progress.answered < progress.expected && self.hand_out_next(person)?);
        match self.live_slot(person)?.filter(|_| is_given) {
            Some(held) => Ok(ParticipantStage::Item(held)),
            None => self.finish_person(person),
        }
    }

    /// Ends the participation of a person who has answered everything.
    fn finish_person(&self, person: i64) -> Result<ParticipantStage, StudyError> {
        let status = if self.has_failed_checks(person)? {
            ParticipantStatus::AttentionFailed
        } else {
            ParticipantStatus::Complete
        };
        let outcome = self.end_participation(person, status)?;
        self.stage_at_end(person, outcome)
    }

    /// The stage of a person whose participation has ended. Who answered all items is complete, also without an answer to the questions at
    /// the end: these come before the code, and an empty page of them loses nothing.
    fn stage_at_end(&self, person: i64, outcome: ParticipationOutcome) -> Result<ParticipantStage, StudyError> {
        Ok(if self.has_end_questions(person, outcome.status)? {
            ParticipantStage::End
        } else {
            ParticipantStage::Over(outcome)
        })
    }

    /// Whether a person still has to answer the questions at the end. In a closed study nobody has to.
    pub(super) fn has_end_questions(&self, person: i64, status: ParticipantStatus) -> Result<bool, StudyError> {
        let is_done = matches!(status, ParticipantStatus::Complete | ParticipantStatus::AttentionFailed);
        if !is_done || self.study.settings.end.is_empty() || self.is_closed()? {
            return Ok(false);
        }
        let find = "SELECT EXISTS (SELECT 1 FROM end_answers WHERE person = ?1)";
        Ok(!self.db.query_row(find, [person], |row| row.get::<_, bool>(0))?)
    }

    /// Ends the participation if everything is answered. It is called after each answer, because many people close the page after the
    /// last one.
    pub(super) fn end_if_done(&self, person: i64) -> Result<(), StudyError> {
        let progress = self.answer_progress(person)?;
        if progress.answered >= progress.expected
            && progress.answered > 0
            && self.check_due(person, progress)?.is_none()
        {
            self.finish_person(person)?;
        }
        Ok(())
    }

    /// Ends the participation of every participant who has answered everything.
    pub(super) fn end_all_done(&self) -> Result<(), StudyError> {
        let mut find = self.db.prepare("SELECT id FROM person WHERE status = 'started'")?;
        let persons: Vec<i64> = find.query_map([], |row| row.get(0))?.collect::<Result<_, _>>()?;
        persons.into_iter().try_for_each(|person| self.end_if_done(person))
    }

    /// How many items are answered, and how many there will be.
    pub(crate) fn answer_progress(&self, person: i64) -> Result<AnswerProgress, StudyError> {
        let find = "SELECT expected, (SELECT count(*) FROM slot WHERE person = person.id AND state = 'answered' AND position IS NOT NULL) \
                    FROM person WHERE id = ?1";
        Ok(self
            .db
            .query_row(find, [person], |row| Ok(AnswerProgress { expected: row.get(0)?, answered: row.get(1)? }))?)
    }

    /// The unanswered item that a person has.
    fn live_slot(&self, person: i64) -> Result<Option<StoredSlot>, StudyError> {
        self.slot_where("person = ?1 AND state = 'live' ORDER BY id DESC LIMIT 1", person, "")
    }

    /// A slot of a person by its name on pages, in any state.
    pub(super) fn slot_by_name(&self, person: i64, slot: &str) -> Result<Option<StoredSlot>, StudyError> {
        self.slot_where("person = ?1 AND name = ?2", person, slot)
    }

    /// The slot of a person that meets an SQL condition, with its steps.
    fn slot_where(&self, condition: &str, person: i64, slot: &str) -> Result<Option<StoredSlot>, StudyError> {
        // `?2 = ?2` is for conditions without `?2`: each parameter must occur in the statement.
        let mut find = self.db.prepare_cached(&format!(
            "SELECT id, lease_ms, name, item, position IS NULL, is_turned, own_text, stopped_ms, looks, state FROM slot \
             WHERE ?2 = ?2 AND {condition}"
        ))?;
        let held = find.query_row(params![person, slot], |row| {
            Ok(StoredSlot {
                id: row.get(0)?,
                lease_end_ms: row.get(1)?,
                slot: row.get(2)?,
                item: row.get(3)?,
                is_practice: row.get(4)?,
                is_turned: row.get(5)?,
                own_text: row.get(6)?,
                stopped_ms: row.get(7)?,
                looks: row.get(8)?,
                state: row.get(9)?,
                moves: Vec::new(),
            })
        });
        let Some(mut held) = held.optional()? else { return Ok(None) };
        let mut moves = self.db.prepare_cached("SELECT viewpoint FROM move WHERE slot = ?1 ORDER BY seq")?;
        let names: Vec<String> = moves.query_map([held.id], |row| row.get(0))?.collect::<Result<_, _>>()?;
        held.moves = names.into_iter().filter_map(|name| ViewpointId::new(name).ok()).collect();
        Ok(Some(held))
    }

    /// The number of the attention check that is due at this point, if one is. Checks are spread evenly over the items.
    pub(super) fn check_due(&self, person: i64, progress: AnswerProgress) -> Result<Option<u32>, StudyError> {
        let checks = self.study.settings.attention_checks;
        let answered: u32 =
            self.db.query_row("SELECT count(*) FROM attention WHERE person = ?1", [person], |row| row.get(0))?;
        let due_after = (progress.expected * (answered + 1)).div_ceil(checks + 1);
        Ok((answered < checks && progress.answered >= due_after).then_some(answered))
    }

    /// The level that an attention check asks this person for.
    pub(super) fn asked_level(&self, person: i64, number: u32) -> Result<u8, StudyError> {
        let name: String = self.db.query_row("SELECT name FROM person WHERE id = ?1", [person], |row| row.get(0))?;
        let drawn = derive_seed(self.study.plan.seed, &["attention", &name, &number.to_string()]);
        Ok(ATTENTION_LEVELS[(drawn % ATTENTION_LEVELS.len() as u64) as usize])
    }

    /// Whether more attention checks failed than are tolerated.
    fn has_failed_checks(&self, person: i64) -> Result<bool, StudyError> {
        let count = "SELECT count(*) FROM attention WHERE person = ?1 AND NOT passed";
        let failed: u32 = self.db.query_row(count, [person], |row| row.get(0))?;
        Ok(failed as usize > self.study.settings.tolerated_failed_checks())
    }

    /// Whether a participation has ended.
    pub(crate) fn is_over(&self, person: i64) -> Result<bool, StudyError> {
        Ok(self.find_outcome(person)?.is_some())
    }

    /// The file of the panorama at the place that a walker reached after `steps` steps. Other places of the scene are not available.
    pub(crate) fn panorama_file(&self, person: i64, slot: &str, steps: usize) -> Result<Option<String>, StudyError> {
        let Some(held) = self.slot_by_name(person, slot)? else { return Ok(None) };
        let Some((_, route, Some(scene))) = self.slot_contents(&held) else { return Ok(None) };
        let here = if steps == 0 { route.viewpoints.first() } else { held.moves.get(steps - 1) };
        Ok(here.and_then(|here| scene.places.get(here)).map(|place| place.panorama.clone()))
    }

    /// The file of a picture in the film of a person's item.
    pub(crate) fn film_picture(&self, person: i64, slot: &str, number: usize) -> Result<Option<String>, StudyError> {
        let Some(held) = self.slot_by_name(person, slot)? else { return Ok(None) };
        let film = self.slot_contents(&held).map(|(_, route, _)| &route.film);
        Ok(film.and_then(|film| film.get(number)).map(|picture| picture.file.clone()))
    }

    /// The item, route and scene of a slot; a scene only where people walk.
    pub(crate) fn slot_contents(&self, held: &StoredSlot) -> Option<(&StudyItem, &StudyRoute, Option<&StudyScene>)> {
        let item = self.study.items.get(held.item as usize)?;
        let route = self.study.routes.get(item.route as usize)?;
        let scene = if self.study.plan.mode == StudyTask::Follow { self.study.scene_of(route) } else { None };
        Some((item, route, scene))
    }
}
