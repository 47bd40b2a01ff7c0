use super::*;
use proptest::prelude::*;

fn answers(of: &[(u32, u32, f64)]) -> Vec<StudyAnswer<u32, u32>> {
    of.iter().map(|(person, item, value)| StudyAnswer { person: *person, item: *item, value: *value }).collect()
}

/// Answers of different persons to different items, the first `ones` of them 1.
fn independent(count: u32, ones: u32, from: u32) -> Vec<StudyAnswer<u32, u32>> {
    let value = |n| f64::from(u8::from(n < ones));
    (0..count).map(|n| StudyAnswer { person: from + n, item: from + n, value: value(n) }).collect()
}

fn width(interval: Option<ConfidenceInterval>) -> f64 {
    interval.map(|found| found.high - found.low).unwrap()
}

#[test]
fn independent_answers_get_wilsons_interval() {
    let found = answer_share(&independent(30, 25, 0), 0.95).unwrap();
    assert_eq!(found.method, IntervalMethod::Wilson);
    assert_eq!(found.interval, wilson_interval(25.0, 30.0, 0.95));
    assert_eq!((found.answers, found.persons, found.items), (30, 30, 30));
}

#[test]
fn two_answers_of_one_person_make_it_clustered() {
    let mut given = independent(30, 25, 0);
    given[1].person = 0;
    let found = answer_share(&given, 0.95).unwrap();
    assert_eq!((found.method, found.persons, found.items), (IntervalMethod::Clustered, 29, 30));
    let ConfidenceInterval { low, high } = found.interval.unwrap();
    assert!(0.5 < low && low < found.value && found.value < high && high < 1.0, "{found:?}");
}

#[test]
fn answers_that_go_together_widen_the_interval() {
    let of = |value: fn(u32, u32) -> u32| {
        let given: Vec<(u32, u32, f64)> =
            (0..300).map(|n| (n / 10, n % 60, f64::from(value(n / 10, n % 60)))).collect();
        answer_share(&answers(&given), 0.95).unwrap()
    };
    let (by_person, by_item, mixed) =
        (of(|person, _| person % 2), of(|_, item| item % 2), of(|p, i| ((p * 265_443 + i * 40_503) >> 9) % 2));
    assert!(width(by_person.interval) > 1.8 * width(mixed.interval), "{by_person:?} {mixed:?}");
    assert!(width(by_item.interval) > 1.3 * width(mixed.interval), "{by_item:?} {mixed:?}");
}

#[test]
fn equal_answers_count_once_per_person_or_item() {
    let given: Vec<(u32, u32, f64)> = (0..300).map(|n| (n / 10, n % 60, 1.0)).collect();
    let found = answer_share(&answers(&given), 0.95).unwrap();
    assert_eq!(
        (found.method, found.interval, found.se),
        (IntervalMethod::Extreme, wilson_interval(30.0, 30.0, 0.95), None)
    );
    let found = answer_mean(&answers(&given), 0.95).unwrap();
    assert_eq!((found.method, found.interval, found.value), (IntervalMethod::None, None, 1.0));
}

#[test]
fn one_person_with_one_item_gives_no_interval() {
    let found = answer_share(&answers(&[(1, 1, 1.0), (1, 1, 0.0)]), 0.95).unwrap();
    assert_eq!((found.value, found.interval, found.method), (0.5, None, IntervalMethod::None));
    let found = answer_mean(&answers(&[(1, 1, 3.0)]), 0.95).unwrap();
    assert_eq!((found.value, found.interval), (3.0, None));
}

/// The answers of one person to many items, of many persons to one item, and of one to one, show nothing of other persons or items.
#[test]
fn one_person_or_one_item_gives_no_interval_for_any_figure() {
    let value = |n: u32| f64::from(n % 4 / 3);
    let one_item: Vec<_> = (0..20).map(|n| (n, 5, value(n))).collect();
    let one_person: Vec<_> = (0..20).map(|n| (5, n, value(n))).collect();
    let two_items_of_one_person = vec![(5, 1, 0.0), (5, 2, 0.0)];
    let several: Vec<_> = (0..20).map(|n| (n, n + 40, value(n + 1))).collect();
    for given in [one_item, one_person, two_items_of_one_person] {
        let (given, several) = (answers(&given), answers(&several));
        for figure in [answer_share(&given, 0.95).unwrap(), answer_mean(&given, 0.95).unwrap()] {
            assert_eq!((figure.method, figure.interval, figure.se), (IntervalMethod::None, None, None), "{figure:?}");
        }
        for of in [share_difference(&given, &several, 0.95), mean_difference(&several, &given, 0.95)] {
            let of = of.unwrap();
            assert_eq!((of.method, of.interval, of.se), (IntervalMethod::None, None, None), "{of:?}");
        }
    }
}

