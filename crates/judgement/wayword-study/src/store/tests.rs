//! Tests of the store. They set the time themselves.

use super::*;
use crate::study::{
    Answer, Choice, Condition, Item, Kind, Mode, Place, Plan, Question, Route, Scene, Settings, Status, Told,
};
use std::collections::BTreeMap;
use tempfile::TempDir;
use wayword_core::{Heading, SceneId, ViewpointId};

const HASH: &str = "consent";

/// A study in a temporary folder, and a clock that the test sets.
struct Desk {
    folder: TempDir,
    study: Study,
    now_ms: i64,
}

fn viewpoint(name: &str) -> ViewpointId {
    ViewpointId::new(name).unwrap()
}

/// Three places in a row.
fn scene() -> Scene {
    let place = |at: f64, neighbours: &[&str]| Place {
        position: [at, 0.0, 1.5],
        level: None,
        neighbours: neighbours.iter().map(|name| viewpoint(name)).collect(),
        panorama: format!("{at}.jpg"),
    };
    let places = [("a", place(0.0, &["b"])), ("b", place(2.0, &["a", "c"])), ("c", place(4.0, &["b"]))];
    Scene { scene: SceneId::new("s").unwrap(), places: places.map(|(name, place)| (viewpoint(name), place)).into() }
}

/// `routes` routes with two conditions each, and one more for practice.
fn study(mode: Mode, routes: u32, per_item: u32, per_participant: u32) -> Desk {
    let folder = tempfile::tempdir().unwrap();
    let route = |id| Route {
        id,
        name: format!("s/{id}"),
        scene: SceneId::new("s").unwrap(),
        viewpoints: ["a", "b", "c"].map(viewpoint).to_vec(),
        start_heading: Heading::NORTH,
        film: Vec::new(),
    };
    let told = |name: &str| Told { condition: name.to_owned(), text: "Go on.".to_owned(), ..Told::default() };
    let mut items: Vec<Item> = (0..routes)
        .flat_map(|route| match mode {
            Mode::Pair => vec![(route, vec![told("x"), told("y")])],
            _ => vec![(route, vec![told("x")]), (route, vec![told("y")])],
        })
        .zip(0..)
        .map(|((route, texts), id)| Item { id, route, is_practice: false, texts })
        .collect();
    let id = u32::try_from(items.len()).unwrap();
    items.push(Item { id, route: routes, is_practice: true, texts: vec![told("x")] });
    let condition =
        |name: &str| Condition { name: name.to_owned(), kind: Kind::Run, source: String::new(), shows_doubts: false };
    let plan = Plan {
        mode,
        seed: 0,
        per_item,
        per_participant,
        conditions: vec![condition("x"), condition("y")],
        style: String::new(),
    };
    let settings = Settings {
        attention_checks: 0,
        questions: Vec::new(),
        lease_s: 60,
        ..Settings::of_mode(mode, per_participant)
    };
    let routes = (0..=routes).map(route).collect();
    let study = Study { folder: folder.path().to_owned(), plan, settings, items, routes, scenes: vec![scene()] };
    study.create().unwrap();
    Desk { folder, study, now_ms: 1_000_000 }
}

