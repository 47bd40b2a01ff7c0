//! Tests of climbs and storeys.

use crate::{
    CheckSubject, Evidence, check_text,
    tests::{by_stairs, finds, flat, frame, has_no_mistake, on_video, style, walk},
};
use wayword_core::{CheckKind, Verdict};

#[test]
fn a_climb_passes_in_its_direction_and_fails_in_the_other() {
    for (from, to, right, wrong) in [(1, 2, "up", "down"), (2, 1, "down", "up")] {
        let path = by_stairs(from, to);
        has_no_mistake(CheckKind::Floors, &format!("Go {right} the stairs."), &path);
        let text = format!("Go {wrong}stairs.");
        let reason = format!("the path does not go {wrong} any stairs");
        finds(CheckKind::Floors, Verdict::Fail, &format!("{wrong}stairs"), &reason, &text, &path);
        has_no_mistake(CheckKind::Floors, &format!("Walk {right} a few steps."), &path);
    }
    let steps = "the path does not go down any steps";
    let text = "Walk down two steps and stop.";
    let found = crate::tests::findings_of(CheckKind::Floors, text, &by_stairs(1, 2));
    assert_eq!((found[0].0, found[0].2.as_str()), (Verdict::Fail, steps));
}

#[test]
fn climbs_of_an_unknown_motion_are_unverified() {
    let reason = "the program cannot check whether the path goes up or down";
    for text in ["Go upstairs.", "Go downstairs."] {
        let word = &text[3..text.len() - 1];
        finds(CheckKind::Floors, Verdict::Unverified, word, reason, text, &on_video());
    }
    has_no_mistake(CheckKind::Floors, "Walk past the sofa.", &on_video());
}

#[test]
fn a_place_upstairs_is_right_at_the_upper_end() {
    let upstairs = "Go to the bathroom upstairs.";
    let downstairs = "Go to the bathroom downstairs.";
    for (path, up, down) in [
        (flat(2), Verdict::Pass, Verdict::Fail),
        (flat(3), Verdict::Pass, Verdict::Fail),
        (flat(1), Verdict::Fail, Verdict::Pass),
        (flat(0), Verdict::Unverified, Verdict::Unverified),
        (by_stairs(1, 2), Verdict::Pass, Verdict::Fail),
        (by_stairs(2, 1), Verdict::Fail, Verdict::Pass),
        // A climb in the direction makes it right on any storey.
        (by_stairs(3, 2), Verdict::Pass, Verdict::Pass),
    ] {
        for (text, wanted) in [(upstairs, up), (downstairs, down)] {
            let found = crate::tests::findings_of(CheckKind::Floors, text, &path);
            assert_eq!(found[0].0, wanted, "{text} {:?}", path.frames[1].level);
            if wanted == Verdict::Fail {
                let way = if text == upstairs { "up" } else { "down" };
                assert_eq!(found[0].2, format!("the path does not end {way} any stairs"));
            }
        }
    }
    // Where the storey is not known, the climb decides.
    let mut unknown = by_stairs(1, 2);
    unknown.frames[1].level = None;
    let verdict = |text: &str| crate::tests::findings_of(CheckKind::Floors, text, &unknown)[0].0;
    assert_eq!((verdict(upstairs), verdict(downstairs)), (Verdict::Pass, Verdict::Unverified));
}

/// A path through these storeys.
fn through(levels: &[u32]) -> Evidence {
    let frames = levels.iter().map(|level| frame("hallway", Some(&[]), *level)).collect();
    let moves: Vec<(f64, f64)> = levels
        .windows(2)
        .map(|pair| (0.0, if pair[0] * pair[1] == 0 { 0.0 } else { 3.0 * (f64::from(pair[1]) - f64::from(pair[0])) }))
        .collect();
    walk(frames, &moves)
}

