//! Decides who gets which item.
//!
//! Items with the fewest answers come first, and no participant gets a route or a text twice. An item is lent for the time of a lease, which each
//! sign of life renews. When the lease has run out, the item may go to another participant.

use super::{StudyTransaction, people::new_token};
use crate::study::{StudyError, StudyItem};
use rusqlite::params;
use std::collections::BTreeMap;
use wayword_core::seed::derive_seed;

/// How many answers an item has, and how many may still come.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ItemFillCount {
    pub(super) answered: u32,
    /// Lent to people under a lease that has not run out.
    pub(super) live: u32,
}

/// How many answers an item has, plus those that its current holders may still give.
fn filled_places(filled: &BTreeMap<u32, ItemFillCount>, item: u32) -> u32 {
    filled.get(&item).map_or(0, |filled| filled.answered + filled.live)
}

/// Whether an item has another route and other texts than those that its holder got before. Who has read a text on one route would know it
/// again on another.
fn is_new_to_holder(item: &StudyItem, earlier: &[&StudyItem]) -> bool {
    !earlier.iter().any(|known| known.route == item.route || known.shares_text_with(item))
}

impl StudyTransaction<'_> {
    /// Length of a lease, milliseconds.
    pub(super) fn lease_length_ms(&self) -> i64 {
        i64::try_from(self.study.settings.lease_s).unwrap_or(i64::MAX / 2000).saturating_mul(1000)
    }

    /// How full each item is. A lease that ends later than one that begins now was written before the clock was set back; it counts as
    /// run out.
    pub(super) fn fill_counts(&self) -> Result<BTreeMap<u32, ItemFillCount>, StudyError> {
        let mut count = self.db.prepare_cached(
            "SELECT item, sum(state = 'answered'), sum(state = 'live' AND lease_ms BETWEEN ?1 + 1 AND ?2) FROM slot \
             WHERE position IS NOT NULL GROUP BY item",
        )?;
        let counts = count.query_map([self.now_ms, self.now_ms + self.lease_length_ms()], |row| {
            Ok((row.get(0)?, ItemFillCount { answered: row.get(1)?, live: row.get(2)? }))
        })?;
        Ok(counts.collect::<Result<_, _>>()?)
    }

    /// How many items, each on another route and with another text, would be left for one more person if all current participants finish.
    pub(super) fn count_free_items(&self) -> Result<u32, StudyError> {
        let filled = self.fill_counts()?;
        let per_item = self.study.plan.per_item;
        let free_places = |item: &StudyItem| u64::from(per_item.saturating_sub(filled_places(&filled, item.id)));
        let open: u64 = self.study.items.iter().filter(|item| !item.is_practice).map(free_places).sum();
        let mut taken: Vec<&StudyItem> = self.study.items.iter().filter(|item| item.is_practice).take(1).collect();
        let practice_items = taken.len();
        for item in self.study.items.iter().filter(|item| !item.is_practice && free_places(item) > 0) {
            if is_new_to_holder(item, &taken) {
                taken.push(item);
            }
        }
        let takeable = taken.len() - practice_items;
        // What the current participants will still take: the items that each expects, without those answered or held.
        let pending: i64 = self.db.query_row(
            "SELECT coalesce(sum(max(0, expected - (SELECT count(*) FROM slot WHERE person = person.id AND position IS NOT NULL \
             AND (state = 'answered' OR (state = 'live' AND lease_ms > ?1))))), 0) \
             FROM person WHERE status = 'started' AND seen_ms > ?2",
            params![self.now_ms, self.now_ms - self.lease_length_ms()],
            |row| row.get(0),
        )?;
        let remaining = open.saturating_sub(pending.unsigned_abs()).min(takeable as u64);
        Ok(u32::try_from(remaining).unwrap_or(u32::MAX))
    }

    /// Gives a person the item for practice, if the study has one.
    pub(super) fn hand_out_practice(&self, person: i64) -> Result<bool, StudyError> {
        let practice = self.study.items.iter().find(|item| item.is_practice);
        let Some(item) = practice else { return Ok(false) };
        self.hand_out(person, item, None)?;
        Ok(true)
    }

    /// Gives a person the next item: among the least filled ones, one of the condition that the person has had least often, and among
    /// these one by the seed. Returns false if no item is left for this person.
    pub(super) fn hand_out_next(&self, person: i64) -> Result<bool, StudyError> {
        let filled = self.fill_counts()?;
        let (earlier_items, name) = self.items_handed_out(person)?;
        let mut conditions: BTreeMap<&str, u32> = BTreeMap::new();
        for text in earlier_items.iter().filter(|item| !item.is_practice).flat_map(|item| &item.texts) {
            *conditions.entry(&text.condition).or_default() += 1;
        }
        let seed = self.study.plan.seed;
        let key = |item: &&StudyItem| {
            let condition_uses: u32 =
                item.texts.iter().map(|text| conditions.get(text.condition.as_str()).copied().unwrap_or(0)).sum();
            (filled_places(&filled, item.id), condition_uses, derive_seed(seed, &["item", &name, &item.id.to_string()]))
        };
        let open = |item: &&StudyItem| {
            !item.is_practice
                && filled_places(&filled, item.id) < self.study.plan.per_item
                && is_new_to_holder(item, &earlier_items)
        };
        let Some(item) = self.study.items.iter().filter(open).min_by_key(key) else { return Ok(false) };
        let position = earlier_items.iter().filter(|item| !item.is_practice).count();
        self.hand_out(person, item, u32::try_from(position).ok())?;
        Ok(true)
    }

    /// The items that a person has got so far, and the person's id in the results.
    fn items_handed_out(&self, person: i64) -> Result<(Vec<&StudyItem>, String), StudyError> {
        let name: String = self.db.query_row("SELECT name FROM person WHERE id = ?1", [person], |row| row.get(0))?;
        let mut slots = self.db.prepare_cached("SELECT item FROM slot WHERE person = ?1")?;
        let ids: Vec<u32> = slots.query_map([person], |row| row.get(0))?.collect::<Result<_, _>>()?;
        Ok((ids.into_iter().filter_map(|id| self.study.items.get(id as usize)).collect(), name))
    }

    /// Lends an item to a person. `position` is its place among the person's items, `None` for practice.
    fn hand_out(&self, person: i64, item: &StudyItem, position: Option<u32>) -> Result<(), StudyError> {
        let name = new_token()?;
        let is_turned = derive_seed(self.study.plan.seed, &["sides", &name]) % 2 == 1;
        self.db.execute(
            "INSERT INTO slot (name, person, item, route, position, state, lease_ms, given_ms, is_turned) \
             VALUES (?1, ?2, ?3, ?4, ?5, 'live', ?6, ?7, ?8)",
            params![
                name,
                person,
                item.id,
                item.route,
                position,
                self.now_ms + self.lease_length_ms(),
                self.now_ms,
                is_turned
            ],
        )?;
        Ok(())
    }

    /// Renews the lease of an item. If the lease has run out and others have filled the item meanwhile, the item is returned instead,
    /// and the result is false.
    pub(super) fn renew_lease(
        &self,
        slot: i64,
        item: u32,
        lease_end_ms: i64,
        is_practice: bool,
    ) -> Result<bool, StudyError> {
        let until_ms = self.now_ms + self.lease_length_ms();
        let is_over = lease_end_ms <= self.now_ms;
        if is_over && !is_practice && filled_places(&self.fill_counts()?, item) >= self.study.plan.per_item {
            self.db.execute("UPDATE slot SET state = 'returned' WHERE id = ?1 AND state = 'live'", [slot])?;
            return Ok(false);
        }
        // A lease is renewed only when a tenth of it is gone, so that merely loading pages causes no writes.
        if is_over || until_ms - lease_end_ms > self.lease_length_ms() / 10 {
            self.db.execute("UPDATE slot SET lease_ms = ?2 WHERE id = ?1", params![slot, until_ms])?;
        }
        Ok(true)
    }

    /// Returns all items that a person has not answered.
    pub(super) fn give_back(&self, person: i64) -> Result<(), StudyError> {
        self.db.execute("UPDATE slot SET state = 'returned' WHERE person = ?1 AND state = 'live'", [person])?;
        Ok(())
    }
}
