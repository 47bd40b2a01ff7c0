//! Made-up studies.

use crate::{
    AttentionCheck, ConditionKind, ItemSlot, PageTexts, PairChoice, Participant, ParticipantAnswer, ParticipantMove,
    ParticipantStatus, SlotState, StudyCondition, StudyData, StudyDesign, StudyItem, StudyRoute, StudyScene,
    StudySettings, StudyTask, StudyText, StudyViewpoint,
};
use std::collections::BTreeMap;
use wayword_core::{Heading, SceneId, ViewpointId, seed};

/// Unix time at which made-up studies begin, milliseconds.
pub(super) const START_MS: i64 = 1_780_000_000_000;

/// A number below `below` that is drawn by a hash of the words.
pub(super) fn drawn(words: &[&str], below: u64) -> u64 {
    // The low bits of FNV vary too little.
    (seed::derive_seed(7, words).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 33) % below
}

/// A study without items and answers.
pub(super) fn empty(mode: StudyTask, conditions: &[(&str, ConditionKind)]) -> StudyData {
    let condition = |(name, kind): &(&str, ConditionKind)| StudyCondition {
        name: (*name).to_owned(),
        kind: *kind,
        source: format!("runs/{name}#r2r"),
        shows_doubts: false,
    };
    StudyData {
        plan: StudyDesign {
            mode,
            seed: 7,
            per_item: 3,
            per_participant: 6,
            conditions: conditions.iter().map(condition).collect(),
            style: "r2r".to_owned(),
        },
        settings: StudySettings::for_mode(mode, 6),
        texts: PageTexts::default(),
        items: Vec::new(),
        routes: Vec::new(),
        scenes: vec![line()],
        participants: Vec::new(),
        slots: Vec::new(),
        forgotten: 0,
        is_closed: false,
    }
}

pub(super) fn viewpoint(number: usize) -> ViewpointId {
    ViewpointId::new(format!("v{number}")).unwrap()
}

/// Six places in a row, 2 m apart.
fn line() -> StudyScene {
    let place = |at: usize| StudyViewpoint {
        position: [2.0 * at as f64, 0.0, 1.5],
        level: Some(1),
        neighbours: [at.checked_sub(1), (at < 5).then_some(at + 1)].into_iter().flatten().map(viewpoint).collect(),
        bends: BTreeMap::new(),
        panorama: format!("{at}.jpg"),
    };
    let places: BTreeMap<ViewpointId, StudyViewpoint> = (0..6).map(|at| (viewpoint(at), place(at))).collect();
    StudyScene { scene: SceneId::new("house2-1").unwrap(), places }
}

pub(super) fn add_route(data: &mut StudyData) -> u32 {
    let id = data.routes.len() as u32;
    data.routes.push(StudyRoute {
        id,
        name: format!("path-{id}"),
        scene: SceneId::new("house2-1").unwrap(),
        viewpoints: (0..5).map(viewpoint).collect(),
        start_heading: Heading::new(0.0).unwrap(),
        film: Vec::new(),
    });
    id
}

pub(super) fn add_item(data: &mut StudyData, route: u32, conditions: &[usize]) -> u32 {
    let id = data.items.len() as u32;
    let told = |at: &usize| {
        let condition = data.plan.conditions[*at].name.clone();
        StudyText { text: format!("Walk past the sofa by {condition}, and stop."), condition, marks: Vec::new() }
    };
    let texts = conditions.iter().map(told).collect();
    data.items.push(StudyItem { id, route, is_practice: false, texts });
    id
}

pub(super) fn add_person(data: &mut StudyData, status: ParticipantStatus) -> String {
    let number = data.participants.len();
    let id = format!("{:032x}", drawn(&["person", &number.to_string()], u64::MAX));
    let consented_ms = START_MS + 60_000 * number as i64;
    let is_over = status != ParticipantStatus::Started;
    data.participants.push(Participant {
        id: id.clone(),
        status,
        consented_ms,
        consent: "c0ffee".to_owned(),
        finished_ms: is_over.then_some(consented_ms + 600_000 + 1000 * number as i64),
        seen_ms: consented_ms + 600_000,
        misunderstood: u32::from(number.is_multiple_of(5)),
        understood: status != ParticipantStatus::ScreenedOut,
        recruiter_status: None,
        attention: vec![AttentionCheck {
            number: 0,
            passed: status != ParticipantStatus::AttentionFailed,
            at_ms: consented_ms + 60_000,
        }],
        expected: 6,
        end: Vec::new(),
    });
    id
}

