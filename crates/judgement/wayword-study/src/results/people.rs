//! Counts the participants: how many took part, at which item people stopped, and who failed attention checks.

use super::{
    judgements::{AnsweredItem, seconds_between},
    names::ParticipantNames,
};
use crate::{ItemSlot, Participant, ParticipantStatus, SlotState, StudyData};
use serde::Serialize;
use std::collections::BTreeMap;

/// Counts of participants by how far they came, and of items by what became of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParticipantSummary {
    /// Participants who consented, without the forgotten ones.
    pub consented: usize,
    /// Those who answered everything and passed the attention checks.
    pub complete: usize,
    /// Those who have not finished and were active within the lease.
    pub live: usize,
    /// Those who have not finished and have been inactive for longer than the lease.
    pub quiet: usize,
    /// Those who stopped and let us keep their answers.
    pub withdrawn: usize,
    /// Those who did not understand the task in two tries.
    pub screened_out: usize,
    /// Those who answered everything and failed the attention checks.
    pub attention_failed: usize,
    /// Those for whom all answers were deleted.
    pub forgotten: u64,
    /// The lease: after this many seconds without activity a participant counts as gone quiet.
    pub lease_s: u64,
    /// Median of the minutes from consent to the end, of those who answered everything.
    pub median_minutes: Option<f64>,
    /// The minutes that the consent page announced.
    pub announced_minutes: u32,
    /// How many understood the task at once, at the second try, and not in two.
    pub misunderstood: [usize; 3],
    /// What became of the items, by their position in the sequence of a participant.
    pub by_position: Vec<HandoutCounts>,
    /// What became of the items, by condition.
    pub by_condition: Vec<HandoutCounts>,
    /// What became of the items, by item.
    pub by_item: Vec<HandoutCounts>,
    /// The attention checks.
    pub attention: AttentionSummary,
}

/// What became of the items that were handed out, for one position, condition or item.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct HandoutCounts {
    /// The position from 1, the name of the condition, or the number of the item.
    pub of: String,
    /// How often one was given.
    pub given: usize,
    /// How many were answered.
    pub answered: usize,
    /// How many were returned unanswered.
    pub returned: usize,
    /// How many a participant still has.
    pub live: usize,
    /// Median of the seconds from getting one to its answer.
    pub median_seconds: Option<f64>,
}

/// The attention checks of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AttentionSummary {
    /// How many a participant gets.
    pub per_participant: u32,
    /// How many failed checks are tolerated: one in a study of 5 minutes or more, none in a shorter one (Prolific's rule).
    pub most_failed: usize,
    /// How many were answered, by all participants together.
    pub answered: usize,
    /// How many of them were failed.
    pub failed: usize,
    /// The participants who failed at least one check.
    pub by_participant: Vec<FailedChecks>,
}

/// The failed attention checks of a participant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FailedChecks {
    /// The participant's name in the results.
    pub participant: String,
    /// How many checks were answered.
    pub answered: usize,
    /// The numbers of the failed ones, from 1.
    pub checks: Vec<u32>,
    /// Whether Prolific's rule allows to reject the submission.
    pub is_over: bool,
}

impl ParticipantSummary {
    pub(super) fn new(
        data: &StudyData,
        names: &ParticipantNames<'_>,
        answered: &[AnsweredItem<'_>],
        now_ms: i64,
    ) -> Self {
        let people = &data.participants;
        let count = |status| people.iter().filter(|person| person.status == status).count();
        let is_quiet = |person: &&Participant| seconds_between(person.seen_ms, now_ms) > data.settings.lease_s as f64;
        let started = people.iter().filter(|person| person.status == ParticipantStatus::Started);
        let quiet = started.clone().filter(is_quiet).count();
        let minutes = people.iter().filter_map(minutes_taken).collect();
        // Participants who left at the questions have neither understood the task nor failed to.
        let is_known = |person: &&Participant| person.understood || person.status == ParticipantStatus::ScreenedOut;
        let known = || people.iter().filter(is_known);
        let count_with_wrong_tries =
            |tries: usize| known().filter(|person| person.misunderstood.min(2) as usize == tries).count();
        let tally = HandoutTally::new(data, answered);
        Self {
            consented: people.len(),
            complete: count(ParticipantStatus::Complete),
            live: started.count() - quiet,
            quiet,
            withdrawn: count(ParticipantStatus::Withdrawn),
            screened_out: count(ParticipantStatus::ScreenedOut),
            attention_failed: count(ParticipantStatus::AttentionFailed),
            forgotten: data.forgotten,
            lease_s: data.settings.lease_s,
            median_minutes: median(minutes),
            announced_minutes: data.settings.minutes,
            misunderstood: [0, 1, 2].map(count_with_wrong_tries),
            by_position: tally.by_position(),
            by_condition: tally.by_condition(),
            by_item: tally.by_item(),
            attention: AttentionSummary::new(data, names),
        }
    }
}

/// Minutes from consent to the end, of a participant who answered everything.
fn minutes_taken(person: &Participant) -> Option<f64> {
    let is_done = matches!(person.status, ParticipantStatus::Complete | ParticipantStatus::AttentionFailed);
    let end_ms = person.finished_ms.filter(|_| is_done)?;
    Some(seconds_between(person.consented_ms, end_ms) / 60.0)
}

/// The median: the middle value, or the mean of the two in the middle.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let high = *values.get(middle)?;
    if values.len() % 2 == 1 {
        return Some(high);
    }
    Some(f64::midpoint(*values.get(middle.checked_sub(1)?)?, high))
}

