//! Our figures of studies against those of statsmodels, SciPy, NumPy and krippendorff (`fixtures/make_study.py`).

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::Value;
use std::fmt::Debug;
use wayword_metrics::{
    AnswerScale, ConfidenceInterval, PairPreference, StudyAnswer, SystemComparison, answer_mean, answer_share,
    bradley_terry, clustered_interval_from_draws, krippendorff_alpha, mean_difference, share_difference,
    wilson_interval,
};

const LEVEL: f64 = 0.95;
/// Tolerances: for figures that a formula gives, and for figures that an iteration gives.
const EXACT: f64 = 1e-9;
const ITERATED: f64 = 1e-6;

/// Knuth's generator (MMIX), as the script has it.
struct Lcg(u64);

impl Lcg {
    fn new(seed: u64) -> Self {
        let mut new = Self(seed);
        (0..4).for_each(|_| _ = new.next());
        new
    }

    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }
}

/// The answers of a study, each part in the order of the script's rows.
#[derive(Default)]
struct Study {
    is_second: Vec<bool>,
    success: Vec<StudyAnswer<usize, usize>>,
    value: Vec<StudyAnswer<usize, usize>>,
    level: Vec<StudyAnswer<usize, usize>>,
    choices: Vec<SystemComparison<usize, usize, usize>>,
}

impl Study {
    fn draw(n: u64) -> (Self, Lcg) {
        let mut g = Lcg::new(n);
        let is_apart = n.is_multiple_of(5);
        let tie = if n.is_multiple_of(2) { 0.0 } else { 0.2 };
        let persons = 6 + g.below(30);
        let items = if is_apart { persons + g.below(5) } else { 5 + g.below(40) };
        let each = if is_apart { 1 } else { 1 + g.below(items.min(8)) };
        let systems = 2 + g.below(3);
        let of_persons: Vec<f64> = (0..persons).map(|_| g.next()).collect();
        let of_items: Vec<f64> = (0..items).map(|_| g.next()).collect();
        let mut study = Self::default();
        for (person, of_person) in of_persons.iter().enumerate() {
            let start = if is_apart { person } else { g.below(items) };
            for at in 0..each {
                let item = (start + at) % items;
                let is_second = g.next() < 0.5;
                let felt = (of_person + of_items[item]) / 2.0;
                let is_success = g.next() < 0.15 + 0.7 * felt - if is_second { 0.1 } else { 0.0 };
                let value = if is_success { 0.5 + 0.5 * g.next() } else { 0.0 };
                let level = (5.0 * (0.6 * felt + 0.4 * g.next())).floor();
                let answer = |value| StudyAnswer { person, item, value };
                study.is_second.push(is_second);
                study.success.push(answer(f64::from(u8::from(is_success))));
                study.value.push(answer(value));
                study.level.push(answer(level));
                let first = g.below(systems);
                let second = (first + 1 + g.below(systems - 1)) % systems;
                let chance = g.next();
                let better = 0.45 + 0.1 * (second as f64 - first as f64);
                let preference = if chance < better * (1.0 - tie) {
                    PairPreference::First
                } else if chance < 1.0 - tie {
                    PairPreference::Second
                } else if item % 2 == 0 {
                    PairPreference::Tie
                } else {
                    PairPreference::BothBad
                };
                study.choices.push(SystemComparison { person, item, first, second, preference });
            }
        }
        (study, g)
    }

    /// The answers of the first condition, and of the second.
    fn conditions(&self, of: &[StudyAnswer<usize, usize>]) -> [Vec<StudyAnswer<usize, usize>>; 2] {
        [false, true].map(|second| {
            let marked = of.iter().zip(&self.is_second);
            marked.filter(|(_, is_second)| **is_second == second).map(|(answer, _)| *answer).collect()
        })
    }
}

fn assert_near(found: f64, expected: &Value, tolerance: f64, what: &str) {
    let expected = expected.as_f64().unwrap();
    assert!((found - expected).abs() <= tolerance * expected.abs().max(1.0), "{what}: {found} for {expected}");
}

fn assert_interval(found: Option<ConfidenceInterval>, expected: &Value, tolerance: f64, what: &str) {
    let found = found.unwrap();
    assert_near(found.low, &expected["low"], tolerance, what);
    assert_near(found.high, &expected["high"], tolerance, what);
}

/// Compares our figure with the script's, if it has one; returns whether it has one.
fn compare<T: Debug>(
    found: Option<T>,
    expected: &Value,
    of: impl Fn(&T) -> (f64, Option<f64>, Option<ConfidenceInterval>),
    what: &str,
) -> bool {
    if expected.is_null() {
        return false;
    }
    let found = found.unwrap();
    let (value, se, interval) = of(&found);
    let what = format!("{what}: {found:?}");
    assert_near(value, &expected["value"], EXACT, &what);
    assert_near(se.unwrap_or(0.0), &expected["se"], EXACT, &what);
    if expected["low"].is_null() {
        assert_eq!(interval, None, "{what}");
    } else {
        assert_interval(interval, expected, EXACT, &what);
    }
    true
}

