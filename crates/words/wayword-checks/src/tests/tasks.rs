//! Tests of the closing task.

use crate::{
    CheckSubject, Evidence, EvidenceSource, SeenThing, WorldReach, check_text,
    tests::{style, to_the_bedroom},
};
use wayword_core::{CheckKind, ObjectDistinction, ObjectId, PathMotion, PathTarget, Verdict};

fn target(name: &str, object: &str) -> PathTarget {
    PathTarget {
        object: ObjectId::new(object).unwrap(),
        name: name.into(),
        told_by: Vec::new(),
        has_namesake: false,
        descriptions: Vec::new(),
        hangs: false,
        storeys: 0,
    }
}

/// The outcome of the check of the task, with the words and the reason.
fn task_of(text: &str, evidence: &Evidence, target: Option<&PathTarget>) -> (Verdict, String, String) {
    let style = style(true);
    let checked = check_text(text, CheckSubject::closed_world(evidence, &style, target));
    let found = checked.findings.iter().find(|finding| finding.check == CheckKind::Task).unwrap();
    let words = found.span.map_or("", |[from, to]| &text[from..to]);
    (found.verdict, words.to_owned(), found.reason.clone())
}

fn wrong(verdict: Verdict, words: &str, reason: &str) -> (Verdict, String, String) {
    (verdict, words.to_owned(), reason.to_owned())
}

const PASS: (Verdict, String, String) = (Verdict::Pass, String::new(), String::new());

#[test]
fn a_task_needs_a_verb_and_an_object() {
    let path = to_the_bedroom();
    assert_eq!(task_of("Go to the bedroom and clean the lamp", &path, None), PASS);
    let none = wrong(Verdict::Fail, "", "it does not end in a task");
    assert_eq!(task_of("Go to the bedroom.", &path, None), none);
    let (verdict, words, reason) = task_of("Go to the bedroom and clean it", &path, None);
    assert_eq!((verdict, words.as_str()), (Verdict::Fail, ""));
    assert!(reason.contains("task"), "{reason}");
}

#[test]
fn a_task_is_about_the_given_target() {
    let path = to_the_bedroom();
    let text = "Go to the bedroom and clean the lamp";
    assert_eq!(task_of(text, &path, Some(&target("lamp", "1"))), PASS);
    assert_eq!(task_of(text, &path, Some(&target("table lamp", "1"))), PASS);
    let reason = "its task is about \"lamp\", and the given target is \"bed\"";
    assert_eq!(task_of(text, &path, Some(&target("bed", "1"))), wrong(Verdict::Fail, "lamp", reason));
}

#[test]
fn the_object_of_a_task_has_to_be_seen_at_the_end() {
    let mut path = to_the_bedroom();
    let text = "Go to the bedroom and clean the sofa";
    let absent = wrong(Verdict::Fail, "sofa", "\"sofa\" is not seen from the final viewpoint");
    assert_eq!(task_of(text, &path, None), absent);
    let open = wrong(Verdict::Unverified, "sofa", "the program cannot check whether there is \"sofa\"");
    path.frames[2].knows_things = false;
    assert_eq!(task_of(text, &path, None), open);
    // In an open world, a missing label denies nothing.
    let known = to_the_bedroom();
    let style = style(true);
    let verdict = |text: &str| {
        let checked = check_text(text, CheckSubject::open_world(&known, &style, WorldReach::default()));
        checked.findings.iter().find(|finding| finding.check == CheckKind::Task).unwrap().verdict
    };
    assert_eq!(verdict(text), Verdict::Unverified);
    assert_eq!(verdict("Go to the bedroom and clean the lamp"), Verdict::Pass);
}