/// A slot that was answered, or one without an answer, at the next position of the participant.
pub(super) fn add_slot(data: &mut StudyData, person: &str, item: u32, answer: Option<ParticipantAnswer>) {
    let position =
        data.slots.iter().filter(|slot| slot.participant == person && slot.position.is_some()).count() as u32;
    let consented_ms = data.participants.iter().find(|one| one.id == person).map_or(START_MS, |one| one.consented_ms);
    let given_ms = consented_ms + 30_000 + 40_000 * i64::from(position);
    let last = match &answer {
        Some(ParticipantAnswer::Follow { looks, .. }) => 3 + (*looks as usize % 2),
        _ => 0,
    };
    data.slots.push(ItemSlot {
        participant: person.to_owned(),
        item,
        position: Some(position),
        state: if answer.is_some() { SlotState::Answered } else { SlotState::Returned },
        given_ms,
        answered_ms: answer.is_some().then_some(given_ms + 25_000),
        is_turned: drawn(&["turned", person, &item.to_string()], 2) == 1,
        own_text: matches!(answer, Some(ParticipantAnswer::Rate { .. }))
            .then(|| "Go through the door, then stop.".to_owned()),
        answer,
        pictures_seen: None,
        moves: (1..=last)
            .map(|at| ParticipantMove { viewpoint: viewpoint(at), at_ms: given_ms + 2000 * at as i64 })
            .collect(),
    });
}

fn level(words: &[&str], better: u64) -> u8 {
    (1 + (drawn(words, 5) + better).min(4)) as u8
}

/// A small study of three conditions, four routes and eight people, some of whom did not finish.
pub(super) fn small(mode: StudyTask) -> StudyData {
    let conditions =
        [("ours", ConditionKind::Run), ("humans", ConditionKind::People), ("wrong", ConditionKind::OtherPath)];
    let mut data = empty(mode, &conditions);
    let shown: &[&[usize]] = if mode == StudyTask::Pair { &[&[0, 1], &[0, 2], &[1, 2]] } else { &[&[0], &[1], &[2]] };
    let mut items = Vec::new();
    for _ in 0..4 {
        let route = add_route(&mut data);
        items.extend(shown.iter().map(|conditions| add_item(&mut data, route, conditions)));
    }
    let statuses = [
        ParticipantStatus::Complete,
        ParticipantStatus::Complete,
        ParticipantStatus::AttentionFailed,
        ParticipantStatus::Complete,
        ParticipantStatus::Started,
        ParticipantStatus::Withdrawn,
        ParticipantStatus::ScreenedOut,
        ParticipantStatus::Complete,
    ];
    for (number, status) in statuses.into_iter().enumerate() {
        let person = add_person(&mut data, status);
        let answered = match status {
            ParticipantStatus::Started => 4,
            ParticipantStatus::Withdrawn => 2,
            ParticipantStatus::ScreenedOut => 0,
            _ => 6,
        };
        for at in 0..answered {
            let item = items[(number + 2 * at) % items.len()];
            let answer = answer(&data, &person, item);
            add_slot(&mut data, &person, item, Some(answer));
        }
        if matches!(status, ParticipantStatus::Started | ParticipantStatus::Withdrawn) {
            add_slot(&mut data, &person, items[(number + 2 * answered) % items.len()], None);
        }
    }
    data.forgotten = 1;
    data
}

fn answer(data: &StudyData, person: &str, item: u32) -> ParticipantAnswer {
    let told = &data.items[item as usize].texts[0];
    let better = if told.condition == "humans" { 2 } else { u64::from(told.condition == "ours") };
    let name = item.to_string();
    let of = |question: &str| level(&["level", person, &name, question], better);
    match data.plan.mode {
        StudyTask::Follow => ParticipantAnswer::Follow {
            statements: ["0", "1", "2"].map(of),
            looks: drawn(&["looks", person, &name], 9) as u32,
            stopped_ms: data.participants.iter().find(|one| one.id == person).map_or(0, |one| one.consented_ms)
                + 300_000,
            window: None,
        },
        StudyTask::Rate => ParticipantAnswer::Rate { ratings: ["0", "1", "2", "3"].map(of) },
        StudyTask::Pair => {
            let choices =
                [PairChoice::A, PairChoice::A, PairChoice::B, PairChoice::B, PairChoice::Tie, PairChoice::Bad];
            ParticipantAnswer::Pair { choice: choices[drawn(&["choice", person, &name], 6) as usize] }
        }
    }
}

/// The study of arXiv 2403.11487: 30 people rate one text each.
pub(super) fn of_the_paper() -> StudyData {
    let mut data = empty(StudyTask::Rate, &[("navcomposer", ConditionKind::Run)]);
    for number in 0..30usize {
        let route = add_route(&mut data);
        let item = add_item(&mut data, route, &[0]);
        let person = add_person(&mut data, ParticipantStatus::Complete);
        let level = |count: usize, yes: u8, no: u8| if number < count { yes } else { no };
        let ratings = [level(13, 2, 3), level(25, 4, 3), level(5, 2, 1), level(22, 5, 2)];
        add_slot(&mut data, &person, item, Some(ParticipantAnswer::Rate { ratings }));
    }
    data
}