/// Counts handed-out items by position, condition and item.
struct HandoutTally<'a> {
    data: &'a StudyData,
    /// The slots with their positions. Practice is left out.
    slots: Vec<(&'a ItemSlot, u32)>,
    /// The seconds of an answer, by participant and item.
    seconds: BTreeMap<(&'a str, u32), f64>,
}

impl<'a> HandoutTally<'a> {
    fn new(data: &'a StudyData, answered: &'a [AnsweredItem<'a>]) -> Self {
        let slots = data.slots.iter().filter_map(|slot| Some((slot, slot.position?))).collect();
        let time =
            |one: &'a AnsweredItem<'a>| Some(((one.participant.id.as_str(), one.item.id), one.answer_seconds()?));
        Self { data, slots, seconds: answered.iter().filter_map(time).collect() }
    }

    /// Counts the slots of a group: of a position, a condition or an item.
    fn count_handouts(&self, group: String, slots: impl Iterator<Item = &'a ItemSlot>) -> HandoutCounts {
        let mut counts = HandoutCounts { of: group, ..HandoutCounts::default() };
        let mut times = Vec::new();
        for slot in slots {
            counts.given += 1;
            match slot.state {
                SlotState::Answered => counts.answered += 1,
                SlotState::Returned => counts.returned += 1,
                SlotState::Live => counts.live += 1,
            }
            times.extend(self.seconds.get(&(slot.participant.as_str(), slot.item)));
        }
        counts.median_seconds = median(times);
        counts
    }

    fn by_position(&self) -> Vec<HandoutCounts> {
        let last = self.slots.iter().map(|(_, position)| *position + 1).max().unwrap_or(0);
        let slots_at =
            |place: u32| self.slots.iter().filter(move |(_, position)| *position == place).map(|(slot, _)| *slot);
        // The bound keeps the table small if a damaged store contains an impossible position.
        (0..last.min(10_000)).map(|place| self.count_handouts((place + 1).to_string(), slots_at(place))).collect()
    }

    fn by_condition(&self) -> Vec<HandoutCounts> {
        let has = |slot: &ItemSlot, name: &str| {
            let item = self.data.items.get(slot.item as usize);
            item.is_some_and(|item| item.texts.iter().any(|text| text.condition == name))
        };
        let for_condition = |name: &str| {
            let slots = self.slots.iter().map(|(slot, _)| *slot).filter(|slot| has(slot, name));
            self.count_handouts(name.to_owned(), slots)
        };
        self.data.plan.conditions.iter().map(|condition| for_condition(&condition.name)).collect()
    }

    fn by_item(&self) -> Vec<HandoutCounts> {
        let mut slots: BTreeMap<u32, Vec<&ItemSlot>> = BTreeMap::new();
        for (slot, _) in &self.slots {
            slots.entry(slot.item).or_default().push(slot);
        }
        let items = self.data.items.iter().filter(|item| !item.is_practice);
        let for_item = |id: u32| self.count_handouts(id.to_string(), slots.get(&id).into_iter().flatten().copied());
        items.map(|item| for_item(item.id)).collect()
    }
}

impl AttentionSummary {
    fn new(data: &StudyData, names: &ParticipantNames<'_>) -> Self {
        let most_failed = data.settings.tolerated_failed_checks();
        let failed = |person: &Participant| {
            let checks: Vec<u32> =
                person.attention.iter().filter(|check| !check.passed).map(|check| check.number + 1).collect();
            (!checks.is_empty()).then(|| FailedChecks {
                participant: names.name_for_id(&person.id).to_owned(),
                answered: person.attention.len(),
                is_over: checks.len() > most_failed,
                checks,
            })
        };
        let mut by_participant: Vec<FailedChecks> = data.participants.iter().filter_map(failed).collect();
        by_participant.sort_by(|a, b| a.participant.cmp(&b.participant));
        Self {
            per_participant: data.settings.attention_checks,
            most_failed,
            answered: data.participants.iter().map(|person| person.attention.len()).sum(),
            failed: by_participant.iter().map(|one| one.checks.len()).sum(),
            by_participant,
        }
    }
}
