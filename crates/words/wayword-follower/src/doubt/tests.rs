use super::*;
use crate::{KnownBuilding, tests::surveyed};
use wayword_core::{CheckFinding, CheckKind, DoubtGrade, TextAmbiguity, Verdict, doubt::separate_doubts, seeded_rng};

const TO_KITCHEN: &str = "Walk down the hallway and turn right. Walk into the kitchen and wait by the oven.";
const WALK: [usize; 5] = [0, 1, 2, 5, 6];

fn found(text: &str, bounds: &DoubtBounds) -> Vec<TextDoubt> {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &WALK, heading_rad: 0.0 };
    let (spelt, guide) = (TokenisedText::from_text(text), Guide::read_text(text));
    separate_doubts(text, find_doubts(&spelt, &guide, known, FeatureWeights::fitted(), (bounds, &[])))
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
        &TokenisedText::from_text(text),
        &Guide::read_text(text),
        known,
        FeatureWeights::fitted(),
        (&DoubtBounds::default(), &findings),
    );
    let doubts = separate_doubts(text, doubts);
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
    let guide = Guide::from_reading(&reading);
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
    let (spelt, guide) = (TokenisedText::from_text(&text), Guide::read_text(&text));
    let doubts = separate_doubts(&text, find_doubts(&spelt, &guide, known, FeatureWeights::fitted(), found));
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
        assert!(all.len() <= wayword_core::doubt::MAX_DOUBTS, "{text}");
        assert!(all.windows(2).all(|pair| pair[0].span[1] <= pair[1].span[0]), "{text}");
        for doubt in &all {
            assert!(text.get(doubt.span[0]..doubt.span[1]).is_some_and(|words| !words.is_empty()), "{text}");
            assert!(doubt.alternatives.len() <= MAX_ALTERNATIVES, "{text}");
        }
    }
}

fn alternative(words: Option<&str>, gain: Option<f64>) -> DoubtAlternative {
    DoubtAlternative { words: words.map(str::to_owned), gain }
}

fn site(source: DoubtSource, span: [usize; 2], gains: &[f64]) -> DoubtSite {
    let alternatives = gains.iter().map(|gain| alternative(Some("w"), Some(*gain))).collect();
    DoubtSite { source, span, alternatives }
}

/// The sites of one source in a text about the walk to the kitchen: the words, and each alternative with its gain.
fn sites_of(text: &str, source: DoubtSource) -> Vec<(&str, Vec<(String, f64)>)> {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &WALK, heading_rad: 0.0 };
    let spelt = TokenisedText::from_text(text);
    let sites = find_sites(&spelt, &Guide::read_text(text), known, FeatureWeights::fitted());
    let words = |one: DoubtAlternative| (one.words.unwrap_or_else(|| "-".to_owned()), one.gain.unwrap());
    sites
        .into_iter()
        .filter(|site| site.source == source)
        .map(|site| (&text[site.span[0]..site.span[1]], site.alternatives.into_iter().map(words).collect()))
        .collect()
}

/// How well a text fits the walk to the kitchen. Its steps count as having the marking words of another text, because a
/// change of a step leaves these.
fn score(text: &str, marks_of: &str) -> f64 {
    let building = KnownBuilding::from_survey(&surveyed());
    let (mut guide, other) = (Guide::read_text(text), Guide::read_text(marks_of));
    assert_eq!(guide.len(), other.len());
    guide.steps.iter_mut().zip(other.steps).for_each(|(told, other)| told.step.marks = other.step.marks);
    OneWalk::new(&building, &WALK, 0.0, FeatureWeights::fitted()).score(&guide)
}

/// Checks that each alternative for some words gains what the whole text with it gains.
fn assert_gains(text: &str, source: DoubtSource, words: &str) {
    let sites = sites_of(text, source).into_iter().filter(|site| site.0 == words).collect::<Vec<_>>();
    assert_eq!(sites.len(), 1, "{text} {source:?}");
    for (words, alternatives) in sites {
        for (other, gain) in alternatives {
            let changed = text.replacen(words, &other, 1);
            let expected = score(&changed, text) - score(text, text);
            assert!((expected - gain).abs() < 1e-9, "{changed}: {gain} {expected}");
        }
    }
}

#[test]
fn doubt_source_has_a_name_and_a_reason_for_each_kind() {
    let names = [
        "turn",
        "turn left out",
        "side",
        "climb",
        "step left out",
        "way by a place",
        "place",
        "unknown place",
        "places swapped",
    ];
    assert_eq!(DoubtSource::ALL.map(DoubtSource::name), names);
    let reasons = [
        "other side here",
        "not turn",
        "it may be on the other",
        "stairs",
        "no stretch",
        "go by it",
        "something else",
        "not have this",
        "two places",
    ];
    for (source, words) in DoubtSource::ALL.into_iter().zip(reasons) {
        assert!(source.doubt_reason().contains(words), "{source:?}");
    }
}