impl Desk {
    fn ask<T>(&self, work: impl FnOnce(&Book<'_>) -> Result<T, StudyError>) -> T {
        Store::open(&self.folder.path().join("study.db")).unwrap().write(&self.study, self.now_ms, work).unwrap()
    }

    /// Lets a new participant with a link consent.
    fn newcomer(&self) -> i64 {
        let token = self.ask(|book| book.invite(1)).tokens.remove(0);
        self.come(&Arrival::Link(token)).unwrap()
    }

    fn come(&self, arrival: &Arrival) -> Result<i64, Entry> {
        match self.ask(|book| book.consent(arrival, HASH)) {
            Entry::Back(session) => Ok(self.ask(|book| book.whose(&session)).unwrap().0),
            entry => Err(entry),
        }
    }

    fn stage(&self, person: i64) -> Stage {
        self.ask(|book| book.stage(person))
    }

    fn held(&self, person: i64) -> Held {
        match self.stage(person) {
            Stage::Item(held) => held,
            stage => panic!("{stage:?}"),
        }
    }

    fn give(&self, person: i64, given: Given) -> Result<(), Refusal> {
        self.ask(|book| book.give(person, given))
    }

    /// Answers the item that the person has.
    fn answer(&self, person: i64) -> Held {
        let held = self.held(person);
        let slot = held.slot.clone();
        let given = match self.study.plan.mode {
            Mode::Pair => Given::Chosen { slot, choice: Choice::Tie },
            Mode::Rate => {
                self.give(person, Given::OwnText { slot: slot.clone(), text: "mine".into() }).unwrap();
                Given::Rated { slot, ratings: [1, 2, 3, 4] }
            }
            Mode::Follow => {
                self.give(person, Given::Stop { slot: slot.clone(), seq: held.moves.len(), looks: 2 }).unwrap();
                Given::Followed { slot, statements: [1, 2, 3] }
            }
        };
        self.give(person, given).unwrap();
        held
    }

    fn data(&self) -> crate::study::Data {
        self.study.clone().data().unwrap()
    }

    /// Answers of each item that is not for practice.
    fn answered(&self) -> Vec<u32> {
        let mut answered: BTreeMap<u32, u32> = BTreeMap::new();
        for item in self.study.items.iter().filter(|item| !item.is_practice) {
            answered.insert(item.id, 0);
        }
        for slot in self.data().slots.iter().filter(|slot| slot.answer.is_some() && slot.position.is_some()) {
            *answered.get_mut(&slot.item).unwrap() += 1;
        }
        answered.into_values().collect()
    }
}

#[test]
fn each_person_practises_and_then_gets_each_route_once() {
    let desk = study(Mode::Pair, 4, 3, 3);
    let person = desk.newcomer();
    assert!(desk.answer(person).is_practice);
    let routes: Vec<u32> = (0..3).map(|_| desk.study.items[desk.answer(person).item as usize].route).collect();
    let mut different = routes.clone();
    different.sort_unstable();
    different.dedup();
    assert_eq!(different.len(), 3, "{routes:?}");
    assert_eq!(desk.stage(person), Stage::Over(Outcome { status: Status::Complete, answers: 3 }));
}

#[test]
fn items_fill_evenly_and_never_over() {
    let desk = study(Mode::Pair, 5, 2, 3);
    let mut came = 0;
    loop {
        let token = desk.ask(|book| book.invite(1)).tokens.remove(0);
        let Ok(person) = desk.come(&Arrival::Link(token)) else { break };
        came += 1;
        while matches!(desk.stage(person), Stage::Item(_)) {
            desk.answer(person);
            let answered = desk.answered();
            assert!(answered.iter().max().unwrap() - answered.iter().min().unwrap() <= 1, "{answered:?}");
        }
    }
    assert_eq!((desk.answered(), came), (vec![2; 5], 4));
}

#[test]
fn a_condition_that_a_person_had_comes_later() {
    let desk = study(Mode::Rate, 4, 5, 4);
    let person = desk.newcomer();
    desk.answer(person);
    let conditions: Vec<String> =
        (0..4).map(|_| desk.study.items[desk.answer(person).item as usize].texts[0].condition.clone()).collect();
    assert_eq!(conditions.iter().filter(|name| *name == "x").count(), 2, "{conditions:?}");
}

#[test]
fn items_of_absent_participants_go_to_others() {
    let mut desk = study(Mode::Pair, 1, 1, 1);
    let (first, second) = (desk.newcomer(), {
        desk.now_ms += 1;
        let token = desk.ask(|book| book.invite(1)).tokens.remove(0);
        Arrival::Link(token)
    });
    desk.answer(first);
    let held = desk.held(first);
    assert_eq!(desk.come(&second), Err(Entry::Full));
    desk.now_ms += 61_000;
    let second = desk.come(&second).unwrap();
    desk.answer(second);
    let taken = desk.held(second);
    assert_eq!(taken.item, held.item);
    // The first participant comes back: the item belongs to another one now, and none is left.
    assert_eq!(desk.stage(first), Stage::Over(Outcome { status: Status::Complete, answers: 0 }));
    assert_eq!(desk.give(first, Given::Chosen { slot: held.slot, choice: Choice::A }), Err(Refusal::Returned));
    desk.answer(second);
    assert_eq!(desk.answered(), [1]);
}

#[test]
fn a_late_participant_goes_on_if_the_item_is_still_free() {
    let mut desk = study(Mode::Pair, 2, 1, 2);
    let person = desk.newcomer();
    desk.answer(person);
    let held = desk.held(person);
    desk.now_ms += 3_600_000;
    assert_eq!(desk.held(person).slot, held.slot);
    desk.answer(person);
    desk.answer(person);
    assert_eq!(desk.answered(), [1, 1]);
}

#[test]
fn an_answer_counts_once_and_the_first_stands() {
    let desk = study(Mode::Rate, 2, 2, 2);
    let person = desk.newcomer();
    desk.answer(person);
    let slot = desk.held(person).slot;
    let rated = |ratings| Given::Rated { slot: slot.clone(), ratings };
    assert_eq!(desk.give(person, rated([5; 4])), Err(Refusal::OutOfTurn), "one's own text comes first");
    desk.give(person, Given::OwnText { slot: slot.clone(), text: "first".into() }).unwrap();
    desk.give(person, Given::OwnText { slot: slot.clone(), text: "second".into() }).unwrap();
    desk.give(person, rated([5; 4])).unwrap();
    desk.give(person, rated([1; 4])).unwrap();
    let data = desk.data();
    let kept: Vec<_> = data.slots.iter().filter(|slot| slot.position == Some(0)).collect();
    assert_eq!(kept.len(), 1);
    assert_eq!(
        (kept[0].answer.clone(), kept[0].own_text.as_deref()),
        (Some(Answer::Rate { ratings: [5; 4] }), Some("first"))
    );
}

#[test]
fn nobody_answers_for_somebody_else() {
    let desk = study(Mode::Pair, 2, 2, 2);
    let (one, other) = (desk.newcomer(), desk.newcomer());
    let slot = desk.held(one).slot;
    assert_eq!(desk.give(other, Given::Chosen { slot: slot.clone(), choice: Choice::A }), Err(Refusal::Unknown));
    assert_eq!(desk.ask(|book| book.panorama(other, &slot, 0)), None);
    assert_eq!(desk.ask(|book| book.film_picture(other, &slot, 0)), None);
}

#[test]
fn a_walk_goes_by_the_graph_and_each_step_counts_once() {
    let desk = study(Mode::Follow, 1, 1, 1);
    let person = desk.newcomer();
    desk.answer(person);
    let slot = desk.held(person).slot;
    let step = |seq, to| Given::Move { slot: slot.clone(), seq, to };
    assert_eq!(desk.give(person, step(0, 1)), Err(Refusal::Unknown), "there is one way from the start");
    assert_eq!(desk.give(person, step(1, 0)), Err(Refusal::OutOfTurn));
    for given in [step(0, 0), step(0, 0), step(1, 1), step(0, 0)] {
        desk.give(person, given).unwrap();
    }
    assert_eq!(desk.held(person).moves, ["b", "c"].map(viewpoint));
    assert_eq!(desk.ask(|book| book.panorama(person, &slot, 2)).as_deref(), Some("4.jpg"));
    assert_eq!(desk.ask(|book| book.panorama(person, &slot, 3)), None, "no place is seen before one is there");
    let followed = || Given::Followed { slot: slot.clone(), statements: [3; 3] };
    assert_eq!(desk.give(person, followed()), Err(Refusal::OutOfTurn), "one stops first");
    desk.give(person, Given::Stop { slot: slot.clone(), seq: 2, looks: 7 }).unwrap();
    assert_eq!(desk.give(person, step(2, 0)), Err(Refusal::OutOfTurn), "one does not go on after that");
    desk.give(person, followed()).unwrap();
    let data = desk.data();
    let walked = data.slots.iter().find(|slot| slot.position.is_some()).unwrap();
    assert_eq!(walked.moves.len(), 2);
    assert!(matches!(walked.answer, Some(Answer::Follow { statements: [3, 3, 3], looks: 7, .. })));
}

#[test]
fn the_task_is_explained_twice_at_most() {
    let mut desk = study(Mode::Pair, 1, 1, 1);
    desk.study.settings.questions =
        vec![Question { text: "?".into(), answers: vec!["a".into(), "b".into()], right: 1 }];
    let answer = |attempt, right: bool| Given::Understood { attempt, answers: vec![usize::from(right)] };
    let quick = desk.newcomer();
    desk.give(quick, answer(0, false)).unwrap();
    desk.give(quick, answer(0, false)).unwrap();
    assert_eq!(desk.stage(quick), Stage::Understood { attempt: 1 }, "the same try again is no second one");
    desk.give(quick, answer(1, true)).unwrap();
    assert!(matches!(desk.stage(quick), Stage::Item(_)));
    desk.ask(|book| book.withdraw(quick, Withdrawal::Delete));
    let slow = desk.newcomer();
    desk.give(slow, answer(0, false)).unwrap();
    desk.give(slow, answer(1, false)).unwrap();
    assert_eq!(desk.stage(slow), Stage::Over(Outcome { status: Status::ScreenedOut, answers: 0 }));
}

#[test]
fn two_failed_attention_checks_change_the_status() {
    let mut desk = study(Mode::Pair, 4, 2, 4);
    desk.study.settings.attention_checks = 2;
    let attend = |person, is_good: bool| {
        loop {
            match desk.stage(person) {
                Stage::Item(_) => {
                    desk.answer(person);
                }
                Stage::Attention { number, level } => {
                    let choice = if is_good { level } else { level % 5 + 1 };
                    desk.give(person, Given::Attention { number, choice }).unwrap();
                }
                Stage::Over(outcome) => return outcome.status,
                Stage::Understood { .. } => unreachable!(),
            }
        }
    };
    assert_eq!(attend(desk.newcomer(), true), Status::Complete);
    assert_eq!(attend(desk.newcomer(), false), Status::AttentionFailed);
    assert_eq!(desk.data().participants.iter().map(|person| person.attention.len()).collect::<Vec<_>>(), [2, 2]);
}

#[test]
fn an_attention_check_waits_until_it_is_due() {
    let mut desk = study(Mode::Pair, 4, 2, 4);
    desk.study.settings.attention_checks = 2;
    let person = desk.newcomer();
    assert_eq!(desk.give(person, Given::Attention { number: 0, choice: 1 }), Err(Refusal::OutOfTurn));
}

#[test]
fn the_last_answer_ends_the_participation_without_another_request() {
    let desk = study(Mode::Pair, 1, 1, 1);
    let person = desk.newcomer();
    desk.answer(person);
    desk.answer(person);
    assert_eq!(desk.data().participants[0].status, Status::Complete);
}

#[test]
fn an_old_page_does_not_end_a_walk_elsewhere() {
    let desk = study(Mode::Follow, 1, 1, 1);
    let person = desk.newcomer();
    let slot = desk.held(person).slot;
    desk.give(person, Given::Move { slot: slot.clone(), seq: 0, to: 0 }).unwrap();
    assert_eq!(desk.give(person, Given::Stop { slot: slot.clone(), seq: 0, looks: 0 }), Err(Refusal::OutOfTurn));
    desk.give(person, Given::Stop { slot, seq: 1, looks: 0 }).unwrap();
}

#[test]
fn consent_promises_only_the_items_that_are_left() {
    let mut desk = study(Mode::Pair, 3, 1, 2);
    let first = desk.newcomer();
    let second = desk.newcomer();
    assert_eq!([first, second].map(|person| desk.ask(|book| book.done(person)).expected), [2, 1]);
    desk.study.settings.least_items = 2;
    let token = desk.ask(|book| book.invite(1)).tokens.remove(0);
    assert_eq!(desk.come(&Arrival::Link(token)), Err(Entry::Full));
}

#[test]
fn a_personal_link_is_enough_to_be_forgotten() {
    let desk = study(Mode::Pair, 1, 1, 1);
    let token = desk.ask(|book| book.invite(1)).tokens.remove(0);
    desk.come(&Arrival::Link(token.clone())).unwrap();
    assert!(desk.study.forget(&format!("https://study.example.org/t/{token}"), false).unwrap().is_done);
    assert!(desk.data().participants.is_empty());
}

#[test]
fn a_clock_that_is_set_back_keeps_no_item_from_others() {
    let mut desk = study(Mode::Pair, 1, 1, 1);
    let person = desk.newcomer();
    desk.answer(person);
    desk.held(person);
    desk.now_ms -= 500_000;
    let other = desk.newcomer();
    desk.answer(other);
    assert!(matches!(desk.stage(other), Stage::Item(_)));
}

fn recruit(person: &str, session: &str) -> Arrival {
    Arrival::Recruit { person: person.into(), study: "s".into(), session: session.into() }
}

fn by_recruiter() -> Desk {
    let mut desk = study(Mode::Pair, 2, 3, 2);
    desk.study.settings.recruiter = crate::study::Recruiter::Parameters {
        person: "PROLIFIC_PID".into(),
        session: "SESSION_ID".into(),
        study: "STUDY_ID".into(),
        only_study: "s".into(),
    };
    desk
}

#[test]
fn a_recruiters_participant_comes_in_once_and_back_by_the_same_link() {
    let desk = by_recruiter();
    let one = desk.come(&recruit("p1", "x")).unwrap();
    assert_eq!(desk.come(&recruit("p1", "x")), Ok(one));
    assert_eq!(desk.come(&recruit("p1", "y")), Err(Entry::Twice));
    assert_eq!(
        desk.come(&Arrival::Recruit { person: "p2".into(), study: "t".into(), session: "x".into() }),
        Err(Entry::Unknown)
    );
    for wrong in ["", "a b", "<script>", &"a".repeat(129)] {
        assert_eq!(desk.come(&recruit(wrong, "x")), Err(Entry::Unknown), "{wrong}");
    }
    assert_eq!(desk.come(&Arrival::Link(crate::token::token().unwrap())), Err(Entry::Unknown));
}

#[test]
fn reconcile_compares_the_recruiters_list_with_ours() {
    let desk = by_recruiter();
    for name in ["p1", "p2"] {
        let person = desk.come(&recruit(name, "x")).unwrap();
        while name == "p1" && matches!(desk.stage(person), Stage::Item(_)) {
            desk.answer(person);
        }
    }
    let file = desk.folder.path().join("prolific.csv");
    let text = "\u{feff}Submission id,Participant id,Status\n1,p1,AWAITING REVIEW\n2,p2,APPROVED\n3,p3,RETURNED\n";
    std::fs::write(&file, text).unwrap();
    let matched = desk.study.reconcile(&file).unwrap();
    let told: Vec<(&str, bool)> =
        matched.rows.iter().map(|row| (row.recruiter_id.as_str(), row.problem.is_some())).collect();
    assert_eq!(told, [("p2", true), ("p1", false), ("p3", false)]);
    desk.study.close(true).unwrap();
    assert!(desk.study.reconcile(&file).unwrap_err().to_string().contains("first"));
}

#[test]
fn a_closed_study_keeps_no_id_of_a_recruiter() {
    let desk = by_recruiter();
    let person = desk.come(&recruit("5f0000000000000000000001", "x")).unwrap();
    let slot = desk.held(person).slot;
    let live = desk.ask(|book| book.close(false));
    assert_eq!((live, desk.ask(|book| book.is_closed())), (1, false));
    desk.ask(|book| book.close(true));
    assert_eq!(desk.give(person, Given::Chosen { slot, choice: Choice::A }), Err(Refusal::Closed));
    assert_eq!(desk.come(&recruit("p9", "x")), Err(Entry::Closed));
    // Opening and closing it moves what the log holds into the file.
    drop(Store::open(&desk.folder.path().join("study.db")).unwrap());
    let bytes = std::fs::read(desk.folder.path().join("study.db")).unwrap();
    assert!(!bytes.windows(24).any(|window| window == b"5f0000000000000000000001"));
}

#[test]
fn forget_deletes_the_data_and_frees_the_item() {
    let desk = by_recruiter();
    let person = desk.come(&recruit("p1", "x")).unwrap();
    desk.answer(person);
    desk.answer(person);
    let dry = desk.study.forget("p1", true).unwrap();
    assert_eq!((dry.answers, dry.is_done, desk.data().participants.len()), (2, false, 1));
    let gone = desk.study.forget("p1", false).unwrap();
    assert_eq!((gone.participant == dry.participant, gone.is_done), (true, true));
    let data = desk.data();
    assert_eq!((data.participants.len(), data.slots.len(), data.forgotten), (0, 0, 1));
    assert!(desk.study.forget("p1", false).is_err());
    assert!(desk.come(&recruit("p1", "x")).is_ok(), "somebody who was forgotten is a stranger");
}

#[test]
fn withdraw_keeps_or_deletes_answers_as_chosen() {
    let desk = study(Mode::Pair, 4, 1, 2);
    let (keeps, deletes) = (desk.newcomer(), desk.newcomer());
    for person in [keeps, deletes] {
        desk.answer(person);
        desk.answer(person);
        desk.held(person);
    }
    desk.ask(|book| book.withdraw(keeps, Withdrawal::Keep));
    desk.ask(|book| book.withdraw(deletes, Withdrawal::Delete));
    let data = desk.data();
    assert_eq!(data.participants.iter().map(|person| person.status).collect::<Vec<_>>(), [Status::Withdrawn]);
    assert_eq!(desk.answered().iter().sum::<u32>(), 1);
    assert_eq!(desk.stage(keeps), Stage::Over(Outcome { status: Status::Withdrawn, answers: 1 }));
}

#[test]
fn a_session_ends_after_a_week_and_the_link_leads_back() {
    let mut desk = by_recruiter();
    let arrival = recruit("p1", "x");
    let Entry::Back(session) = desk.ask(|book| book.consent(&arrival, HASH)) else { panic!() };
    assert!(desk.ask(|book| book.whose(&session)).is_some());
    desk.now_ms += 7 * 24 * 3600 * 1000;
    assert_eq!(desk.ask(|book| book.whose(&session)), None);
    assert!(matches!(desk.ask(|book| book.enter(&arrival)), Entry::Back(_)));
}

#[test]
fn a_later_database_is_not_touched() {
    let desk = study(Mode::Pair, 1, 1, 1);
    let file = desk.folder.path().join("study.db");
    rusqlite::Connection::open(&file).unwrap().pragma_update(None, "user_version", 99).unwrap();
    assert!(Store::open(&file).unwrap_err().to_string().contains("later version"));
}
