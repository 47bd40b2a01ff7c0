use super::*;

type Choice = SystemComparison<u32, u32, &'static str>;

/// Choices by one person each about one item each.
fn choices(of: &[(&'static str, &'static str, PairPreference, u32)]) -> Vec<Choice> {
    let all = of.iter().flat_map(|choice| std::iter::repeat_n(choice, choice.3 as usize));
    let one = |(at, (first, second, preference, _)): (u32, &(&'static str, &'static str, PairPreference, u32))| {
        SystemComparison { person: at, item: at, first: *first, second: *second, preference: *preference }
    };
    (0..).zip(all).map(one).collect()
}

use PairPreference::{BothBad, First, Second, Tie};

#[test]
fn the_odds_of_two_systems_are_their_wins() {
    let found = bradley_terry(
        &choices(&[("a", "b", First, 30), ("a", "b", Second, 10), ("b", "a", First, 10), ("b", "a", Second, 30)]),
        0.95,
    );
    let found = found.unwrap();
    let [a, b] = [&found.strengths[0], &found.strengths[1]];
    assert_eq!((a.system, a.wins, a.losses, b.wins, b.losses), ("a", 60, 20, 20, 60));
    assert!((a.term.value - b.term.value - 3.0_f64.ln()).abs() < 1e-12, "{found:?}");
    assert!(found.side.value.abs() < 1e-12 && found.tie.is_none(), "{found:?}");
    // The error of a log odds from 60 and 20 answers, half of it for the strength above the mean.
    let usual = (1.0_f64 / 60.0 + 1.0 / 20.0).sqrt() / 2.0;
    assert!((a.term.se / usual - 1.0).abs() < 0.03, "{found:?}");
}

#[test]
fn a_side_and_ties_have_their_own_terms() {
    let of = [
        ("a", "b", First, 40),
        ("a", "b", Second, 10),
        ("a", "b", Tie, 20),
        ("b", "a", First, 40),
        ("b", "a", Second, 10),
        ("b", "a", BothBad, 20),
    ];
    let found = bradley_terry(&choices(&of), 0.95).unwrap();
    assert!(found.strengths.iter().all(|strength| strength.term.value.abs() < 1e-12), "{found:?}");
    assert!((found.side.value - 4.0_f64.ln()).abs() < 1e-12, "{found:?}");
    // A tie has the geometric mean of 40 and 10 times Davidson's parameter: 20.
    assert!(found.tie.unwrap().value.abs() < 1e-12, "{found:?}");
    assert_eq!((found.strengths[0].ties, found.strengths[0].both_bad), (40, 20));
}

#[test]
fn bradley_terry_reports_why_there_are_no_strengths() {
    let why = |of: &[(&'static str, &'static str, PairPreference, u32)]| bradley_terry(&choices(of), 0.95).unwrap_err();
    let names = |of: &[&str]| of.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    assert_eq!(why(&[]), NoStrength::NoChoices);
    assert_eq!(why(&[("a", "a", First, 1)]), NoStrength::Itself);
    assert_eq!(why(&[("a", "b", Tie, 4), ("b", "a", BothBad, 2)]), NoStrength::OnlyTies);
    let apart = why(&[("a", "b", First, 3), ("a", "b", Second, 3), ("c", "d", Tie, 3)]);
    assert_eq!(apart, NoStrength::Unconnected { groups: vec![names(&["a", "b"]), names(&["c", "d"])] });
    assert_eq!(apart.to_string(), "no choice connects a, b | c, d");
    let never = why(&[("a", "b", First, 3), ("b", "a", First, 3), ("c", "a", First, 3), ("b", "c", Second, 1)]);
    assert_eq!(never, NoStrength::Separated { above: names(&["c"]), below: names(&["a", "b"]) });
    assert_eq!(never.to_string(), "c never lost to a, b, nor tied");
    assert_eq!(why(&[("a", "b", First, 3), ("a", "b", Second, 3)]), NoStrength::Sides);
    assert_eq!(why(&[("a", "b", First, 3), ("b", "a", First, 3)]), NoStrength::Endless);
}

#[test]
fn one_person_with_one_item_gives_no_interval() {
    let mut of = choices(&[("a", "b", First, 3), ("a", "b", Second, 2), ("b", "a", First, 2), ("b", "a", Second, 2)]);
    of.iter_mut().for_each(|choice| (choice.person, choice.item) = (1, 1));
    assert_eq!(bradley_terry(&of, 0.95), Err(NoStrength::OneSource));
}

#[test]
fn choices_of_the_same_persons_widen_the_interval() {
    let apart =
        choices(&[("a", "b", First, 30), ("b", "a", First, 30), ("a", "b", Second, 20), ("b", "a", Second, 20)]);
    let mut together = apart.clone();
    for choice in &mut together {
        let is_a = (choice.first == "a") == (choice.preference == First);
        choice.person = choice.person % 10 + if is_a { 0 } else { 10 };
    }
    let of = |choices: &[Choice]| bradley_terry(choices, 0.95).unwrap().strengths[0].term.se;
    assert!(of(&together) > 1.8 * of(&apart));
}
