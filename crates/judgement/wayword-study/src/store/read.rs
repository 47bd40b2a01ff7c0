//! Reads the whole database into [`Data`], from which the results are computed.

use super::{Book, Store, people};
use crate::study::{Data, Move, Participant, Passed, Slot, SlotState, Study, StudyError};
use rusqlite::{Connection, Row};
use std::collections::BTreeMap;
use wayword_core::ViewpointId;

impl Store {
    /// Reads the study with all answers, from one snapshot.
    ///
    /// # Errors
    /// When a row cannot be read.
    pub(crate) fn data(mut self, study: Study, now_ms: i64) -> Result<Data, StudyError> {
        let read = |book: &Book<'_>| {
            let forgotten = people::forgotten(book)?;
            Ok((participants(book.db)?, slots(book.db, book.now_ms)?, forgotten, book.is_closed()?))
        };
        let (participants, slots, forgotten, is_closed) = self.read(&study, now_ms, read)?;
        let Study { plan, settings, items, routes, scenes, .. } = study;
        Ok(Data { plan, settings, items, routes, scenes, participants, slots, forgotten, is_closed })
    }
}

fn participants(db: &Connection) -> Result<Vec<Participant>, StudyError> {
    let mut attention: BTreeMap<i64, Vec<Passed>> = BTreeMap::new();
    let mut checks = db.prepare("SELECT person, number, passed, at_ms FROM attention ORDER BY person, number")?;
    let mut rows = checks.query([])?;
    while let Some(row) = rows.next()? {
        let passed = Passed { number: row.get(1)?, passed: row.get(2)?, at_ms: row.get(3)? };
        attention.entry(row.get(0)?).or_default().push(passed);
    }
    let mut all = db.prepare(
        "SELECT id, name, status, consented_ms, consent, finished_ms, seen_ms, misunderstood, expected, understood, recruiter_status FROM person \
         ORDER BY consented_ms, id",
    )?;
    let participant = |row: &Row<'_>| {
        let id: i64 = row.get(0)?;
        Ok(Participant {
            id: row.get(1)?,
            status: people::status_of(row, 2)?,
            consented_ms: row.get(3)?,
            consent: row.get(4)?,
            finished_ms: row.get(5)?,
            seen_ms: row.get(6)?,
            misunderstood: row.get(7)?,
            expected: row.get(8)?,
            understood: row.get(9)?,
            recruiter_status: row.get(10)?,
            attention: attention.remove(&id).unwrap_or_default(),
        })
    };
    Ok(all.query_map([], participant)?.collect::<Result<_, _>>()?)
}

fn slots(db: &Connection, now_ms: i64) -> Result<Vec<Slot>, StudyError> {
    let mut moves = moves(db)?;
    let mut all = db.prepare(
        "SELECT slot.id, person.name, item, position, state, lease_ms, given_ms, answered_ms, is_turned, answer, own_text \
         FROM slot JOIN person ON person.id = slot.person ORDER BY given_ms, slot.id",
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
        Ok(Slot {
            participant: row.get(1)?,
            item: row.get(2)?,
            position: row.get(3)?,
            state,
            given_ms: row.get(6)?,
            answered_ms: row.get(7)?,
            is_turned: row.get(8)?,
            answer: answer.map_err(|error| people::unreadable(9, error))?,
            own_text: row.get(10)?,
            moves: moves.remove(&id).unwrap_or_default(),
        })
    };
    Ok(all.query_map([], slot)?.collect::<Result<_, _>>()?)
}

fn moves(db: &Connection) -> Result<BTreeMap<i64, Vec<Move>>, StudyError> {
    let mut moves: BTreeMap<i64, Vec<Move>> = BTreeMap::new();
    let mut all = db.prepare("SELECT slot, viewpoint, at_ms FROM move ORDER BY slot, seq")?;
    let mut rows = all.query([])?;
    while let Some(row) = rows.next()? {
        let name: String = row.get(1)?;
        let viewpoint = ViewpointId::new(name).map_err(|error| people::unreadable(1, error))?;
        moves.entry(row.get(0)?).or_default().push(Move { viewpoint, at_ms: row.get(2)? });
    }
    Ok(moves)
}