#[test]
fn share_and_mean_are_none_for_invalid_input() {
    assert_eq!(answer_share::<u32, u32>(&[], 0.95), None);
    assert_eq!(answer_share(&answers(&[(1, 1, 2.0)]), 0.95), None);
    assert_eq!(answer_mean(&answers(&[(1, 1, f64::NAN)]), 0.95), None);
    assert_eq!(answer_mean(&answers(&[(1, 1, 1.0)]), 1.0), None);
    assert_eq!(share_difference(&answers(&[(1, 1, 1.0)]), &[], 0.95), None);
}

/// Newcombe (1998), table II (a): 56 of 70 and 48 of 80, method 10.
#[test]
fn independent_shares_differ_by_newcombes_interval() {
    let found = share_difference(&independent(70, 56, 0), &independent(80, 48, 100), 0.95).unwrap();
    let interval = found.interval.unwrap();
    assert_eq!((found.method, found.correlation), (IntervalMethod::Newcombe, 0.0));
    assert_eq!(format!("{:.4} {:.4}", interval.low, interval.high), "0.0524 0.3339");
}

#[test]
fn effects_of_a_person_on_both_conditions_cancel() {
    let of = |shift: u32, from: u32| -> Vec<StudyAnswer<u32, u32>> {
        let value = |n: u32| f64::from(u8::from((n / 10).is_multiple_of(2) || n % 7 == shift));
        (0..300).map(|n| StudyAnswer { person: from + n / 10, item: n % 60, value: value(n) }).collect()
    };
    let same = share_difference(&of(1, 0), &of(2, 0), 0.95).unwrap();
    let other = share_difference(&of(1, 0), &of(2, 1000), 0.95).unwrap();
    assert!(same.correlation > 0.5, "{same:?}");
    assert!(width(same.interval) < 0.6 * width(other.interval), "{same:?} {other:?}");
}

#[test]
fn means_of_the_same_persons_differ_as_their_pairs_do() {
    let of = |add: f64| -> Vec<StudyAnswer<u32, u32>> {
        (0..20)
            .map(|n| StudyAnswer { person: n, item: n, value: f64::from(n * n % 7) + add * f64::from(n % 3) })
            .collect()
    };
    let found = mean_difference(&of(1.0), &of(0.0), 0.95).unwrap();
    let pairs: Vec<StudyAnswer<u32, u32>> =
        (0..20).map(|n| StudyAnswer { person: n, item: n, value: f64::from(n % 3) }).collect();
    let paired = answer_mean(&pairs, 0.95).unwrap();
    // The same but for the correction: two means were estimated from 40 answers, instead of one from 20.
    assert!((found.value - paired.value).abs() < 1e-12);
    assert!((found.se.unwrap() / paired.se.unwrap() - (39.0_f64 / 38.0).sqrt()).abs() < 1e-12, "{found:?} {paired:?}");
}

fn any_answers() -> impl Strategy<Value = Vec<(u32, u32, f64)>> {
    prop::collection::vec((0..8u32, 0..8u32, (0..2u32).prop_map(f64::from)), 1..40)
}

proptest! {
    #[test]
    fn intervals_hold_their_figure(first in any_answers(), second in any_answers(), level in 0.05..0.999f64) {
        let (first, second) = (answers(&first), answers(&second));
        for figure in [answer_share(&first, level).unwrap(), answer_mean(&first, level).unwrap()] {
            let Some(found) = figure.interval else { continue };
            prop_assert!(found.low <= figure.value + 1e-12 && figure.value <= found.high + 1e-12, "{:?}", figure);
        }
        for of in [share_difference(&first, &second, level).unwrap(), mean_difference(&first, &second, level).unwrap()] {
            let Some(found) = of.interval else { continue };
            prop_assert!(found.low <= of.value + 1e-12 && of.value <= found.high + 1e-12, "{:?}", of);
        }
    }

    #[test]
    fn a_difference_the_other_way_round_has_the_other_sign(first in any_answers(), second in any_answers()) {
        let (first, second) = (answers(&first), answers(&second));
        let (one, other) = (share_difference(&first, &second, 0.95).unwrap(), share_difference(&second, &first, 0.95).unwrap());
        prop_assert!((one.value + other.value).abs() < 1e-12);
        if let (Some(one), Some(other)) = (one.interval, other.interval) {
            prop_assert!((one.low + other.high).abs() < 1e-9 && (one.high + other.low).abs() < 1e-9);
        }
    }

    #[test]
    fn the_order_of_answers_does_not_matter(given in any_answers()) {
        let mut turned = answers(&given);
        turned.reverse();
        let (one, other) = (answer_share(&answers(&given), 0.95).unwrap(), answer_share(&turned, 0.95).unwrap());
        prop_assert!((one.value - other.value).abs() < 1e-12);
        prop_assert!((one.se.unwrap_or_default() - other.se.unwrap_or_default()).abs() < 1e-12);
    }
}
