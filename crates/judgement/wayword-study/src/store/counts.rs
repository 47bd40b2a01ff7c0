//! Counts how far a study is, for `study status`.

use super::{StudyTransaction, people};
use crate::study::{ParticipantStatus, StudyError};
use rusqlite::params;
use serde::Serialize;
use std::collections::BTreeMap;

/// How far a study is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StudyProgress {
    /// Whether it is closed and accepts no more answers.
    pub is_closed: bool,
    /// One row for each condition; where texts are compared, for each pair of conditions.
    pub rows: Vec<ConditionProgress>,
    /// How many participants there are of each status.
    pub participants: BTreeMap<ParticipantStatus, u32>,
    /// How many participants have started, not finished, and given a sign of life within the lease.
    pub live: u32,
    /// How many participants were forgotten.
    pub forgotten: u64,
    /// Personal links that have not been used.
    pub unused_links: u32,
}

/// How far the items of a condition are.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ConditionProgress {
    /// The condition, or two with ` | ` between them.
    pub condition: String,
    /// How many items.
    pub items: u32,
    /// How many answers its items shall have in total.
    pub wanted: u32,
    /// How many answers its items have.
    pub answered: u32,
    /// How many items are lent to people at the moment.
    pub live: u32,
    /// The fewest answers of an item, and the most.
    pub answered_per_item: (u32, u32),
}

impl StudyTransaction<'_> {
    /// How many personal links nobody has used.
    pub(super) fn count_unused_links(&self) -> Result<u32, StudyError> {
        let count = "SELECT count(*) FROM link WHERE hash NOT IN (SELECT link FROM person)";
        Ok(self.db.query_row(count, params![], |row| row.get(0))?)
    }

    /// How far the study is.
    pub(crate) fn read_progress(&self) -> Result<StudyProgress, StudyError> {
        let filled = self.fill_counts()?;
        let mut rows: Vec<ConditionProgress> = Vec::new();
        for item in self.study.items.iter().filter(|item| !item.is_practice) {
            let names: Vec<&str> = item.texts.iter().map(|text| text.condition.as_str()).collect();
            let condition = names.join(" | ");
            let fill = filled.get(&item.id).copied().unwrap_or_default();
            let existing = rows.iter().position(|row| row.condition == condition);
            let row = match existing {
                Some(existing) => &mut rows[existing],
                None => {
                    let answered_per_item = (u32::MAX, 0);
                    rows.push(ConditionProgress {
                        condition,
                        items: 0,
                        wanted: 0,
                        answered: 0,
                        live: 0,
                        answered_per_item,
                    });
                    let last = rows.len() - 1;
                    &mut rows[last]
                }
            };
            row.items += 1;
            row.wanted += self.study.plan.per_item;
            row.answered += fill.answered;
            row.live += fill.live;
            let (least, most) = row.answered_per_item;
            row.answered_per_item = (least.min(fill.answered), most.max(fill.answered));
        }
        let mut counts = self.db.prepare("SELECT status, count(*) FROM person GROUP BY status")?;
        let participants = counts
            .query_map([], |row| Ok((people::status_in_column(row, 0)?, row.get(1)?)))?
            .collect::<Result<_, _>>()?;
        Ok(StudyProgress {
            is_closed: self.is_closed()?,
            rows,
            participants,
            live: self.count_live()?,
            forgotten: people::count_forgotten(self)?,
            unused_links: self.count_unused_links()?,
        })
    }
}