#[test]
fn a_given_target_is_there_though_no_witness_named_it() {
    let mut path = to_the_bedroom();
    path.source = EvidenceSource::Captions;
    path.frames[2].lists_things = true;
    let text = "Go to the bedroom and clean the green sofa";
    let absent = wrong(Verdict::Fail, "sofa", "\"sofa\" is not seen from the final viewpoint");
    assert_eq!(task_of(text, &path, None), absent);
    assert_eq!(task_of(text, &path, Some(&target("sofa", "7"))), PASS);
    // Its colour is the world's, too, whatever a witness says.
    path.frames[2].things.push(SeenThing { name: "sofa".into(), colour: Some("grey".into()), ..SeenThing::default() });
    let verdict = |told_by: Vec<ObjectDistinction>| {
        let (style, target) = (style(true), PathTarget { told_by, ..target("sofa", "7") });
        check_text(text, CheckSubject::closed_world(&path, &style, Some(&target))).verdict()
    };
    assert_eq!(verdict(vec![ObjectDistinction::Colour { colour: "green".into() }]), Verdict::Pass);
    assert_eq!(verdict(Vec::new()), Verdict::Fail);
}

#[test]
fn the_side_of_a_task_is_that_on_arrival() {
    let mut path = to_the_bedroom();
    let text = |side: &str| format!("Go to the bedroom and clean the lamp on your {side}");
    assert_eq!(task_of(&text("left"), &path, None), PASS, "its direction is not known");
    for (rad, right, other) in [(-0.8, "left", "right"), (0.8, "right", "left")] {
        path.frames[2].things[0].turn_rad = Some(rad);
        assert_eq!(task_of(&text(right), &path, None), PASS);
        let reason = format!("\"lamp\" is not on the {other} when one arrives");
        assert_eq!(task_of(&text(other), &path, None), wrong(Verdict::Fail, "lamp", &reason));
    }
    path.motion = PathMotion::Unknown;
    let reason = "the program cannot check on which side of the walker \"lamp\" is";
    assert_eq!(task_of(&text("left"), &path, None), wrong(Verdict::Unverified, "lamp", reason));
    assert_eq!(task_of("Go to the bedroom and clean the lamp", &path, None), PASS);
}

#[test]
fn the_side_of_a_task_is_that_of_the_target_where_its_id_is_known() {
    let mut path = to_the_bedroom();
    let lamp = |id: Option<&str>, turn_rad: f64| SeenThing {
        name: "lamp".into(),
        object: id.map(|id| ObjectId::new(id).unwrap()),
        turn_rad: Some(turn_rad),
        ..SeenThing::default()
    };
    let left = "Go to the bedroom and clean the lamp on your left";
    path.frames[2].things = vec![lamp(Some("1"), 0.8), lamp(Some("2"), -0.8)];
    assert_eq!(task_of(left, &path, None), PASS, "one of the two is on the left");
    assert_eq!(task_of(left, &path, Some(&target("lamp", "2"))), PASS);
    assert_eq!(task_of(left, &path, Some(&target("lamp", "1"))).0, Verdict::Fail);
    // A thing without an id may be the target.
    path.frames[2].things = vec![lamp(Some("1"), 0.8), lamp(None, -0.8)];
    assert_eq!(task_of(left, &path, Some(&target("lamp", "1"))), PASS);
}

#[test]
fn captions_deny_the_object_of_a_task_by_a_list_or_by_a_word() {
    let mut path = to_the_bedroom();
    path.source = EvidenceSource::Captions;
    let verdict = |text: &str, path: &Evidence| task_of(text, path, None).0;
    let text = "Go to the bedroom and clean the clock";
    assert_eq!(verdict(text, &path), Verdict::Unverified, "the witness may have left it out");
    let mut listed = path.clone();
    listed.frames[2].lists_things = true;
    assert_eq!(verdict(text, &listed), Verdict::Fail);
    listed.frames[0].perhaps.things = vec![SeenThing { name: "clock".into(), ..SeenThing::default() }];
    assert_eq!(verdict(text, &listed), Verdict::Unverified, "another frame may show it");
    let mut denied = path.clone();
    denied.frames[2].denied = vec!["clock".into()];
    assert_eq!(verdict(text, &denied), Verdict::Fail);
    denied.frames[2].perhaps.things = vec![SeenThing { name: "clock".into(), ..SeenThing::default() }];
    assert_eq!(verdict(text, &denied), Verdict::Unverified);
    let mut before = path;
    before.frames[1].denied = vec!["clock".into()];
    assert_eq!(verdict(text, &before), Verdict::Unverified, "only the last frame counts");
}
