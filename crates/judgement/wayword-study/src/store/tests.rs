//! Tests of the store. They set the time themselves.

use super::*;
use crate::study::{
    ComprehensionQuestion, ConditionKind, EndAnswer, EndQuestion, EndQuestionKind, FilmPicture, PageTexts, PairChoice,
    ParticipantAnswer, ParticipantStatus, StudyCondition, StudyDesign, StudyItem, StudyRoute, StudyScene,
    StudySettings, StudyTask, StudyText, StudyViewpoint,
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
fn scene() -> StudyScene {
    let place = |at: f64, neighbours: &[&str]| StudyViewpoint {
        position: [at, 0.0, 1.5],
        level: None,
        neighbours: neighbours.iter().map(|name| viewpoint(name)).collect(),
        bends: BTreeMap::new(),
        panorama: format!("{at}.jpg"),
    };
    let places = [("a", place(0.0, &["b"])), ("b", place(2.0, &["a", "c"])), ("c", place(4.0, &["b"]))];
    StudyScene {
        scene: SceneId::new("s").unwrap(),
        places: places.map(|(name, place)| (viewpoint(name), place)).into(),
    }
}

/// `routes` routes with two conditions each, and one more for practice.
fn study(mode: StudyTask, routes: u32, per_item: u32, per_participant: u32) -> Desk {
    let folder = tempfile::tempdir().unwrap();
    let route = |id| StudyRoute {
        id,
        name: format!("s/{id}"),
        scene: SceneId::new("s").unwrap(),
        viewpoints: ["a", "b", "c"].map(viewpoint).to_vec(),
        start_heading: Heading::NORTH,
        film: Vec::new(),
    };
    let told = |name: &str, route: u32| StudyText {
        condition: name.to_owned(),
        text: format!("Text {name} of route {route}."),
        ..StudyText::default()
    };
    let mut items: Vec<StudyItem> = (0..routes)
        .flat_map(|route| match mode {
            StudyTask::Pair => vec![(route, vec![told("x", route), told("y", route)])],
            _ => vec![(route, vec![told("x", route)]), (route, vec![told("y", route)])],
        })
        .zip(0..)
        .map(|((route, texts), id)| StudyItem { id, route, is_practice: false, texts })
        .collect();
    let id = u32::try_from(items.len()).unwrap();
    items.push(StudyItem { id, route: routes, is_practice: true, texts: vec![told("x", routes)] });
    let condition = |name: &str| StudyCondition {
        name: name.to_owned(),
        kind: ConditionKind::Run,
        source: String::new(),
        shows_doubts: false,
    };
    let plan = StudyDesign {
        mode,
        seed: 0,
        per_item,
        per_participant,
        conditions: vec![condition("x"), condition("y")],
        style: String::new(),
    };
    let settings = StudySettings {
        attention_checks: 0,
        questions: Vec::new(),
        lease_s: 60,
        ..StudySettings::for_mode(mode, per_participant)
    };
    let routes = (0..=routes).map(route).collect();
    let study = Study {
        folder: folder.path().to_owned(),
        plan,
        settings,
        texts: PageTexts::default(),
        items,
        routes,
        scenes: vec![scene()],
    };
    study.create().unwrap();
    Desk { folder, study, now_ms: 1_000_000 }
}

impl Desk {
    fn ask<T>(&self, work: impl FnOnce(&StudyTransaction<'_>) -> Result<T, StudyError>) -> T {
        StudyStore::open(&self.folder.path().join("study.db"))
            .unwrap()
            .write_transaction(&self.study, self.now_ms, work)
            .unwrap()
    }

    /// Lets a new participant with a link consent.
    fn newcomer(&self) -> i64 {
        let token = self.ask(|book| book.invite_participants(1)).tokens.remove(0);
        self.come(&ParticipantArrival::Link(token)).unwrap()
    }

    fn come(&self, arrival: &ParticipantArrival) -> Result<i64, ArrivalOutcome> {
        match self.ask(|book| book.record_consent(arrival, HASH)) {
            ArrivalOutcome::Back(session) => Ok(self.ask(|book| book.person_by_session(&session)).unwrap().0),
            entry => Err(entry),
        }
    }

    fn stage(&self, person: i64) -> ParticipantStage {
        self.ask(|book| book.current_stage(person))
    }

    fn held(&self, person: i64) -> StoredSlot {
        match self.stage(person) {
            ParticipantStage::Item(held) => held,
            stage => panic!("{stage:?}"),
        }
    }

    fn give(&self, person: i64, given: ParticipantInput) -> Result<(), InputRefusal> {
        self.ask(|book| book.store_input(person, given))
    }

    /// Answers the item that the person has.
    fn answer(&self, person: i64) -> StoredSlot {
        let held = self.held(person);
        let slot = held.slot.clone();
        let given = match self.study.plan.mode {
            StudyTask::Pair => ParticipantInput::Chosen { slot, choice: PairChoice::Tie, pictures: None },
            StudyTask::Rate => {
                self.give(
                    person,
                    ParticipantInput::OwnText { slot: slot.clone(), text: "mine".into(), pictures: None },
                )
                .unwrap();
                ParticipantInput::Rated { slot, ratings: [1, 2, 3, 4], pictures: None }
            }
            StudyTask::Follow => {
                self.give(person, ParticipantInput::Stop { slot: slot.clone(), seq: held.moves.len(), looks: 2 })
                    .unwrap();
                ParticipantInput::Followed { slot, statements: [1, 2, 3], window: None }
            }
        };
        self.give(person, given).unwrap();
        held
    }

    /// Answers all items that are left.
    fn answer_all(&self, person: i64) {
        while let ParticipantStage::Item(_) = self.stage(person) {
            self.answer(person);
        }
    }

    fn data(&self) -> crate::study::StudyData {
        self.study.clone().into_data().unwrap()
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
    let desk = study(StudyTask::Pair, 4, 3, 3);
    let person = desk.newcomer();
    assert!(desk.answer(person).is_practice);
    let routes: Vec<u32> = (0..3).map(|_| desk.study.items[desk.answer(person).item as usize].route).collect();
    let mut different = routes.clone();
    different.sort_unstable();
    different.dedup();
    assert_eq!(different.len(), 3, "{routes:?}");
    assert_eq!(
        desk.stage(person),
        ParticipantStage::Over(ParticipationOutcome { status: ParticipantStatus::Complete, answers: 3 })
    );
}

#[test]
fn items_fill_evenly_and_never_over() {
    let desk = study(StudyTask::Pair, 5, 2, 3);
    let mut came = 0;
    loop {
        let token = desk.ask(|book| book.invite_participants(1)).tokens.remove(0);
        let Ok(person) = desk.come(&ParticipantArrival::Link(token)) else { break };
        came += 1;
        while matches!(desk.stage(person), ParticipantStage::Item(_)) {
            desk.answer(person);
            let answered = desk.answered();
            assert!(answered.iter().max().unwrap() - answered.iter().min().unwrap() <= 1, "{answered:?}");
        }
    }
    assert_eq!((desk.answered(), came), (vec![2; 5], 4));
}

#[test]
fn a_condition_that_a_person_had_comes_later() {
    let desk = study(StudyTask::Rate, 4, 5, 4);
    let person = desk.newcomer();
    desk.answer(person);
    let conditions: Vec<String> =
        (0..4).map(|_| desk.study.items[desk.answer(person).item as usize].texts[0].condition.clone()).collect();
    assert_eq!(conditions.iter().filter(|name| *name == "x").count(), 2, "{conditions:?}");
}

#[test]
fn nobody_gets_a_text_twice_and_every_item_is_filled() {
    for (routes, per_item, per_participant) in [(4, 2, 4), (3, 1, 3), (2, 2, 2), (6, 3, 4)] {
        let mut desk = study(StudyTask::Rate, routes, per_item, per_participant);
        // The second text of each route is the first one of the next route, as with texts of other paths, with other white space.
        let own: Vec<String> =
            desk.study.items.iter().step_by(2).map(|item| item.texts[0].text.replace(' ', "  ")).collect();
        for item in desk.study.items.iter_mut().filter(|item| item.texts[0].condition == "y") {
            item.texts[0].text = own[(item.route + 1) as usize % routes as usize].clone();
        }
        let mut people = 0;
        loop {
            let token = desk.ask(|book| book.invite_participants(1)).tokens.remove(0);
            let Ok(person) = desk.come(&ParticipantArrival::Link(token)) else { break };
            people += 1;
            let (mut texts, mut expected) = (Vec::new(), 0);
            while let ParticipantStage::Item(_) = desk.stage(person) {
                expected = desk.ask(|book| book.answer_progress(person)).expected;
                let item = &desk.study.items[desk.answer(person).item as usize];
                texts.push(item.texts[0].text.split_whitespace().collect::<Vec<_>>().join(" "));
            }
            let different: std::collections::BTreeSet<&String> = texts.iter().collect();
            assert_eq!(different.len(), texts.len(), "{routes} routes: {texts:?}");
            assert!(texts.len() > 1 && texts.len() <= 1 + expected as usize, "{texts:?}");
        }
        assert_eq!(desk.answered(), vec![per_item; 2 * routes as usize], "{routes} routes, {people} people");
    }
}

#[test]
fn a_text_that_practice_showed_comes_never_again_and_nobody_waits_for_it() {
    let mut desk = study(StudyTask::Rate, 2, 1, 2);
    // A study of an earlier version lent the text of practice to both routes.
    let practice = desk.study.items.iter().find(|item| item.is_practice).unwrap().texts[0].text.clone();
    for item in desk.study.items.iter_mut().filter(|item| item.texts[0].condition == "y") {
        item.texts[0].text.clone_from(&practice);
    }
    let person = desk.newcomer();
    desk.answer_all(person);
    assert_eq!(desk.answered(), [1, 0, 1, 0]);
    let token = desk.ask(|book| book.invite_participants(1)).tokens.remove(0);
    assert_eq!(desk.come(&ParticipantArrival::Link(token)), Err(ArrivalOutcome::Full));
}

#[test]
fn a_closed_study_makes_no_links() {
    let desk = study(StudyTask::Pair, 1, 1, 1);
    assert_eq!(desk.study.invite_participants(2).unwrap().unused_before, 0);
    assert_eq!(desk.study.invite_participants(1).unwrap().unused_before, 2);
    assert!(!desk.study.is_closed().unwrap());
    desk.study.close(false).unwrap();
    assert!(desk.study.is_closed().unwrap());
    for refused in [desk.study.invite_participants(1).unwrap_err(), desk.study.check_invitation(1).unwrap_err()] {
        assert!(refused.to_string().contains("is closed: it takes no more answers"), "{refused}");
    }
    assert_eq!(desk.study.read_progress().unwrap().unused_links, 3, "none was made");
}

#[test]
fn items_of_absent_participants_go_to_others() {
    let mut desk = study(StudyTask::Pair, 1, 1, 1);
    let (first, second) = (desk.newcomer(), {
        desk.now_ms += 1;
        let token = desk.ask(|book| book.invite_participants(1)).tokens.remove(0);
        ParticipantArrival::Link(token)
    });
    desk.answer(first);
    let held = desk.held(first);
    assert_eq!(desk.come(&second), Err(ArrivalOutcome::Full));
    desk.now_ms += 61_000;
    let second = desk.come(&second).unwrap();
    desk.answer(second);
    let taken = desk.held(second);
    assert_eq!(taken.item, held.item);
    // The first participant comes back: the item belongs to another one now, and none is left.
    assert_eq!(
        desk.stage(first),
        ParticipantStage::Over(ParticipationOutcome { status: ParticipantStatus::Complete, answers: 0 })
    );
    assert_eq!(
        desk.give(first, ParticipantInput::Chosen { slot: held.slot, choice: PairChoice::A, pictures: None }),
        Err(InputRefusal::Returned)
    );
    desk.answer(second);
    assert_eq!(desk.answered(), [1]);
}

#[test]
fn a_late_participant_goes_on_if_the_item_is_still_free() {
    let mut desk = study(StudyTask::Pair, 2, 1, 2);
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
    let desk = study(StudyTask::Rate, 2, 2, 2);
    let person = desk.newcomer();
    desk.answer(person);
    let slot = desk.held(person).slot;
    let rated = |ratings| ParticipantInput::Rated { slot: slot.clone(), ratings, pictures: None };
    assert_eq!(desk.give(person, rated([5; 4])), Err(InputRefusal::OutOfTurn), "one's own text comes first");
    desk.give(person, ParticipantInput::OwnText { slot: slot.clone(), text: "first".into(), pictures: None }).unwrap();
    desk.give(person, ParticipantInput::OwnText { slot: slot.clone(), text: "second".into(), pictures: None }).unwrap();
    desk.give(person, rated([5; 4])).unwrap();
    desk.give(person, rated([1; 4])).unwrap();
    let data = desk.data();
    let kept: Vec<_> = data.slots.iter().filter(|slot| slot.position == Some(0)).collect();
    assert_eq!(kept.len(), 1);
    assert_eq!(
        (kept[0].answer.clone(), kept[0].own_text.as_deref()),
        (Some(ParticipantAnswer::Rate { ratings: [5; 4] }), Some("first"))
    );
}

#[test]
fn nobody_answers_for_somebody_else() {
    let desk = study(StudyTask::Pair, 2, 2, 2);
    let (one, other) = (desk.newcomer(), desk.newcomer());
    let slot = desk.held(one).slot;
    assert_eq!(
        desk.give(other, ParticipantInput::Chosen { slot: slot.clone(), choice: PairChoice::A, pictures: None }),
        Err(InputRefusal::Unknown)
    );
    assert_eq!(desk.ask(|book| book.panorama_file(other, &slot, 0)), None);
    assert_eq!(desk.ask(|book| book.film_picture(other, &slot, 0)), None);
}

#[test]
fn a_walk_goes_by_the_graph_and_each_step_counts_once() {
    let desk = study(StudyTask::Follow, 1, 1, 1);
    let person = desk.newcomer();
    desk.answer(person);
    let slot = desk.held(person).slot;
    let step = |seq, to| ParticipantInput::Move { slot: slot.clone(), seq, to };
    assert_eq!(desk.give(person, step(0, 1)), Err(InputRefusal::Unknown), "there is one way from the start");
    assert_eq!(desk.give(person, step(1, 0)), Err(InputRefusal::OutOfTurn));
    for given in [step(0, 0), step(0, 0), step(1, 1), step(0, 0)] {
        desk.give(person, given).unwrap();
    }
    assert_eq!(desk.held(person).moves, ["b", "c"].map(viewpoint));
    assert_eq!(desk.ask(|book| book.panorama_file(person, &slot, 2)).as_deref(), Some("4.jpg"));
    assert_eq!(desk.ask(|book| book.panorama_file(person, &slot, 3)), None, "no place is seen before one is there");
    let followed = || ParticipantInput::Followed { slot: slot.clone(), statements: [3; 3], window: None };
    assert_eq!(desk.give(person, followed()), Err(InputRefusal::OutOfTurn), "one stops first");
    desk.give(person, ParticipantInput::Stop { slot: slot.clone(), seq: 2, looks: 7 }).unwrap();
    assert_eq!(desk.give(person, step(2, 0)), Err(InputRefusal::OutOfTurn), "one does not go on after that");
    desk.give(person, followed()).unwrap();
    let data = desk.data();
    let walked = data.slots.iter().find(|slot| slot.position.is_some()).unwrap();
    assert_eq!(walked.moves.len(), 2);
    assert!(matches!(walked.answer, Some(ParticipantAnswer::Follow { statements: [3, 3, 3], looks: 7, .. })));
}

#[test]
fn the_task_is_explained_twice_at_most() {
    let mut desk = study(StudyTask::Pair, 1, 1, 1);
    desk.study.settings.questions =
        vec![ComprehensionQuestion { text: "?".into(), answers: vec!["a".into(), "b".into()], right: 1 }];
    let answer = |attempt, right: bool| ParticipantInput::Understood { attempt, answers: vec![usize::from(right)] };
    let quick = desk.newcomer();
    desk.give(quick, answer(0, false)).unwrap();
    desk.give(quick, answer(0, false)).unwrap();
    assert_eq!(desk.stage(quick), ParticipantStage::Understood { attempt: 1 }, "the same try again is no second one");
    desk.give(quick, answer(1, true)).unwrap();
    assert!(matches!(desk.stage(quick), ParticipantStage::Item(_)));
    desk.ask(|book| book.withdraw_person(quick, WithdrawalChoice::Delete));
    let slow = desk.newcomer();
    desk.give(slow, answer(0, false)).unwrap();
    desk.give(slow, answer(1, false)).unwrap();
    assert_eq!(
        desk.stage(slow),
        ParticipantStage::Over(ParticipationOutcome { status: ParticipantStatus::ScreenedOut, answers: 0 })
    );
}

#[test]
fn two_failed_attention_checks_change_the_status() {
    let mut desk = study(StudyTask::Pair, 4, 2, 4);
    desk.study.settings.attention_checks = 2;
    let attend = |person, is_good: bool| {
        loop {
            match desk.stage(person) {
                ParticipantStage::End => panic!("there are no questions at the end"),
                ParticipantStage::Item(_) => {
                    desk.answer(person);
                }
                ParticipantStage::Attention { number, level } => {
                    let choice = if is_good { level } else { level % 5 + 1 };
                    desk.give(person, ParticipantInput::Attention { number, choice }).unwrap();
                }
                ParticipantStage::Over(outcome) => return outcome.status,
                ParticipantStage::Understood { .. } => unreachable!(),
            }
        }
    };
    assert_eq!(attend(desk.newcomer(), true), ParticipantStatus::Complete);
    assert_eq!(attend(desk.newcomer(), false), ParticipantStatus::AttentionFailed);
    assert_eq!(desk.data().participants.iter().map(|person| person.attention.len()).collect::<Vec<_>>(), [2, 2]);
}

#[test]
fn an_attention_check_waits_until_it_is_due() {
    let mut desk = study(StudyTask::Pair, 4, 2, 4);
    desk.study.settings.attention_checks = 2;
    let person = desk.newcomer();
    assert_eq!(desk.give(person, ParticipantInput::Attention { number: 0, choice: 1 }), Err(InputRefusal::OutOfTurn));
}

#[test]
fn the_last_answer_ends_the_participation_without_another_request() {
    let desk = study(StudyTask::Pair, 1, 1, 1);
    let person = desk.newcomer();
    desk.answer(person);
    desk.answer(person);
    assert_eq!(desk.data().participants[0].status, ParticipantStatus::Complete);
}

#[test]
fn an_old_page_does_not_end_a_walk_elsewhere() {
    let desk = study(StudyTask::Follow, 1, 1, 1);
    let person = desk.newcomer();
    let slot = desk.held(person).slot;
    desk.give(person, ParticipantInput::Move { slot: slot.clone(), seq: 0, to: 0 }).unwrap();
    assert_eq!(
        desk.give(person, ParticipantInput::Stop { slot: slot.clone(), seq: 0, looks: 0 }),
        Err(InputRefusal::OutOfTurn)
    );
    desk.give(person, ParticipantInput::Stop { slot, seq: 1, looks: 0 }).unwrap();
}

#[test]
fn consent_promises_only_the_items_that_are_left() {
    let mut desk = study(StudyTask::Pair, 3, 1, 2);
    let first = desk.newcomer();
    let second = desk.newcomer();
    assert_eq!([first, second].map(|person| desk.ask(|book| book.answer_progress(person)).expected), [2, 1]);
    desk.study.settings.least_items = 2;
    let token = desk.ask(|book| book.invite_participants(1)).tokens.remove(0);
    assert_eq!(desk.come(&ParticipantArrival::Link(token)), Err(ArrivalOutcome::Full));
}

#[test]
fn a_personal_link_is_enough_to_be_forgotten() {
    let desk = study(StudyTask::Pair, 1, 1, 1);
    let token = desk.ask(|book| book.invite_participants(1)).tokens.remove(0);
    desk.come(&ParticipantArrival::Link(token.clone())).unwrap();
    assert!(desk.study.forget_participant(&format!("https://study.example.org/t/{token}"), false).unwrap().is_done);
    assert!(desk.data().participants.is_empty());
}

#[test]
fn a_clock_that_is_set_back_keeps_no_item_from_others() {
    let mut desk = study(StudyTask::Pair, 1, 1, 1);
    let person = desk.newcomer();
    desk.answer(person);
    desk.held(person);
    desk.now_ms -= 500_000;
    let other = desk.newcomer();
    desk.answer(other);
    assert!(matches!(desk.stage(other), ParticipantStage::Item(_)));
}

fn recruit(person: &str, session: &str) -> ParticipantArrival {
    ParticipantArrival::Recruit { person: person.into(), study: "s".into(), session: session.into() }
}

fn by_recruiter() -> Desk {
    let mut desk = study(StudyTask::Pair, 2, 3, 2);
    desk.study.settings.recruiter = crate::study::RecruiterSettings::Parameters {
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
    assert_eq!(desk.come(&recruit("p1", "y")), Err(ArrivalOutcome::Twice));
    assert_eq!(
        desk.come(&ParticipantArrival::Recruit { person: "p2".into(), study: "t".into(), session: "x".into() }),
        Err(ArrivalOutcome::Unknown)
    );
    for wrong in ["", "a b", "<script>", &"a".repeat(129)] {
        assert_eq!(desk.come(&recruit(wrong, "x")), Err(ArrivalOutcome::Unknown), "{wrong}");
    }
    assert_eq!(
        desk.come(&ParticipantArrival::Link(crate::token::random_token().unwrap())),
        Err(ArrivalOutcome::Unknown)
    );
}

#[test]
fn reconcile_compares_the_recruiters_list_with_ours() {
    let desk = by_recruiter();
    for name in ["p1", "p2"] {
        let person = desk.come(&recruit(name, "x")).unwrap();
        while name == "p1" && matches!(desk.stage(person), ParticipantStage::Item(_)) {
            desk.answer(person);
        }
    }
    let file = desk.folder.path().join("prolific.csv");
    let text = "\u{feff}Submission id,Participant id,Status\n1,p1,AWAITING REVIEW\n2,p2,APPROVED\n3,p3,RETURNED\n";
    std::fs::write(&file, text).unwrap();
    let matched = desk.study.reconcile_recruiter_list(&file).unwrap();
    let told: Vec<(&str, bool)> =
        matched.rows.iter().map(|row| (row.recruiter_id.as_str(), row.problem.is_some())).collect();
    assert_eq!(told, [("p2", true), ("p1", false), ("p3", false)]);
    // Several rows of an id count the same in whatever order they are.
    for statuses in ["1,p1,RETURNED\n2,p1,APPROVED\n", "1,p1,APPROVED\n2,p1,RETURNED\n"] {
        std::fs::write(&file, format!("Submission id,Participant id,Status\n{statuses}")).unwrap();
        let rows = desk.study.reconcile_recruiter_list(&file).unwrap().rows;
        let row = rows.iter().find(|row| row.recruiter_id == "p1").unwrap();
        assert_eq!(row.theirs.as_deref(), Some("APPROVED"));
        assert!(row.problem.unwrap().contains("several times"), "{row:?}");
    }
    desk.study.close(true).unwrap();
    assert!(desk.study.reconcile_recruiter_list(&file).unwrap_err().to_string().contains("first"));
}

#[test]
fn what_a_template_leaves_where_a_value_is_missing_is_no_id() {
    for none in
        ["", "undefined", "NULL", "NaN", "PROLIFIC_PID", "prolific_pid", "{{%PROLIFIC_PID%}}", "[object Object]"]
    {
        assert!(!people::may_be_issued(none, "PROLIFIC_PID"), "{none}");
    }
    for id in ["5f0000000000000000000001", "A1B2C3D4", "1042", "nullius"] {
        assert!(people::may_be_issued(id, "PROLIFIC_PID"), "{id}");
    }
}

#[test]
fn a_closed_study_keeps_no_id_of_a_recruiter() {
    let desk = by_recruiter();
    let person = desk.come(&recruit("5f0000000000000000000001", "x")).unwrap();
    let slot = desk.held(person).slot;
    let live = desk.ask(|book| book.close_study(false));
    assert_eq!((live, desk.ask(|book| book.is_closed())), (1, false));
    desk.ask(|book| book.close_study(true));
    assert_eq!(
        desk.give(person, ParticipantInput::Chosen { slot, choice: PairChoice::A, pictures: None }),
        Err(InputRefusal::Closed)
    );
    assert_eq!(desk.come(&recruit("p9", "x")), Err(ArrivalOutcome::Closed));
    // Opening and closing it moves what the log holds into the file.
    drop(StudyStore::open(&desk.folder.path().join("study.db")).unwrap());
    let bytes = std::fs::read(desk.folder.path().join("study.db")).unwrap();
    assert!(!bytes.windows(24).any(|window| window == b"5f0000000000000000000001"));
}

#[test]
fn forget_deletes_the_data_and_frees_the_item() {
    let desk = by_recruiter();
    let person = desk.come(&recruit("p1", "x")).unwrap();
    desk.answer(person);
    desk.answer(person);
    let dry = desk.study.forget_participant("p1", true).unwrap();
    assert_eq!((dry.answers, dry.is_done, desk.data().participants.len()), (2, false, 1));
    let gone = desk.study.forget_participant("p1", false).unwrap();
    assert_eq!((gone.participant == dry.participant, gone.is_done), (true, true));
    let data = desk.data();
    assert_eq!((data.participants.len(), data.slots.len(), data.forgotten), (0, 0, 1));
    assert!(desk.study.forget_participant("p1", false).is_err());
    assert!(desk.come(&recruit("p1", "x")).is_ok(), "somebody who was forgotten is a stranger");
}

#[test]
fn withdraw_keeps_or_deletes_answers_as_chosen() {
    let desk = study(StudyTask::Pair, 4, 1, 2);
    let (keeps, deletes) = (desk.newcomer(), desk.newcomer());
    for person in [keeps, deletes] {
        desk.answer(person);
        desk.answer(person);
        desk.held(person);
    }
    desk.ask(|book| book.withdraw_person(keeps, WithdrawalChoice::Keep));
    desk.ask(|book| book.withdraw_person(deletes, WithdrawalChoice::Delete));
    let data = desk.data();
    assert_eq!(
        data.participants.iter().map(|person| person.status).collect::<Vec<_>>(),
        [ParticipantStatus::Withdrawn]
    );
    assert_eq!(desk.answered().iter().sum::<u32>(), 1);
    assert_eq!(
        desk.stage(keeps),
        ParticipantStage::Over(ParticipationOutcome { status: ParticipantStatus::Withdrawn, answers: 1 })
    );
}

#[test]
fn a_session_ends_after_a_week_and_the_link_leads_back() {
    let mut desk = by_recruiter();
    let arrival = recruit("p1", "x");
    let ArrivalOutcome::Back(session) = desk.ask(|book| book.record_consent(&arrival, HASH)) else { panic!() };
    assert!(desk.ask(|book| book.person_by_session(&session)).is_some());
    desk.now_ms += 7 * 24 * 3600 * 1000;
    assert_eq!(desk.ask(|book| book.person_by_session(&session)), None);
    assert!(matches!(desk.ask(|book| book.enter_study(&arrival)), ArrivalOutcome::Back(_)));
}

#[test]
fn a_later_database_is_not_touched() {
    let desk = study(StudyTask::Pair, 1, 1, 1);
    let file = desk.folder.path().join("study.db");
    rusqlite::Connection::open(&file).unwrap().pragma_update(None, "user_version", 99).unwrap();
    assert!(StudyStore::open(&file).unwrap_err().to_string().contains("later version"));
}

/// A study with one question at the end, which has to be answered, and one that may be left out.
fn with_end_questions(routes: u32) -> Desk {
    let mut desk = study(StudyTask::Pair, routes, 1, routes);
    let question = |name: &str, optional| EndQuestion {
        name: name.to_owned(),
        text: "How old are you?".to_owned(),
        kind: EndQuestionKind::Text,
        answers: Vec::new(),
        optional,
        max_chars: 0,
    };
    desk.study.settings.end = vec![question("age", false), question("more", true)];
    desk
}

fn end_answers(text: &str) -> ParticipantInput {
    ParticipantInput::End { answers: vec![EndAnswer { name: "age".to_owned(), answer: text.to_owned(), number: None }] }
}

#[test]
fn questions_at_the_end_come_after_the_last_item_and_count_once() {
    let desk = with_end_questions(2);
    let person = desk.newcomer();
    assert_eq!(desk.give(person, end_answers("early")), Err(InputRefusal::OutOfTurn));
    desk.answer_all(person);
    assert_eq!(desk.stage(person), ParticipantStage::End);
    assert_eq!(desk.data().participants[0].status, ParticipantStatus::Complete, "the items are what counts");
    for text in ["first", "second"] {
        desk.give(person, end_answers(text)).unwrap();
    }
    assert!(matches!(desk.stage(person), ParticipantStage::Over(_)));
    assert_eq!(desk.data().participants[0].end[0].answer, "first");
    let id = desk.data().participants[0].id.clone();
    desk.ask(|book| book.forget_participant(&id, false));
    let left: i64 = StudyStore::open(&desk.folder.path().join("study.db"))
        .unwrap()
        .db
        .query_row("SELECT count(*) FROM end_answers", [], |row| row.get(0))
        .unwrap();
    assert_eq!(left, 0, "what is forgotten is gone");
}

#[test]
fn a_closed_study_asks_no_more_questions_and_ends_with_the_code() {
    let desk = with_end_questions(1);
    let person = desk.newcomer();
    desk.answer_all(person);
    desk.ask(|book| book.close_study(false));
    assert!(matches!(
        desk.stage(person),
        ParticipantStage::Over(ParticipationOutcome { status: ParticipantStatus::Complete, .. })
    ));
    assert_eq!(desk.give(person, end_answers("late")), Err(InputRefusal::Closed));
}

#[test]
fn the_most_pictures_of_a_film_that_were_seen_are_kept() {
    let mut desk = study(StudyTask::Pair, 1, 1, 1);
    let picture = |at: u32| FilmPicture { file: format!("{at}.jpg"), alt: String::new() };
    desk.study.routes.iter_mut().for_each(|route| route.film = (0..5).map(picture).collect());
    let person = desk.newcomer();
    for pictures in [Some(3), Some(2), None, Some(9000)] {
        let slot = desk.held(person).slot;
        let seen = ParticipantInput::OwnText { slot, text: "mine".to_owned(), pictures };
        desk.give(person, seen).unwrap();
        let data = desk.data();
        let expected = if pictures == Some(9000) { 5 } else { 3 };
        assert_eq!(data.slots[0].pictures_seen, Some(expected), "{pictures:?}");
    }
}

#[test]
fn a_full_disk_is_told_and_what_was_acknowledged_stays() {
    let desk = study(StudyTask::Pair, 4, 1, 4);
    let person = desk.newcomer();
    let slot = desk.held(person).slot;
    desk.give(person, ParticipantInput::Chosen { slot, choice: PairChoice::A, pictures: None }).unwrap();
    let file = desk.folder.path().join("study.db");
    let mut store = StudyStore::open(&file).unwrap();
    let pages: i64 = store.db.pragma_query_value(None, "page_count", |row| row.get(0)).unwrap();
    store.db.pragma_update(None, "max_page_count", pages).unwrap();
    let error = store
        .write_transaction(&desk.study, desk.now_ms, |book| book.invite_participants(2000))
        .expect_err("the disk has no room for so many links");
    assert!(error.is_of_disk() && error.to_string().contains("free some space"), "{error}");
    // The same connection goes on when there is room again.
    store.db.pragma_update(None, "max_page_count", 100_000).unwrap();
    store.write_transaction(&desk.study, desk.now_ms, |book| book.invite_participants(2000)).unwrap();
    assert_eq!(desk.data().slots.iter().filter(|slot| slot.answer.is_some()).count(), 1);
}

#[test]
fn a_database_is_read_without_writing_to_it() {
    let desk = study(StudyTask::Pair, 1, 1, 1);
    let person = desk.newcomer();
    desk.held(person);
    let file = desk.folder.path().join("study.db");
    StudyStore::open(&file).unwrap().empty_log();
    let before = std::fs::read(&file).unwrap();
    let mut store = StudyStore::open_to_read(&file).unwrap();
    let progress = store.read_transaction(&desk.study, desk.now_ms, |book| book.read_progress()).unwrap();
    assert_eq!(progress.participants[&ParticipantStatus::Started], 1);
    let refused = store.write_transaction(&desk.study, desk.now_ms, |book| book.invite_participants(1));
    assert!(refused.unwrap_err().is_of_disk());
    drop(store);
    assert!(before == std::fs::read(&file).unwrap(), "the database has changed");
}
