//! Reads the whole database into [`StudyData`], from which the results are computed.

use super::{StudyStore, StudyTransaction, people};
use crate::study::{
    AttentionCheck, EndAnswer, ItemSlot, Participant, ParticipantMove, SlotState, Study, StudyData, StudyError,
};
use rusqlite::{Connection, Row};
use std::collections::BTreeMap;
use wayword_core::ViewpointId;

impl StudyStore {
    /// Reads the study with all answers, from one snapshot.
    ///
    /// # Errors
    /// When a row cannot be read.
    pub(crate) fn into_data(mut self, study: Study, now_ms: i64) -> Result<StudyData, StudyError> {
        let read = |transaction: &StudyTransaction<'_>| {
            let forgotten = people::count_forgotten(transaction)?;
            let participants = read_participants(transaction.db)?;
            let slots = read_slots(transaction.db, transaction.now_ms)?;
            Ok((participants, slots, forgotten, transaction.is_closed()?))
        };
        let (participants, slots, forgotten, is_closed) = self.read_transaction(&study, now_ms, read)?;
        let Study { plan, settings, texts, items, routes, scenes, .. } = study;
        Ok(StudyData { plan, settings, texts, items, routes, scenes, participants, slots, forgotten, is_closed })
    }
}

fn read_participants(db: &Connection) -> Result<Vec<Participant>, StudyError> {
    let mut attention: BTreeMap<i64, Vec<AttentionCheck>> = BTreeMap::new();
    let mut checks = db.prepare("SELECT person, number, passed, at_ms FROM attention ORDER BY person, number")?;
    let mut rows = checks.query([])?;
    while let Some(row) = rows.next()? {
        let check = AttentionCheck { number: row.get(1)?, passed: row.get(2)?, at_ms: row.get(3)? };
        attention.entry(row.get(0)?).or_default().push(check);
    }
    let mut select = db.prepare(
        "SELECT person.id, name, status, consented_ms, consent, finished_ms, seen_ms, misunderstood, expected, understood, recruiter_status, \
         answers FROM person LEFT JOIN end_answers ON person = person.id ORDER BY consented_ms, person.id",
    )?;
    let participant = |row: &Row<'_>| {
        let id: i64 = row.get(0)?;
        let end: Option<Vec<EndAnswer>> = row
            .get::<_, Option<String>>(11)?
            .map(|answers| serde_json::from_str(&answers))
            .transpose()
            .map_err(|error| people::unreadable_value(11, error))?;
        Ok(Participant {
            id: row.get(1)?,
            status: people::status_in_column(row, 2)?,
            consented_ms: row.get(3)?,
            consent: row.get(4)?,
            finished_ms: row.get(5)?,
            seen_ms: row.get(6)?,
            misunderstood: row.get(7)?,
            expected: row.get(8)?,
            understood: row.get(9)?,
            recruiter_status: row.get(10)?,
            end: end.unwrap_or_default(),
            attention: attention.remove(&id).unwrap_or_default(),
        })
    };
    Ok(select.query_map([], participant)?.collect::<Result<_, _>>()?)
}

/// All items that were handed out. One with a lease that has run out counts as returned.
fn read_slots(db: &Connection, now_ms: i64) -> Result<Vec<ItemSlot>, StudyError> {
    let mut moves = read_moves(db)?;
    let mut select = db.prepare(
        "SELECT slot.id, person.name, item, position, state, lease_ms, given_ms, answered_ms, is_turned, answer, own_text, \
         pictures FROM slot JOIN person ON person.id = slot.person LEFT JOIN viewing ON viewing.slot = slot.id ORDER BY given_ms, slot.id",
    )?;
    let slot = |row: &Row<'_>| {
        let id: i64 = row.get(0)?;
        let lease_ms: i64 = row.get(5)?;
        let state = match row.get::<_, String>(4)?.as_str() {
            "answered" => SlotState::Answered,
            "live" if lease_ms > now_ms => SlotState::Live,
            _ => SlotState::Returned,
        };
        let answer: Option<String> = row.get(9)?;
        let answer = answer.map(|answer| serde_json::from_str(&answer)).transpose();
        Ok(ItemSlot {
            participant: row.get(1)?,
            item: row.get(2)?,
            position: row.get(3)?,
            state,
            given_ms: row.get(6)?,
            answered_ms: row.get(7)?,
            is_turned: row.get(8)?,
            answer: answer.map_err(|error| people::unreadable_value(9, error))?,
            own_text: row.get(10)?,
            pictures_seen: row.get(11)?,
            moves: moves.remove(&id).unwrap_or_default(),
        })
    };
    Ok(select.query_map([], slot)?.collect::<Result<_, _>>()?)
}

/// The steps of all walks, by the row id of their slot.
fn read_moves(db: &Connection) -> Result<BTreeMap<i64, Vec<ParticipantMove>>, StudyError> {
    let mut moves: BTreeMap<i64, Vec<ParticipantMove>> = BTreeMap::new();
    let mut select = db.prepare("SELECT slot, viewpoint, at_ms FROM move ORDER BY slot, seq")?;
    let mut rows = select.query([])?;
    while let Some(row) = rows.next()? {
        let name: String = row.get(1)?;
        let viewpoint = ViewpointId::new(name).map_err(|error| people::unreadable_value(1, error))?;
        moves.entry(row.get(0)?).or_default().push(ParticipantMove { viewpoint, at_ms: row.get(2)? });
    }
    Ok(moves)
}
