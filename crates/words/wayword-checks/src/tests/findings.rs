//! Tests of how findings are put together: the worst one counts, and each check has one outcome.

use crate::{
    CheckSubject, CheckWorld, EvidenceSource, SeenThing, TextFindings, add_worse, check_own_text, check_text,
    count_objects_meant, findings_or_pass, pass_finding,
    tests::{fails, flat, frame, on_video, passes, style, to_the_bedroom, walk},
};
use wayword_core::{CheckFinding, CheckKind, MentionKind, Verdict};

fn finding(check: CheckKind, verdict: Verdict, span: Option<[usize; 2]>) -> CheckFinding {
    CheckFinding { check, verdict, reason: "why".into(), span }
}

fn checked(world: CheckWorld, findings: Vec<CheckFinding>) -> TextFindings {
    TextFindings { findings, mentions: Vec::new(), parts: Vec::new(), world }
}

#[test]
fn verdict_is_the_worst_finding_and_unverified_without_any() {
    use Verdict::{Fail, Pass, Unverified};
    let verdict = |found: &[Verdict]| {
        let findings = found.iter().map(|verdict| finding(CheckKind::Order, *verdict, None)).collect();
        checked(CheckWorld::Closed, findings).verdict()
    };
    assert_eq!(verdict(&[]), Unverified);
    assert_eq!(verdict(&[Pass, Pass]), Pass);
    assert_eq!(verdict(&[Pass, Unverified]), Unverified);
    assert_eq!(verdict(&[Fail, Unverified]), Fail);
}

#[test]
fn add_findings_replaces_the_pass_of_its_check_alone() {
    let mut found = checked(CheckWorld::Open, vec![pass_finding(CheckKind::Turns), pass_finding(CheckKind::Order)]);
    found.add_findings([finding(CheckKind::Turns, Verdict::Unverified, Some([2, 5]))]);
    let left: Vec<_> = found.findings.iter().map(|finding| (finding.check, finding.verdict)).collect();
    assert_eq!(left, [(CheckKind::Order, Verdict::Pass), (CheckKind::Turns, Verdict::Unverified)]);
    // A pass replaces nothing, and earlier findings stay.
    found.add_findings([pass_finding(CheckKind::Turns), finding(CheckKind::Turns, Verdict::Fail, Some([8, 9]))]);
    let left: Vec<_> = found.findings.iter().map(|finding| (finding.check, finding.verdict)).collect();
    let turns = [(CheckKind::Turns, Verdict::Unverified), (CheckKind::Turns, Verdict::Fail)];
    assert_eq!(left, [&[(CheckKind::Order, Verdict::Pass)], &turns[..]].concat());
    found.add_findings([pass_finding(CheckKind::Route)]);
    assert_eq!(found.findings.len(), 4);
}

#[test]
fn add_findings_skips_the_same_verdict_on_overlapping_words() {
    let with = |second: CheckFinding| {
        let first = finding(CheckKind::Turns, Verdict::Fail, Some([4, 8]));
        let mut found = checked(CheckWorld::Open, vec![first]);
        found.add_findings([second]);
        found.findings.len()
    };
    for (span, count) in [([4, 8], 1), ([7, 9], 1), ([1, 5], 1), ([5, 6], 1), ([8, 9], 2), ([1, 4], 2)] {
        assert_eq!(with(finding(CheckKind::Turns, Verdict::Fail, Some(span))), count, "{span:?}");
    }
    assert_eq!(with(finding(CheckKind::Turns, Verdict::Unverified, Some([4, 8]))), 2);
    assert_eq!(with(finding(CheckKind::Order, Verdict::Fail, Some([4, 8]))), 2);
    assert_eq!(with(finding(CheckKind::Turns, Verdict::Fail, None)), 2, "without words they may be two");
}

#[test]
fn add_worse_keeps_the_worse_of_two_looks_at_the_same_words() {
    use Verdict::{Fail, Pass, Unverified};
    let after = |before: &[(CheckKind, Verdict, usize)], verdict: Verdict| {
        let at = |(check, verdict, at): &(CheckKind, Verdict, usize)| finding(*check, *verdict, Some([*at, *at + 2]));
        let mut findings = before.iter().map(at).collect();
        add_worse(&mut findings, finding(CheckKind::Landmarks, verdict, Some([0, 2])));
        findings.iter().map(|left| (left.check, left.verdict, left.span.unwrap()[0])).collect::<Vec<_>>()
    };
    let of = |verdict, at| (CheckKind::Landmarks, verdict, at);
    assert_eq!(after(&[of(Fail, 0)], Unverified), [of(Fail, 0)]);
    assert_eq!(after(&[of(Unverified, 0)], Fail), [of(Fail, 0)]);
    // A pass of the check goes, and findings about other words stay.
    assert_eq!(after(&[of(Pass, 9), of(Unverified, 5)], Fail), [of(Unverified, 5), of(Fail, 0)]);
    assert_eq!(after(&[of(Fail, 5)], Fail), [of(Fail, 5), of(Fail, 0)]);
    let order = (CheckKind::Order, Pass, 0);
    assert_eq!(after(&[order], Unverified), [order, of(Unverified, 0)]);
    let failed = (CheckKind::Order, Fail, 0);
    assert_eq!(after(&[failed], Unverified), [failed, of(Unverified, 0)]);
    // The very same finding is added once.
    let mut same = vec![finding(CheckKind::Landmarks, Fail, Some([0, 2]))];
    let again = CheckFinding { reason: "again".into(), ..same[0].clone() };
    add_worse(&mut same, again);
    assert_eq!(same.iter().map(|left| left.reason.as_str()).collect::<Vec<_>>(), ["why"]);
}

