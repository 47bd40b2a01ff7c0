//! Tests of the order of places, turns and climbs.

use crate::{
    Evidence,
    tests::{fails, findings_of, finds, frame, has_no_mistake, is_unverified, on_video, passes, to_the_bedroom, walk},
};
use wayword_core::{CheckKind, Verdict};

/// Past a plant, a sofa and a lamp in one hallway, with a turn at each of the inner frames.
fn along_the_hallway(turns_deg: [f64; 3]) -> Evidence {
    let things = [&["plant"], &["sofa"], &["lamp"], &["bench"]];
    let frames = things.iter().map(|things| frame("hallway", Some(&things[..]), 1)).collect();
    walk(frames, &turns_deg.map(|deg| (deg, 0.0)))
}

#[test]
fn order_fails_where_two_places_are_swapped() {
    let path = along_the_hallway([0.0; 3]);
    passes("Walk past the sofa. Walk past the lamp.", &path);
    let text = "Walk past the lamp. Walk past the sofa.";
    finds(
        CheckKind::Order,
        Verdict::Fail,
        "sofa",
        "it comes too late in the text: the path passed it before",
        text,
        &path,
    );
}

#[test]
fn order_is_unverified_where_an_unknown_frame_may_show_the_place_again() {
    let mut path = along_the_hallway([0.0; 3]);
    path.frames[3] = frame("hallway", None, 1);
    let reason = "the path passed it earlier, and the program cannot check whether the path passes it again here";
    let text = "Walk past the lamp. Walk past the sofa.";
    finds(CheckKind::Order, Verdict::Unverified, "sofa", reason, text, &path);
}

#[test]
fn turns_pass_to_their_own_side_and_fail_to_the_other() {
    for (deg, right, wrong) in [(90.0, "right", "left"), (-90.0, "left", "right")] {
        let path = along_the_hallway([0.0, deg, 0.0]);
        passes(&format!("Walk past the sofa and turn {right}."), &path);
        let reason = format!("no move of the path turns {wrong} here");
        let text = format!("Walk past the sofa and turn {wrong}.");
        let found = findings_of(CheckKind::Turns, &text, &path);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].0, &found[0].2), (Verdict::Fail, &reason), "{text}");
        has_no_mistake(CheckKind::Order, &text, &path);
    }
    let path = along_the_hallway([0.0, 90.0, 0.0]);
    let around = findings_of(CheckKind::Turns, "Walk past the sofa and turn around.", &path);
    assert_eq!((around[0].0, around[0].2.as_str()), (Verdict::Fail, "no move of the path turns around here"));
    passes("Walk past the sofa and turn around.", &along_the_hallway([0.0, 180.0, 0.0]));
}

#[test]
fn a_turn_has_to_be_where_its_places_are() {
    // The turn is at the sofa, and the plant and the bench are two frames apart from its place in the text.
    let path = along_the_hallway([0.0, 90.0, 0.0]);
    passes("Turn right at the sofa.", &path);
    passes("Walk past the plant. Turn right. Walk to the bench.", &path);
    let late = findings_of(CheckKind::Turns, "Walk past the bench. Turn right.", &path);
    assert_eq!((late[0].0, late[0].2.as_str()), (Verdict::Fail, "no move of the path turns right here"));
    let before = findings_of(CheckKind::Turns, "Turn right. Walk past the plant.", &path);
    assert_eq!(before[0].0, Verdict::Fail);
    assert_eq!(
        (before[0].1.as_str(), before[0].2.as_str()),
        ("plant", "the path turns differently before it gets here")
    );
}

#[test]
fn two_turns_need_two_moves_in_their_order() {
    let path = along_the_hallway([0.0, 90.0, -90.0]);
    passes("Turn right. Turn left.", &path);
    fails(CheckKind::Turns, "Turn left. Turn right.", &path);
    fails(CheckKind::Turns, "Turn right. Turn right.", &path);
    passes("Turn right. Turn right.", &along_the_hallway([0.0, 90.0, 90.0]));
}

