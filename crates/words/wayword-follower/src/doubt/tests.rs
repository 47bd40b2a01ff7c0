use super::*;
use crate::{KnownBuilding, tests::surveyed};
use wayword_core::{CheckFinding, CheckKind, DoubtGrade, TextAmbiguity, Verdict, doubt::apart_in, seeded_rng};

const TO_KITCHEN: &str = "Walk down the hallway and turn right. Walk into the kitchen and wait by the oven.";
const WALK: [usize; 5] = [0, 1, 2, 5, 6];

fn found(text: &str, bounds: &DoubtBounds) -> Vec<TextDoubt> {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &WALK, heading_rad: 0.0 };
    apart_in(text, find_doubts(text, &Guide::read_text(text), known, FeatureWeights::fitted(), (bounds, &[])))
}

/// The doubted words, each with what may stand there; "-" where they may be left out.
fn told<'a>(text: &'a str, doubts: &'a [TextDoubt]) -> Vec<(&'a str, Vec<&'a str>)> {
    let alternatives = |doubt: &'a TextDoubt| doubt.alternatives.iter().map(|one| one.words.as_deref().unwrap_or("-"));
    doubts.iter().map(|doubt| (&text[doubt.span[0]..doubt.span[1]], alternatives(doubt).collect())).collect()
}

#[test]
fn a_text_that_fits_its_walk_is_not_doubted() {
    assert_eq!(found(TO_KITCHEN, &DoubtBounds::default()), []);
}

#[test]
fn a_wrong_turn_is_doubted_and_the_other_side_is_offered_in_the_text_s_own_words() {
    let text = TO_KITCHEN.replace("turn right", "make a sharp Left turn");
    let found = found(&text, &DoubtBounds::default());
    let told = told(&text, &found);
    assert_eq!(told[0].0, "make a sharp Left turn");
    assert!(told[0].1.contains(&"make a sharp Right turn"), "{told:?}");
    assert_eq!(found[0].grade, DoubtGrade::Likely);
}

#[test]
fn failed_words_may_be_left_out_and_unverified_ones_get_names() {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &WALK, heading_rad: 0.0 };
    let text = "Walk down the hallway. Walk down the hallway and turn right. Walk past the bed and wait by the oven.";
    let span = |words: &str| text.rfind(words).map(|from| [from, from + words.len()]);
    let finding = |check, verdict, words| CheckFinding { check, verdict, reason: "r".into(), span: span(words) };
    let findings = [
        finding(CheckKind::Order, Verdict::Fail, "Walk down the hallway"),
        finding(CheckKind::Landmarks, Verdict::Unverified, "bed"),
    ];
    let doubts = find_doubts(
        text,
        &Guide::read_text(text),
        known,
        FeatureWeights::fitted(),
        (&DoubtBounds::default(), &findings),
    );
    let doubts = apart_in(text, doubts);
    let told = told(text, &doubts);
    assert_eq!((told[0].0, told[0].1.first()), ("Walk down the hallway", Some(&"-")), "{told:?}");
    let bed = told.iter().find(|(words, _)| *words == "bed");
    assert!(bed.is_some_and(|(_, offered)| !offered.is_empty()), "{told:?}");
}

#[test]
fn a_room_that_is_not_there_is_doubted_and_the_one_that_is_there_is_offered() {
    let text = TO_KITCHEN.replace("kitchen", "bedroom");
    let found = found(&text, &DoubtBounds::default());
    let told = told(&text, &found);
    let room = told.iter().find(|(words, _)| *words == "bedroom");
    assert!(room.is_some_and(|(_, offered)| offered.contains(&"kitchen")), "{told:?}");
}

#[test]
fn of_findings_ignores_form_and_unknown_words() {
    let finding = |check, verdict| CheckFinding { check, verdict, reason: "r".into(), span: Some([0, 4]) };
    let findings = [
        finding(CheckKind::Form, Verdict::Fail),
        finding(CheckKind::Coverage, Verdict::Unverified),
        finding(CheckKind::Turns, Verdict::Pass),
        finding(CheckKind::Turns, Verdict::Fail),
        finding(CheckKind::Landmarks, Verdict::Unverified),
    ];
    let doubts: Vec<_> =
        from_checks::doubts_from_findings(&findings).into_iter().map(|doubt| (doubt.grade, doubt.cause)).collect();
    assert_eq!(doubts, [(DoubtGrade::Likely, DoubtCause::Wrong), (DoubtGrade::Uncertain, DoubtCause::Unverified)]);
}

#[test]
fn of_ambiguity_suggests_a_name_that_identifies_the_end() {
    let text = "Walk on and stop at the door. Then clean the lamp.";
    let reading = wayword_language::reading::read_instruction(text, &std::collections::BTreeSet::new());
    let guide = Guide::from_reading(text, &reading);
    let ambiguity =
        TextAmbiguity { ends: Some(2), objects: 3, told_apart_by: Some("kitchen".into()), unverified: None };
    let doubts = from_checks::doubts_from_ambiguity(text, &guide, &reading, &ambiguity);
    assert_eq!(told(text, &doubts), [("door", vec!["door in the kitchen"]), ("lamp", vec![])]);
    let clear = TextAmbiguity { ends: Some(1), objects: 1, ..ambiguity };
    assert_eq!(from_checks::doubts_from_ambiguity(text, &guide, &reading, &clear), []);
}

#[test]
fn a_turn_that_a_check_found_wrong_is_doubted_as_a_whole_and_the_other_side_comes_first() {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &WALK, heading_rad: 0.0 };
    let text = TO_KITCHEN.replace("turn right", "turn left");
    let from = text.find("left").unwrap();
    let finding = CheckFinding {
        check: CheckKind::Turns,
        verdict: Verdict::Fail,
        reason: "r".into(),
        span: Some([from, from + 4]),
    };
    let found = (&DoubtBounds::default(), &[finding][..]);
    let doubts = apart_in(&text, find_doubts(&text, &Guide::read_text(&text), known, FeatureWeights::fitted(), found));
    let told = told(&text, &doubts);
    assert_eq!((told[0].0, told[0].1.first()), ("turn left", Some(&"turn right")), "{told:?}");
    assert_eq!(doubts[0].cause, DoubtCause::Wrong);
}

/// Texts of words that the follower knows and of others, with a doubt for every change of any gain.
#[test]
fn doubts_never_overlap_and_are_few() {
    const WORDS: [&str; 28] = [
        "walk", "turn", "left", "right", "up", "down", "the", "a", "an", "stairs", "kitchen", "bedroom", "oven", "bed",
        "plant", "past", "into", "and", "then", ".", ",", "stop", "on your", "Türe", "門", "🪑", "LEFT", "exit",
    ];
    use rand::seq::IndexedRandom;
    let mut random = seeded_rng(3, &["doubt", "texts"]);
    for _ in 0..150 {
        let words: Vec<&str> = (0..14).filter_map(|_| WORDS.choose(&mut random).copied()).collect();
        let text = words.join(" ");
        let all = found(&text, &DoubtBounds::all());
        assert!(all.len() <= wayword_core::doubt::MOST_DOUBTS, "{text}");
        assert!(all.windows(2).all(|pair| pair[0].span[1] <= pair[1].span[0]), "{text}");
        for doubt in &all {
            assert!(text.get(doubt.span[0]..doubt.span[1]).is_some_and(|words| !words.is_empty()), "{text}");
            assert!(doubt.alternatives.len() <= MOST_ALTERNATIVES, "{text}");
        }
    }
}