#[test]
fn findings_or_pass_passes_only_where_nothing_is_wrong() {
    assert_eq!(findings_or_pass(CheckKind::Form, Vec::new()), [pass_finding(CheckKind::Form)]);
    let wrong = vec![finding(CheckKind::Form, Verdict::Fail, None)];
    assert_eq!(findings_or_pass(CheckKind::Form, wrong.clone()), wrong);
    let pass = pass_finding(CheckKind::Leak);
    assert_eq!((pass.check, pass.verdict, pass.reason.as_str(), pass.span), (CheckKind::Leak, Verdict::Pass, "", None));
}

#[test]
fn check_text_lists_each_check_once_and_in_order_where_nothing_is_wrong() {
    let text = "Walk past the sofa, turn right and walk into the bedroom.";
    let evidence = to_the_bedroom();
    let checked = check_text(text, CheckSubject::closed_world(&evidence, &style(false), None));
    let checks: Vec<CheckKind> = checked.findings.iter().map(|finding| finding.check).collect();
    use CheckKind::{Coverage, Floors, Form, Landmarks, Leak, Order, Turns};
    assert_eq!(checks, [Form, Landmarks, Order, Turns, Floors, Coverage, Leak]);
    assert_eq!((checked.world, checked.verdict()), (CheckWorld::Closed, Verdict::Pass));
}

#[test]
fn check_text_knows_names_that_only_the_evidence_has() {
    let mut path = to_the_bedroom();
    let text = "Walk past the zorble into the bedroom.";
    let checks = |path: &crate::Evidence| {
        let checked = check_text(text, CheckSubject::closed_world(path, &style(false), None));
        let wrong = checked.findings.into_iter().filter(|finding| finding.verdict != Verdict::Pass);
        wrong.map(|finding| finding.check).collect::<Vec<_>>()
    };
    assert!(checks(&path).contains(&CheckKind::Coverage), "no one knows this word");
    path.frames[1].things.push(SeenThing { name: "zorble".into(), ..SeenThing::default() });
    passes(text, &path);
}

#[test]
fn mentions_have_their_kind_their_words_and_their_frame() {
    let mentions = |text: &str, evidence: &crate::Evidence, ends_in_task: bool| {
        let checked = check_text(text, CheckSubject::closed_world(evidence, &style(ends_in_task), None));
        let of = checked.mentions.iter().map(|one| (text[one.span[0]..one.span[1]].to_owned(), one.kind, one.frame));
        of.collect::<Vec<_>>()
    };
    let wanted = |all: &[(&str, MentionKind, usize)]| {
        all.iter().map(|(words, kind, frame)| ((*words).to_owned(), *kind, *frame)).collect::<Vec<_>>()
    };
    use MentionKind::{Floor, Landmark, Room, Target, Turn};
    let text = "Leave the hallway past the sofa, then turn right, go to the bedroom and clean the lamp";
    let places = [("hallway", Room, 0), ("sofa", Landmark, 1)];
    let found = mentions(text, &to_the_bedroom(), true);
    assert_eq!(found[..2], wanted(&places));
    assert_eq!((found[2].1, found[2].2), (Turn, 1));
    assert_eq!(found[3..], wanted(&[("bedroom", Room, 2), ("lamp", Target, 2)]));
    let stop = "Leave the hallway and stop by the lamp.";
    assert_eq!(mentions(stop, &to_the_bedroom(), false), wanted(&[("hallway", Room, 0), ("lamp", Landmark, 2)]));
    let climb = mentions("Go upstairs and stop in the bathroom.", &crate::tests::by_stairs(1, 2), false);
    assert_eq!((climb[0].1, climb[0].2), (Floor, 0));
    // Statements without a frame are not mentioned.
    assert_eq!(mentions("Stop facing north.", &to_the_bedroom(), false), []);
}