#[test]
fn turns_are_checked_alone_where_the_places_are_out_of_order() {
    let swapped = "Walk past the lamp. Turn right. Walk past the sofa.";
    let path = along_the_hallway([0.0, 90.0, 0.0]);
    let verdicts = |text: &str, path: &Evidence| {
        let of = |check| findings_of(check, text, path).iter().map(|found| found.0).collect::<Vec<_>>();
        (of(CheckKind::Order), of(CheckKind::Turns))
    };
    assert_eq!(verdicts(swapped, &path), (vec![Verdict::Fail], vec![Verdict::Pass]));
    let straight = along_the_hallway([0.0; 3]);
    assert_eq!(verdicts(swapped, &straight), (vec![Verdict::Fail], vec![Verdict::Fail]));
    let found = findings_of(CheckKind::Turns, swapped, &straight);
    assert!(found[0].1.contains("right") && found[0].2 == "no move of the path turns right here", "{found:?}");
    let mut video = on_video();
    video.frames.push(frame("bedroom", Some(&["desk"]), 0));
    let text = "Walk past the lamp. Turn right. Walk past the rug.";
    assert_eq!(verdicts(text, &video), (vec![Verdict::Fail], vec![Verdict::Unverified]));
}

#[test]
fn the_first_turn_of_an_unknown_motion_is_unverified() {
    let reason = "the program cannot check how the path turns";
    let text = "Turn right. Walk past the sofa. Turn left into the bedroom.";
    let found = findings_of(CheckKind::Turns, text, &on_video());
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].0, found[0].2.as_str()), (Verdict::Unverified, reason));
    assert!(text.starts_with("Turn right") && found[0].1.contains("ight"), "it is the first one: {found:?}");
    has_no_mistake(CheckKind::Turns, "Walk past the sofa into the bedroom.", &on_video());
}

#[test]
fn a_climb_is_a_place_in_the_order() {
    let frames = ["plant", "sofa", "lamp", "bench"].map(|thing| frame("hallway", Some(&[thing]), 0));
    let path = walk(frames.into(), &[(0.0, 0.0), (0.0, 3.0), (0.0, 0.0)]);
    passes("Walk past the plant. Go up the stairs. Walk past the lamp.", &path);
    fails(CheckKind::Order, "Walk past the lamp. Go up the stairs.", &path);
    // What stands beside a flight may be passed on its first step; a sentence of its own tells what comes next.
    passes("Go up the stairs, past the plant.", &path);
    fails(CheckKind::Order, "Go up the stairs. Walk past the plant.", &path);
    // A climb that the path lacks has no place in the order.
    let verdict = findings_of(CheckKind::Order, "Walk past the lamp. Go down the stairs.", &path);
    assert_eq!(verdict[0].0, Verdict::Pass);
}

#[test]
fn a_place_beside_another_one_of_its_clause_is_free_in_the_order() {
    let path = along_the_hallway([0.0; 3]);
    passes("Walk to the bench next to the plant.", &path);
    // In a clause of its own it has to be passed then.
    let apart = findings_of(CheckKind::Order, "Walk past the lamp. Stop next to the plant.", &path);
    assert_eq!((apart[0].0, apart[0].1.as_str()), (Verdict::Fail, "plant"));
    fails(CheckKind::Order, "Walk past the lamp, past the plant.", &path);
    passes("Walk to the bench past the plant.", &path);
}

#[test]
fn a_sentence_about_something_else_changes_no_verdict_of_the_order() {
    let path = along_the_hallway([0.0, 90.0, 0.0]);
    for text in [
        "Walk past the sofa. Walk past the lamp.",
        "Walk past the lamp. Walk past the sofa.",
        "Walk past the sofa. Turn left.",
        "Walk past the sofa. Turn right.",
    ] {
        for check in [CheckKind::Order, CheckKind::Turns] {
            let more = format!("{text} Walk to the bench.");
            assert_eq!(findings_of(check, text, &path), findings_of(check, &more, &path), "{more}");
        }
    }
}

#[test]
fn order_passes_around_a_place_that_is_not_known() {
    let mut path = to_the_bedroom();
    path.frames[2] = frame("bedroom", None, 1);
    is_unverified(CheckKind::Landmarks, "Walk past the piano. Walk past the sofa.", &path);
    passes("Walk past the rug. Walk past the sofa.", &path);
}
