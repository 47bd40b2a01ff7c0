use super::*;
use std::collections::BTreeSet;
use wayword_language::reading::read_instruction;

fn read_parted(text: &str) -> PartedText {
    PartedText::from_reading(text, &read_instruction(text, &BTreeSet::new()))
}

/// The words of each part.
fn part_words<'a>(text: &'a str, parted: &PartedText) -> Vec<&'a str> {
    parted.parts.iter().map(|part| &text[part.span[0]..part.span[1]]).collect()
}

fn part_kinds(parted: &PartedText) -> Vec<PartKind> {
    parted.parts.iter().map(|part| part.kind).collect()
}

/// Where some words of a text are.
fn span_of(text: &str, words: &str) -> [usize; 2] {
    let from = text.find(words).unwrap();
    [from, from + words.len()]
}

#[test]
fn from_reading_joins_conditions_and_unknown_steps_to_the_step_before() {
    let text = "Leave the attic and turn left. Take a right and a left, then walk on until you reach the globe.";
    let parted = read_parted(text);
    assert_eq!(
        part_words(text, &parted),
        ["Leave the attic", "and turn left", "Take a right and a", "left, then walk on until you reach the globe"]
    );
    assert_eq!(part_kinds(&parted), [PartKind::Exit, PartKind::BareTurn, PartKind::Turn, PartKind::Turn]);
    assert_eq!(parted.parts.iter().map(|part| part.word_count).collect::<Vec<_>>(), [3, 3, 5, 9]);
    let steps: Vec<Range<usize>> = parted.parts.iter().map(|part| part.steps.clone()).collect();
    assert_eq!(steps, [0..1, 1..2, 2..3, 3..6]);
    assert_eq!(parted.guide.len(), 6);
}

#[test]
fn from_reading_begins_with_a_condition_where_no_step_is_before_it() {
    let text = "Once you reach the sofa turn left.";
    let parted = read_parted(text);
    assert_eq!(part_words(text, &parted), ["Once you reach the sofa", "turn left"]);
    assert_eq!(part_kinds(&parted), [PartKind::Condition, PartKind::BareTurn]);
    assert!(read_parted("").parts.is_empty());
}

#[test]
fn from_reading_gives_parts_in_the_order_of_the_text() {
    for text in [
        "Go past the sofa, turn left and go up the stairs. Wait by the lamp.",
        "Go to the attic and dust the globe.",
        "Xyzzy plugh. Walk straight ahead until you see the oven, then stop; wait there.",
        "Verlassen Sie die Küche. Turn right at the Küche.",
    ] {
        let parted = read_parted(text);
        let mut end = 0;
        for part in &parted.parts {
            assert!(part.span[0] >= end && text.get(part.span[0]..part.span[1]).is_some(), "{text}: {part:?}");
            assert!(part.word_count > 0 && !part.steps.is_empty(), "{text}: {part:?}");
            end = part.span[1];
        }
        let steps = parted.parts.iter().flat_map(|part| part.steps.clone());
        assert_eq!(steps.collect::<Vec<_>>(), (0..parted.guide.len()).collect::<Vec<_>>(), "{text}");
    }
}

#[test]
fn from_spans_shifts_the_spans_of_each_part_to_the_whole_text() {
    let text = "Leave the kitchen. Turn left at the sofa.";
    let spans = [span_of(text, "Leave the kitchen"), span_of(text, "Turn left at the sofa")];
    let parted = PartedText::from_spans(text, &spans);
    assert_eq!(parted.parts.iter().map(|part| part.span).collect::<Vec<_>>(), spans);
    assert_eq!(parted.parts.iter().map(|part| part.word_count).collect::<Vec<_>>(), [3, 5]);
    let steps = |part: usize| &parted.guide.steps[parted.parts[part].steps.clone()];
    let names = |part: usize| {
        let mentions = steps(part).iter().flat_map(|step| &step.mentions).filter_map(|mention| mention.span);
        mentions.map(|[from, to]| &text[from..to]).collect::<Vec<_>>()
    };
    assert_eq!((names(0), names(1)), (vec!["kitchen"], vec!["sofa"]));
    let turns: Vec<&str> =
        steps(1).iter().filter_map(|step| step.step.turn_span).map(|[from, to]| &text[from..to]).collect();
    assert!(matches!(&turns[..], [words] if words.to_lowercase().contains("left")), "{turns:?}");
    let step_span = steps(1)[0].step.span;
    assert!(text[step_span[0]..step_span[1]].starts_with("Turn left"), "{step_span:?}");
    assert!(parted.guide.names_room("kitchen") && !parted.guide.names_room("garage"));
}