#[test]
fn check_own_text_replaces_what_it_failed_and_keeps_other_failures() {
    let video = on_video();
    let own = |text: &str| {
        let checked = check_own_text(text, CheckSubject::closed_world(&video, &style(false), None));
        checked.findings.iter().map(|finding| (finding.check, finding.verdict)).collect::<Vec<_>>()
    };
    use CheckKind::{Coverage, Floors, Form, Landmarks, Leak, Order, Turns};
    use Verdict::{Fail, Pass};
    let passed = |checks: &[CheckKind]| checks.iter().map(|check| (*check, Pass)).collect::<Vec<_>>();
    assert_eq!(own("Walk past the sofa."), passed(&[Form, Landmarks, Order, Turns, Floors, Coverage, Leak]));
    let straight = own("Walk straight past the piano.");
    let before = [(Form, Pass), (Landmarks, Fail), (Order, Pass), (Turns, Fail), (Floors, Pass)];
    assert_eq!(straight, [&before[..], &passed(&[Coverage, Leak])].concat());
}

#[test]
fn check_own_text_is_strict_about_captions_unless_the_writer_saw_the_pictures() {
    let mut evidence = to_the_bedroom();
    evidence.source = EvidenceSource::Captions;
    let style = style(false);
    let places = |own: bool, writer_sees: bool, source: EvidenceSource| {
        let evidence = crate::Evidence { source, ..evidence.clone() };
        let subject = CheckSubject { writer_sees, ..CheckSubject::closed_world(&evidence, &style, None) };
        let text = "Walk past the clock.";
        let checked = if own { check_own_text(text, subject) } else { check_text(text, subject) };
        checked.findings.iter().find(|finding| finding.check == CheckKind::Landmarks).unwrap().verdict
    };
    let captions = EvidenceSource::Captions;
    assert_eq!(places(true, false, captions), Verdict::Fail);
    assert_eq!(places(true, true, captions), Verdict::Unverified);
    assert_eq!(places(false, false, captions), Verdict::Unverified);
    assert_eq!(places(true, false, EvidenceSource::Detector), Verdict::Unverified);
    assert_eq!(places(true, true, EvidenceSource::Labels), Verdict::Fail);
}

#[test]
fn count_objects_meant_needs_a_neighbour_that_is_there_and_close_in_the_text() {
    let mut evidence = to_the_bedroom();
    let lamp = |colour: Option<&str>, turn_rad: Option<f64>| SeenThing {
        name: "lamp".into(),
        colour: colour.map(str::to_owned),
        turn_rad,
        ..SeenThing::default()
    };
    let bed = SeenThing { name: "bed".into(), ..SeenThing::default() };
    evidence.frames[2].things = vec![lamp(Some("green"), Some(-1.0)), lamp(Some("white"), Some(1.0)), bed];
    let count = |text: &str| count_objects_meant(&format!("Go to the bedroom and dust the {text}"), &evidence);
    // The words between are 24 bytes long, and then 28.
    assert_eq!(count("lamp that is closest to the bed"), 1);
    assert_eq!(count("lamp that is the closest to the bed"), 2);
    assert_eq!(count("lamp by the piano"), 2, "no piano is there");
    assert_eq!(count("lamp by the sofa"), 2, "the sofa is not at the end");
    for mark in [",", ";"] {
        assert_eq!(count(&format!("lamp{mark} the bed")), 2, "{mark}");
    }
    assert_eq!(count("lamp on your left"), 1);
    assert_eq!(count("green lamp on your left"), 1);
    assert_eq!(count("green lamp on your right"), 1, "one of them is meant, though none fits");
    assert_eq!(count("sofa"), 0, "it was passed on the way");
}

#[test]
fn count_objects_meant_counts_objects_of_unknown_colour_and_direction() {
    let mut evidence = to_the_bedroom();
    let lamp = |colour: Option<&str>, more: &[&str], turn_rad: Option<f64>| SeenThing {
        name: "lamp".into(),
        colour: colour.map(str::to_owned),
        more_colours: more.iter().map(|colour| (*colour).to_owned()).collect(),
        turn_rad,
        ..SeenThing::default()
    };
    let lamps = [lamp(None, &[], None), lamp(Some("green"), &["red"], Some(1.0)), lamp(Some("white"), &[], Some(-1.0))];
    evidence.frames[2].things = lamps.into();
    let count = |text: &str| count_objects_meant(&format!("Go to the bedroom and dust the {text}"), &evidence);
    assert_eq!(count("lamp"), 3);
    assert_eq!(count("green lamp"), 2);
    assert_eq!(count("red lamp"), 2, "the second colour of a thing counts too");
    assert_eq!(count("white lamp"), 2);
    assert_eq!(count("lamp on your right"), 2);
    assert_eq!(count("white lamp on your right"), 1);
}

#[test]
fn an_empty_path_and_an_empty_text_are_checked_without_a_panic() {
    let nothing = walk(Vec::new(), &[]);
    for text in ["", "Walk past the sofa, turn left and go upstairs to the second floor.", "Stop at the bed."] {
        for evidence in [&nothing, &flat(1), &on_video()] {
            let checked = check_own_text(text, CheckSubject::closed_world(evidence, &style(true), None));
            assert_ne!(checked.verdict(), Verdict::Pass, "{text}");
        }
    }
    fails(CheckKind::Form, "", &walk(vec![frame("hallway", Some(&[]), 1)], &[]));
}