#[test]
fn a_storey_fails_where_the_path_is_never_or_not_then_on_it() {
    let verdict = |text: &str, levels: &[u32]| {
        let found = crate::tests::findings_of(CheckKind::Floors, text, &through(levels));
        (found[0].0, found[0].2.clone())
    };
    let pass = (Verdict::Pass, String::new());
    let never = |number: u32| (Verdict::Fail, format!("the path is never on storey {number}"));
    let not_then =
        |number: u32| (Verdict::Fail, format!("the path is on storey {number}, but not at this point of the text"));
    let open = |name: &str| (Verdict::Unverified, format!("the program cannot check whether the path is on {name}"));
    let text = "Walk to the hallway on the second floor.";
    assert_eq!(verdict(text, &[1, 2]), pass);
    assert_eq!(verdict(text, &[2, 1]), not_then(2));
    assert_eq!(verdict(text, &[1, 1]), never(2));
    assert_eq!(verdict(text, &[1, 0]), open("storey 2"));
    assert_eq!(verdict(text, &[0, 1]), never(2));
    let from = "Walk from the second floor to the first floor.";
    assert_eq!(verdict(from, &[2, 1]), pass);
    assert_eq!(verdict(from, &[1, 2]), not_then(1));
    assert_eq!(verdict(from, &[3, 1]), never(2));
    assert_eq!(verdict(from, &[2, 0]), open("storey 1"));
    let top = "Walk to the hallway on the top floor.";
    assert_eq!(verdict(top, &[1, 2]), open("the top storey"));
    assert_eq!(verdict(top, &[2, 1]), (Verdict::Fail, "the path is never on the top storey".to_owned()));
    assert_eq!(verdict(top, &[2, 2]), open("the top storey"));
}

#[test]
fn storeys_are_counted_as_the_english_of_the_text_counts_them() {
    let verdict = |text: &str, tag: Option<&str>, levels: &[u32]| {
        let evidence = through(levels);
        let style = style(false);
        let subject = CheckSubject { tag, ..CheckSubject::closed_world(&evidence, &style, None) };
        let findings = check_text(text, subject).findings;
        findings.into_iter().find(|finding| finding.check == CheckKind::Floors).unwrap().verdict
    };
    let first = "Walk to the hallway on the first floor.";
    assert_eq!(verdict(first, Some("en-IN"), &[1, 2]), Verdict::Pass);
    assert_eq!(verdict(first, Some("en-IN"), &[2, 1]), Verdict::Fail);
    assert_eq!(verdict(first, Some("en-US"), &[2, 1]), Verdict::Pass);
    assert_eq!(verdict(first, None, &[1, 2]), Verdict::Fail);
    assert_eq!(verdict("Walk to the hallway on the ground floor.", Some("en-IN"), &[2, 1]), Verdict::Pass);
    let both = "Walk from the ground floor to the first floor.";
    assert_eq!(verdict(both, Some("en_GB"), &[1, 2]), Verdict::Pass);
    assert_eq!(verdict(both, None, &[1, 2]), Verdict::Unverified);
    assert_eq!(verdict(both, None, &[3, 4]), Verdict::Fail);
}

#[test]
fn the_last_storey_of_a_text_need_not_be_the_end_where_it_climbs_on() {
    let passes = |text: &str, levels: &[u32]| has_no_mistake(CheckKind::Floors, text, &through(levels));
    let fails = |text: &str, levels: &[u32]| {
        assert_eq!(crate::tests::findings_of(CheckKind::Floors, text, &through(levels))[0].0, Verdict::Fail, "{text}");
    };
    passes("Walk along the first floor hallway. Go up the stairs and stop.", &[1, 2]);
    fails("Go up the stairs and stop. Walk along the first floor hallway.", &[1, 2]);
    fails("Walk along the first floor hallway and stop.", &[1, 2]);
    passes("Start on the first floor.", &[1, 2]);
    fails("Start on the second floor.", &[1, 1]);
}

#[test]
fn storeys_of_a_text_come_in_the_order_of_the_path() {
    let verdict = |text: &str, levels: &[u32]| {
        crate::tests::findings_of(CheckKind::Floors, text, &through(levels)).iter().map(|found| found.0).max().unwrap()
    };
    let up = "Walk from the first floor to the second floor. Walk to the third floor.";
    assert_eq!(verdict(up, &[1, 2, 3]), Verdict::Pass);
    assert_eq!(verdict(up, &[2, 1, 3]), Verdict::Fail);
    assert_eq!(verdict(up, &[1, 2, 2]), Verdict::Fail);
    assert_eq!(verdict("Walk to the second floor from the first floor.", &[1, 2]), Verdict::Pass);
    assert_eq!(verdict("Walk to the second floor from the first floor.", &[2, 1]), Verdict::Fail);
}