#[test]
fn from_spans_reads_each_part_alone() {
    let text = "Do not turn left";
    assert!(read_parted(text).parts_with_turn(Side::Left).is_empty(), "the whole text denies the turn");
    let parted = PartedText::from_spans(text, &[span_of(text, "Do not"), span_of(text, "turn left")]);
    assert_eq!(parted.parts_with_turn(Side::Left), [1]);
    // Alone it is a text without a way, but here it is a piece of one.
    let text = "Turn right. Go to the sofa.";
    let parted = PartedText::from_spans(text, &[span_of(text, "Turn right"), span_of(text, "Go to the sofa")]);
    assert_eq!(part_kinds(&parted), [PartKind::BareTurn, PartKind::Go]);
    assert!(!parted.guide.is_goal && parted.guide.steps.iter().all(|step| step.kind != GuideStepKind::Goal));
}

#[test]
fn a_span_outside_the_text_makes_a_part_without_words() {
    let text = "Turn left, über den Hof.";
    let inside_a_letter = text.find('ü').unwrap() + 1;
    let spans = [[0, 9], [9, 99], [7, 2], [inside_a_letter, text.len()], [10, 10]];
    let parted = PartedText::from_spans(text, &spans);
    assert_eq!(parted.parts.iter().map(|part| part.span).collect::<Vec<_>>(), spans);
    assert_eq!(parted.parts[0].word_count, 2);
    for part in &parted.parts[1..] {
        assert!(part.word_count == 0 && part.steps.is_empty() && part.kind == PartKind::Other, "{part:?}");
    }
}

#[test]
fn a_part_has_the_kind_of_its_most_important_content() {
    use PartKind::{BareTurn, Climb, Condition, Enter, Exit, Go, Other, Pass, Stop, Straight, Turn, TurnAround};
    let cases = [
        ("Turn left", BareTurn),
        ("And then turn right", BareTurn),
        ("Turn left at the end of the long hallway", Turn),
        ("Turn around", TurnAround),
        ("Go up the stairs", Climb),
        ("Stop by the sofa", Stop),
        ("Leave the kitchen", Exit),
        ("Enter the kitchen", Enter),
        ("Walk past the sofa", Pass),
        ("Walk straight ahead", Straight),
        ("Until you reach the sofa", Condition),
        ("Go to the sofa", Go),
        ("Xyzzy plugh", Other),
        ("...", Other),
    ];
    for (text, kind) in cases {
        assert_eq!(part_kinds(&PartedText::from_spans(text, &[[0, text.len()]])), [kind], "{text}");
    }
}

#[test]
fn parts_with_turn_and_climb_are_found_by_their_steps() {
    let parted = read_parted("Turn left. Walk past the sofa. Turn right. Go up the stairs. Turn around. Turn left.");
    assert_eq!(parted.parts.len(), 6);
    assert_eq!(parted.parts_with_turn(Side::Left), [0, 5]);
    assert_eq!(parted.parts_with_turn(Side::Right), [2]);
    assert_eq!(parted.parts_with_climb(), [3]);
    let climbs: Vec<_> = parted.parts.iter().filter_map(|part| part.climb(&parted.guide)).collect();
    assert_eq!(climbs, [ClimbDirection::Up]);
    assert_eq!(parted.parts[4].turn_side(&parted.guide), None, "a turn around has no side");
}