#[test]
fn grade_gain_needs_more_than_the_bounds() {
    let bounds = DoubtBounds::default();
    let expected =
        [(1.0, 2.0), (2.0, 2.7), (1.4, 1.7), (0.1, 0.2), (5.3, 5.7), (1.8, 2.2), (3.6, 4.2), (2.0, 2.2), (2.4, 3.0)];
    for (source, (uncertain, likely)) in DoubtSource::ALL.into_iter().zip(expected) {
        assert_eq!(bounds.for_source(source), DoubtBound { uncertain, likely });
        let grades = [uncertain, uncertain + 0.01, likely, likely + 0.01].map(|gain| bounds.grade_gain(source, gain));
        let (unsure, sure) = (Some(DoubtGrade::Uncertain), Some(DoubtGrade::Likely));
        assert_eq!(grades, [None, unsure, unsure, sure]);
    }
}

#[test]
fn to_doubt_keeps_the_alternatives_that_gain() {
    let site = site(DoubtSource::Turn, [3, 7], &[2.0, 0.5, 0.0, -1.0]);
    let doubt = site.to_doubt(DoubtGrade::Likely);
    assert_eq!((doubt.span, doubt.grade, doubt.cause), ([3, 7], DoubtGrade::Likely, DoubtCause::Change));
    assert_eq!(doubt.alternatives.iter().filter_map(|one| one.gain).collect::<Vec<_>>(), [2.0, 0.5]);
    assert_eq!(doubt.reason, DoubtSource::Turn.doubt_reason());
    assert_eq!(site.best_gain(), 2.0);
    let worse = DoubtSite { alternatives: vec![alternative(None, Some(-3.0)), alternative(None, None)], ..site };
    assert_eq!(worse.best_gain(), -3.0);
    assert_eq!(DoubtSite::from_alternatives(DoubtSource::Turn, [0, 1], Vec::new()), None);
    assert!(DoubtSite::from_alternatives(DoubtSource::Turn, [0, 1], worse.alternatives).is_some());
}

#[test]
fn is_within_needs_both_ends_inside() {
    assert!(is_within([3, 5], [3, 5]) && is_within([3, 5], [2, 6]));
    assert!(!is_within([2, 5], [3, 5]) && !is_within([3, 6], [3, 5]) && !is_within([0, 1], [3, 5]));
}

#[test]
fn best_first_sorts_by_gain_and_drops_what_has_none() {
    let gains = [Some(1.0), None, Some(f64::NAN), Some(3.0), Some(f64::INFINITY), Some(-2.0), Some(2.0)];
    let best = best_first(gains.into_iter().map(|gain| alternative(None, gain)));
    assert_eq!(best.iter().filter_map(|one| one.gain).collect::<Vec<_>>(), [3.0, 2.0, 1.0]);
}

#[test]
fn offered_doubt_depends_on_the_source_and_on_the_cause() {
    use DoubtSource::{Climb, NoStep, NoTurn, Place, Side, Swap, Turn, Unknown, Way};
    let doubt = |cause| TextDoubt {
        span: [3, 7],
        grade: DoubtGrade::Uncertain,
        cause,
        reason: "r".into(),
        alternatives: Vec::new(),
    };
    let offers = |source, span, cause| offered_doubt(&site(source, span, &[1.0]), &doubt(cause)).is_some();
    for (cause, is_wrong) in [(DoubtCause::Wrong, true), (DoubtCause::Unverified, false)] {
        for source in [Place, Unknown] {
            assert!(offers(source, [3, 7], cause) && offers(source, [4, 5], cause));
        }
        for source in [Turn, NoTurn, Climb] {
            assert_eq!((offers(source, [3, 7], cause), offers(source, [4, 5], cause)), (is_wrong, is_wrong));
        }
        for source in [Side, NoStep, Swap, Way] {
            assert_eq!((offers(source, [3, 7], cause), offers(source, [4, 5], cause)), (is_wrong, false), "{source:?}");
        }
    }
    let way = offered_doubt(&site(Way, [3, 7], &[-1.0, -2.0]), &doubt(DoubtCause::Wrong)).unwrap();
    assert_eq!(way.alternatives, [alternative(Some("w"), None)], "the best one, even if it gains nothing");
    let place = offered_doubt(&site(Place, [3, 7], &[-1.0, -2.0]), &doubt(DoubtCause::Wrong)).unwrap();
    assert_eq!((place.alternatives, place.grade), (vec![], DoubtGrade::Uncertain));
}