fn studies() -> Vec<(Study, Lcg, Value)> {
    let fixture: Value = serde_json::from_str(include_str!("../../fixtures/study.json")).unwrap();
    let fixture = fixture.as_array().unwrap().clone();
    assert_eq!(fixture.len(), 100);
    let with = |(n, expected): (u64, Value)| {
        let (study, g) = Study::draw(n);
        assert_eq!(study.success.len() as u64, expected["answers"].as_u64().unwrap());
        (study, g, expected)
    };
    (0..).zip(fixture).map(with).collect()
}

#[test]
fn shares_and_means_are_those_of_statsmodels() {
    let mut methods = std::collections::BTreeSet::new();
    for (n, (study, _, expected)) in studies().into_iter().enumerate() {
        let successes = study.success.iter().map(|answer| answer.value).sum();
        let of_all = wilson_interval(successes, study.success.len() as f64, LEVEL).unwrap();
        assert_near(of_all.low, &expected["wilson"][0], EXACT, "wilson");
        assert_near(of_all.high, &expected["wilson"][1], EXACT, "wilson");
        for (name, found) in
            [("share", answer_share(&study.success, LEVEL)), ("mean", answer_mean(&study.value, LEVEL))]
        {
            let method = serde_json::to_value(found.as_ref().unwrap().method).unwrap();
            assert_eq!(method, expected[name]["method"], "{name} {n}");
            methods.insert(method.to_string());
            compare(found, &expected[name], |of| (of.value, of.se, of.interval), &format!("{name} {n}"));
        }
    }
    assert_eq!(methods.len(), 4, "{methods:?}");
}

#[test]
fn differences_are_those_of_statsmodels() {
    let mut compared = 0;
    for (n, (study, _, expected)) in studies().into_iter().enumerate() {
        let [first, second] = study.conditions(&study.success);
        let found = share_difference(&first, &second, LEVEL);
        let of = |found: &wayword_metrics::FigureDifference| (found.value, found.se, found.interval);
        compared += usize::from(compare(found, &expected["share_difference"], of, &format!("shares {n}")));
        let [first, second] = study.conditions(&study.value);
        let found = mean_difference(&first, &second, LEVEL);
        compared += usize::from(compare(found, &expected["mean_difference"], of, &format!("means {n}")));
    }
    assert!(compared > 180, "{compared}");
}

#[test]
fn alphas_are_those_of_krippendorff() {
    let mut compared = 0;
    for (n, (study, _, expected)) in studies().into_iter().enumerate() {
        for (at, scale) in [AnswerScale::Nominal, AnswerScale::Ordinal, AnswerScale::Interval].into_iter().enumerate() {
            let (expected, what) = (&expected["agreement"][at], format!("{scale:?} {n}"));
            let found = krippendorff_alpha(&study.level, scale, LEVEL);
            assert_eq!(found.is_none(), expected.is_null(), "{what}");
            let Some(found) = found else { continue };
            compared += 1;
            assert_near(found.alpha, &expected["alpha"], EXACT, &what);
            assert_eq!(found.se.is_none(), expected["se"].is_null(), "{what}");
            if let Some(se) = found.se {
                assert_near(se, &expected["se"], EXACT, &what);
                assert_interval(found.interval, expected, EXACT, &what);
            }
        }
    }
    assert!(compared > 150, "{compared}");
}

#[test]
fn strengths_are_those_of_statsmodels_and_scipy() {
    let mut compared = 0;
    for (n, (study, _, expected)) in studies().into_iter().enumerate() {
        let expected = &expected["bradley_terry"];
        let found = bradley_terry(&study.choices, LEVEL);
        assert_eq!(found.is_err(), expected.is_null(), "study {n}: {found:?}");
        let Ok(mut found) = found else { continue };
        compared += 1;
        found.strengths.sort_by_key(|strength| strength.system);
        let names: Vec<usize> = found.strengths.iter().map(|strength| strength.system).collect();
        assert_eq!(serde_json::to_value(names).unwrap(), expected["names"]);
        let terms = found.strengths.iter().map(|strength| strength.term).chain([found.side]).chain(found.tie);
        let terms: Vec<_> = terms.collect();
        assert_eq!(terms.len(), expected["values"].as_array().unwrap().len());
        for (at, term) in terms.iter().enumerate() {
            assert_near(term.value, &expected["values"][at], ITERATED, &format!("value {at} of {n}"));
            assert_near(term.se, &expected["ses"][at], ITERATED, &format!("error {at} of {n}"));
        }
    }
    assert!(compared > 60, "{compared}");
}

#[test]
fn a_bootstrap_is_numpys_with_the_same_draws() {
    for (n, (study, mut g, expected)) in studies().into_iter().enumerate() {
        let values: Vec<(usize, f64)> = study.value.iter().map(|answer| (answer.person, answer.value)).collect();
        let draw = |clusters: usize| (0..clusters).map(|_| g.below(clusters)).collect();
        let found = clustered_interval_from_draws(&values, 200, LEVEL, draw).unwrap();
        let interval = ConfidenceInterval { low: found.low, high: found.high };
        assert_interval(Some(interval), &expected["bootstrap"], EXACT, &format!("bootstrap {n}"));
    }
}