#[test]
fn find_sites_finds_none_in_an_empty_or_too_long_text() {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &WALK, heading_rad: 0.0 };
    let count = |text: &str| {
        let (spelt, guide) = (TokenisedText::from_text(text), Guide::read_text(text));
        (is_too_long(&guide), find_sites(&spelt, &guide, known, FeatureWeights::fitted()).is_empty())
    };
    assert_eq!(count(""), (false, true));
    assert_eq!(count(&"Turn left. ".repeat(60)), (false, false));
    assert_eq!(count(&"Turn left. ".repeat(61)), (true, true));
}

#[test]
fn find_sites_changes_turns_sides_climbs_and_steps_in_the_text_s_own_words() {
    let text = "Turn Left. Go up the stairs. Stop by the oven on your right.";
    let words = |source| {
        let sites = sites_of(text, source).into_iter();
        sites.map(|(words, others)| (words, others[0].0.clone())).collect::<std::collections::BTreeSet<_>>()
    };
    let all = |pairs: &[(&'static str, &str)]| pairs.iter().map(|(a, b)| (*a, (*b).to_owned())).collect();
    assert_eq!(words(DoubtSource::Turn), all(&[("Turn Left", "Turn Right")]));
    assert_eq!(words(DoubtSource::NoTurn), all(&[("Turn Left", "-")]));
    assert_eq!(words(DoubtSource::Climb), all(&[("up", "down")]));
    assert_eq!(words(DoubtSource::Side), all(&[("on your right", "on your left")]));
    let steps = words(DoubtSource::NoStep);
    assert!(steps.len() == 3 && steps.iter().all(|(_, other)| other == "-"), "{steps:?}");
    assert_gains(text, DoubtSource::Turn, "Turn Left");
    assert_gains(text, DoubtSource::Climb, "up");
    assert_gains(text, DoubtSource::Side, "on your right");
    let down = "Go down the stairs. Stop by the oven.";
    assert_eq!(sites_of(down, DoubtSource::Climb)[0].1[0].0, "up");
}

#[test]
fn way_sites_try_the_other_prepositions_that_a_place_allows() {
    let text = "Walk past the plant. Turn right. Walk through the kitchen.";
    let sites = sites_of(text, DoubtSource::Way);
    assert_eq!(sites.iter().map(|(words, _)| *words).collect::<Vec<_>>(), ["Walk past", "Walk through"]);
    assert_eq!(sites[0].1.iter().map(|(words, _)| &**words).collect::<Vec<_>>(), ["Walk to"]);
    assert_eq!(sites[1].1.len(), 3, "the best of five");
    assert!(
        sites[1]
            .1
            .iter()
            .all(|(words, _)| ["Walk to", "Walk past", "Walk into", "Walk out of", "Walk along"].contains(&&**words))
    );
    assert!(sites[1].1.windows(2).all(|pair| pair[0].1 >= pair[1].1));
    assert_gains(text, DoubtSource::Way, "Walk past");
    assert!(sites_of("Go to the kitchen and clean the oven.", DoubtSource::Way).is_empty(), "it describes no way");
    let beside = "Turn right. Stop next to the oven.";
    assert!(sites_of(beside, DoubtSource::Way).is_empty());
}

#[test]
fn other_place_sites_try_the_rooms_and_things_along_the_walk() {
    let text = "Walk past the bed. Turn right. Walk into the bedroom and stop by an oven.";
    let words = |source| {
        let sites = sites_of(text, source).into_iter();
        sites
            .map(|(words, others)| (words, others.into_iter().map(|(other, _)| other).collect::<Vec<_>>()))
            .collect::<Vec<_>>()
    };
    let places = words(DoubtSource::Place);
    assert_eq!(places.iter().map(|(words, _)| *words).collect::<Vec<_>>(), ["bed", "bedroom", "an oven"]);
    let sorted = |mut names: Vec<String>| {
        names.sort();
        names
    };
    assert_eq!(sorted(places[1].1.clone()), ["hallway", "kitchen"]);
    assert!(words(DoubtSource::Unknown).is_empty());
    assert_gains(text, DoubtSource::Place, "bed");
    assert_gains(text, DoubtSource::Place, "an oven");
    let unknown = sites_of("Walk past the piano and turn right.", DoubtSource::Unknown);
    assert_eq!(unknown[0].0, "piano");
    assert!(sites_of("Walk past the bright piano and turn right.", DoubtSource::Unknown).is_empty(), "of it alone");
}

#[test]
fn swap_sites_offer_each_of_two_places_for_the_other() {
    let text = "Walk past the Oven. Turn right and stop at the plant.";
    let sites = sites_of(text, DoubtSource::Swap);
    assert_eq!(
        sites.iter().map(|(words, others)| (*words, &*others[0].0)).collect::<Vec<_>>(),
        [("Oven", "Plant"), ("plant", "oven")]
    );
    let swapped = score("Walk past the plant. Turn right and stop at the oven.", text) - score(text, text);
    assert!(sites.iter().all(|(_, others)| (others[0].1 - swapped).abs() < 1e-9));
    assert!(swapped > 0.0);
}

#[test]
fn a_turn_that_a_check_could_not_decide_keeps_its_words_and_is_not_left_out() {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &WALK, heading_rad: 0.0 };
    let doubt = |text: &str, words: &str, verdict| {
        let from = text.find(words).unwrap();
        let finding = CheckFinding {
            check: CheckKind::Turns,
            verdict,
            reason: "r".into(),
            span: Some([from, from + words.len()]),
        };
        let (bounds, guide) = (DoubtBounds::default(), Guide::read_text(text));
        let spelt = TokenisedText::from_text(text);
        let doubts = find_doubts(&spelt, &guide, known, FeatureWeights::fitted(), (&bounds, &[finding]));
        let words = doubts[0].alternatives.iter().map(|one| one.words.clone()).collect::<Vec<_>>();
        (text[doubts[0].span[0]..doubts[0].span[1]].to_owned(), words)
    };
    let text = TO_KITCHEN.replace("turn right", "turn left");
    assert_eq!(doubt(&text, "left", Verdict::Unverified), ("left".to_owned(), vec![]));
    let (words, others) = doubt(&text, "left", Verdict::Fail);
    assert_eq!((&*words, others[0].as_deref()), ("turn left", Some("turn right")));
    // Where the other side gains nothing, the turn may be left out.
    let (words, others) = doubt(TO_KITCHEN, "right", Verdict::Fail);
    assert_eq!((&*words, others[0].as_deref()), ("turn right", None));
    // A whole text cannot be left out.
    assert_eq!(doubt("Walk on.", "Walk on", Verdict::Fail).1, []);
}

#[test]
fn doubts_from_ambiguity_mark_the_last_step_where_no_step_stops() {
    let doubts = |text: &str, ends, by: Option<&str>| {
        let reading = wayword_language::reading::read_instruction(text, &std::collections::BTreeSet::new());
        let guide = Guide::from_reading(&reading);
        let ambiguity = TextAmbiguity { ends, objects: 1, told_apart_by: by.map(str::to_owned), unverified: None };
        let doubts = from_checks::doubts_from_ambiguity(text, &guide, &reading, &ambiguity);
        assert!(doubts.iter().all(|doubt| doubt.reason.contains("3 places") && doubt.cause == DoubtCause::Ambiguous));
        told(text, &doubts).into_iter().map(|(words, other)| (words.to_owned(), other.concat())).collect::<Vec<_>>()
    };
    let named = |words: &str, other: &str| vec![(words.to_owned(), other.to_owned())];
    assert_eq!(doubts("Walk past the sofa. Walk on.", Some(3), None), named("Walk on", ""));
    assert_eq!(
        doubts("Wait by the sofa. Walk to the lamp.", Some(3), Some("piano")),
        named("sofa", "sofa by the piano")
    );
    assert_eq!(doubts("Walk to the lamp.", Some(3), Some("attic")), named("lamp", "lamp in the attic"));
    for (text, by) in
        [("Walk to the stairs.", "stairs"), ("Stop at the chair.", "dining chair"), ("Wait in the attic.", "attic")]
    {
        let told = doubts(text, Some(3), Some(by));
        assert!(told.len() == 1 && told[0].1.is_empty(), "{told:?}");
    }
    assert_eq!(doubts("Walk to the lamp.", None, Some("attic")), []);
    assert_eq!(doubts("Walk to the lamp.", Some(1), Some("attic")), []);
}

#[test]
fn words_about_a_place_keep_their_range_beside_a_turn_and_only_wrong_ones_may_be_left_out() {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &WALK, heading_rad: 0.0 };
    let doubt = |words: &str, verdict| {
        let from = TO_KITCHEN.find(words).unwrap();
        let finding = CheckFinding {
            check: CheckKind::Landmarks,
            verdict,
            reason: "r".into(),
            span: Some([from, from + words.len()]),
        };
        let (bounds, guide) = (DoubtBounds::default(), Guide::read_text(TO_KITCHEN));
        let spelt = TokenisedText::from_text(TO_KITCHEN);
        let doubts = find_doubts(&spelt, &guide, known, FeatureWeights::fitted(), (&bounds, &[finding]));
        let [from, to] = doubts[0].span;
        (&TO_KITCHEN[from..to], doubts[0].alternatives.clone())
    };
    // The text has a turn too, but these words are not about it.
    let (words, others) = doubt("Walk into the kitchen", Verdict::Fail);
    assert_eq!((words, others.first()), ("Walk into the kitchen", Some(&alternative(None, None))));
    let (words, others) = doubt("kitchen", Verdict::Unverified);
    assert_eq!(words, "kitchen");
    assert!(others.iter().all(|other| other.words.is_some()), "{others:?}");
}
