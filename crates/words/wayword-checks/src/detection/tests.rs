//! Tests of the conclusions from a detector's finds and misses.

use super::*;
use proptest::prelude::*;

/// Measured on as many runs of each length as given, with the share of finds and alarms in hundredths.
fn rates(recall: u32, alarm: u32, blind: bool, runs: &[u32]) -> DetectorRates {
    let missed_before = 1000;
    let missed_again = if blind { missed_before } else { (100 - recall) * 10 };
    DetectorRates {
        shown: 10_000,
        found: recall * 100,
        absent: 10_000,
        alarms: alarm * 100,
        missed_before,
        missed_again,
        runs: runs.to_vec(),
    }
}

#[test]
fn judge_needs_misses_from_several_frames_for_an_absence() {
    let mostly_seen = rates(80, 5, false, &[0, 10, 40]);
    assert_eq!(judge_finds(&mostly_seen, &[false; 6], 0.5), DetectionVerdict::Absent);
    let seen_once = rates(80, 5, false, &[40]);
    assert_eq!(
        judge_finds(&seen_once, &[false; 6], 0.5),
        DetectionVerdict::Open,
        "it would have been found with 0.8 alone"
    );
}

#[test]
fn misses_that_repeat_make_nothing_absent() {
    let blind = rates(80, 5, true, &[0, 10, 40]);
    assert!((blind.blind_share() - 0.2).abs() < 0.01, "{}", blind.blind_share());
    assert_eq!(judge_finds(&blind, &[false; 6], 0.5), DetectionVerdict::Open);
}

#[test]
fn a_thing_is_there_where_it_is_found_often_enough_for_how_rare_it_is() {
    let rates = rates(80, 5, false, &[10, 10, 10]);
    let twice = [false, true, true, false, false];
    assert_eq!(judge_finds(&rates, &twice, 0.5), DetectionVerdict::There);
    let once = [false, true, false, false, false];
    assert_eq!(
        judge_finds(&rates, &once, 0.02),
        DetectionVerdict::Open,
        "a rare thing that was found once may be a false alarm"
    );
    assert_eq!(judge_finds(&rates, &[], 0.5), DetectionVerdict::Open);
}

#[test]
fn a_single_name_has_its_own_rates_where_enough_was_seen() {
    let mut figures = DetectorFigures::default();
    for _ in 0..40 {
        figures.count_name("sofa", &[(true, true), (true, true), (false, false)]);
        figures.count_name("sink", &[(true, false), (true, false), (false, true)]);
    }
    figures.count_name("lamp", &[(true, true)]);
    figures.drop_rare_names();
    assert_eq!(figures.names.keys().collect::<Vec<_>>(), ["sink", "sofa"]);
    assert!(figures.rates_for("sofas").recall() > 0.98 && figures.rates_for("sink").recall() < 0.02);
    assert!((figures.rates_for("lamp").recall() - 0.5).abs() < 0.02);
    assert!(figures.rates_for("sink").alarm() > 0.98);
    let text = toml::to_string(&figures).unwrap();
    assert_eq!(toml::from_str::<DetectorFigures>(&text).unwrap(), figures);
}

proptest! {
    /// One more find never makes a thing less probable, and no figures of a file lead to a division by zero.
    #[test]
    fn more_finds_never_make_a_thing_less_probable(
        shown in 0u32..2000, found in 0u32..3000, absent in 0u32..2000, alarms in 0u32..3000,
        before in 0u32..200, again in 0u32..300, runs in prop::collection::vec(0u32..50, 0..12),
        frames in prop::collection::vec(any::<bool>(), 1..9), prior in 0.01..0.99,
    ) {
        let rates = DetectorRates { shown, found, absent, alarms, missed_before: before, missed_again: again, runs };
        prop_assert!((0.0..=1.0).contains(&rates.blind_share()));
        let rank = |judged| match judged { DetectionVerdict::Absent => 0, DetectionVerdict::Open => 1, DetectionVerdict::There => 2 };
        let all_missed = judge_finds(&rates, &vec![false; frames.len()], prior);
        let here = judge_finds(&rates, &frames, prior);
        if rates.recall() > rates.alarm() && frames.iter().filter(|found| **found).count() == 1 {
            prop_assert!(rank(here) >= rank(all_missed));
        }
    }
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// Rates with these counts of frames; nothing is known of repeated misses.
fn counted(shown: u32, found: u32, absent: u32, alarms: u32) -> DetectorRates {
    DetectorRates { shown, found, absent, alarms, ..DetectorRates::default() }
}

#[test]
fn recall_and_alarm_add_half_a_find_and_half_a_miss() {
    let rates = counted(9, 4, 19, 0);
    assert!(is_near(rates.recall(), 4.5 / 10.0) && is_near(rates.alarm(), 0.5 / 20.0));
    // Figures from a file may have more finds than frames.
    assert!(is_near(counted(9, 99, 0, 0).recall(), 9.5 / 10.0));
    assert!(is_near(counted(0, 0, 0, 0).alarm(), 0.5));
}

#[test]
fn blind_share_is_what_repeated_misses_exceed_chance_by() {
    let blind = |found: u32, missed_before: u32, missed_again: u32| {
        DetectorRates { missed_before, missed_again, ..counted(99, found, 0, 0) }.blind_share()
    };
    // Without repeated frames, every miss may be one of a blind thing: 1 - 60 / 100.
    assert!(is_near(blind(59, 0, 0), 1.0 - 59.5 / 100.0));
    // A recall of 0.595 misses 0.405; misses repeat in 8.5 of 10 cases: (0.405 * 0.85 - 0.405²) / (1 + 0.405 * 0.85 - 2 * 0.405).
    let (miss, again) = (0.405, 8.5 / 10.0);
    let wanted = (miss * again - miss * miss) / (1.0 + miss * again - 2.0 * miss);
    assert!(is_near(blind(59, 9, 8), wanted), "{} {wanted}", blind(59, 9, 8));
    // Fewer repetitions than chance would give make nothing blind.
    assert!(is_near(blind(59, 99, 0), 0.0));
}

#[test]
fn run_shares_count_longer_runs_as_the_longest() {
    let shares =
        |runs: &[u32], most: usize| DetectorRates { runs: runs.to_vec(), ..counted(1, 1, 1, 0) }.run_shares(most);
    assert_eq!(shares(&[1, 2, 1], 3), [0.25, 0.5, 0.25]);
    assert_eq!(shares(&[1, 2, 1], 2), [0.25, 0.75]);
    assert_eq!(shares(&[1, 2, 1], 5), [0.25, 0.5, 0.25, 0.0, 0.0]);
    assert_eq!((shares(&[], 2), shares(&[0, 0], 3)), (vec![1.0, 0.0], vec![1.0, 0.0, 0.0]));
}

#[test]
fn count_name_counts_frames_finds_and_runs() {
    let mut figures = DetectorFigures::default();
    figures
        .count_name("sofa", &[(true, true), (true, false), (true, false), (true, true), (false, true), (false, false)]);
    let sofa = figures.rates_for("sofa").clone();
    assert_eq!((sofa.shown, sofa.found, sofa.absent, sofa.alarms), (4, 2, 2, 1));
    // Two misses have a frame behind them, and one of those is missed again.
    assert_eq!((sofa.missed_before, sofa.missed_again), (2, 1));
    assert_eq!(sofa.runs, [0, 0, 0, 1, 0, 0, 0, 0]);
    assert_eq!((&figures.all, &figures.classes["seat"]), (&sofa, &sofa));
    figures.count_name("sofas", &[(true, true); 12]);
    assert_eq!(figures.names["sofa"].runs, [0, 0, 0, 1, 0, 0, 0, 1]);
    figures.count_name("lamp", &[(false, true)]);
    assert_eq!(figures.names["lamp"].runs, Vec::<u32>::new(), "it was never shown");
    assert_eq!((figures.all.alarms, figures.classes["light"].alarms, figures.names["sofa"].alarms), (2, 1, 1));
}

#[test]
fn rates_for_a_name_are_its_own_or_those_of_its_class_or_of_all() {
    let mut figures = DetectorFigures { all: counted(1, 0, 0, 0), ..DetectorFigures::default() };
    figures.classes.insert("seat".into(), counted(2, 0, 0, 0));
    figures.names.insert("sofa".into(), counted(3, 0, 0, 0));
    let shown = |name: &str| figures.rates_for(name).shown;
    assert_eq!([shown("sofa"), shown("Sofas"), shown("chair"), shown("lamp"), shown("zorble")], [3, 3, 2, 1, 1]);
}

#[test]
fn rare_names_and_names_outside_the_lexicon_are_dropped() {
    let mut figures = DetectorFigures::default();
    for (name, shown, absent) in [("sofa", 30, 30), ("chair", 29, 30), ("lamp", 30, 29), ("zorble", 30, 30)] {
        figures.names.insert(name.into(), counted(shown, 0, absent, 0));
        figures.classes.insert(name.into(), counted(shown, 0, absent, 0));
    }
    figures.drop_rare_names();
    assert_eq!(figures.names.keys().collect::<Vec<_>>(), ["sofa"]);
    assert_eq!(figures.classes.keys().collect::<Vec<_>>(), ["sofa", "zorble"]);
}

#[test]
fn an_unmeasured_detector_makes_nothing_absent() {
    let figures = DetectorFigures::for_unmeasured("somebody/model", 0.25);
    assert_eq!((figures.detector.as_str(), figures.found_from), ("somebody/model", 0.25));
    assert!(is_near(figures.all.recall(), 60.5 / 101.0) && is_near(figures.all.alarm(), 2.5 / 101.0));
    for frames in 1..9 {
        assert_eq!(judge_finds(&figures.all, &vec![false; frames], 0.5), DetectionVerdict::Open, "{frames}");
    }
    assert_eq!(judge_finds(&figures.all, &[true, true], 0.5), DetectionVerdict::There);
}

#[test]
fn one_find_is_judged_by_the_rule_of_bayes() {
    // One frame, in which a thing would be found with 0.8 and is found falsely with 0.1: (recall + half a find) / one more.
    let rates = DetectorRates { missed_before: 999, missed_again: 0, runs: vec![1], ..counted(999, 799, 999, 99) };
    assert!(is_near(rates.recall(), 0.7995) && is_near(rates.alarm(), 0.0995) && is_near(rates.blind_share(), 0.0));
    // Found: 0.7995 + 0.2005 * 0.0995 where it is there, and 0.0995 where it is not.
    let hit = 0.7995 + 0.2005 * 0.0995;
    let prior_for_nine_tenths = 0.9 * 0.0995 / (0.9 * 0.0995 + 0.1 * hit);
    for (before, wanted) in [
        (prior_for_nine_tenths + 0.001, DetectionVerdict::There),
        (prior_for_nine_tenths - 0.001, DetectionVerdict::Open),
    ] {
        assert_eq!(judge_finds(&rates, &[true], before), wanted, "{before}");
    }
}

#[test]
fn an_absence_needs_a_likely_find_and_telling_misses() {
    let with = |recall: u32, alarm: u32, frames: usize| {
        let rates = DetectorRates {
            missed_before: 1000,
            missed_again: 0,
            runs: vec![0, 0, 0, 1],
            ..counted(1000, recall, 1000, alarm)
        };
        judge_finds(&rates, &vec![false; frames], 0.5)
    };
    // Of four frames that show it, all are missed with 0.5 to the fourth: 0.06.
    assert_eq!(with(500, 10, 4), DetectionVerdict::Absent);
    // Two frames are missed with a quarter, and a find is not certain enough.
    assert_eq!(with(500, 10, 2), DetectionVerdict::Open);
    assert_eq!(with(400, 10, 4), DetectionVerdict::Open, "0.6 to the fourth is 0.13");
    // With a find, it is not absent.
    let rates = DetectorRates { missed_before: 1000, runs: vec![0, 0, 0, 1], ..counted(1000, 900, 1000, 500) };
    assert_eq!(judge_finds(&rates, &[true, false, false, false], 0.001), DetectionVerdict::Absent);
    assert_eq!(judge_finds(&rates, &[true, true, true, true], 0.5), DetectionVerdict::There);
}

#[test]
fn an_earlier_belief_moves_presence_and_not_absence() {
    let rates = rates(80, 5, false, &[0, 10, 40]);
    for before in [0.01, 0.5, 0.9] {
        assert_eq!(judge_finds(&rates, &[false; 6], before), DetectionVerdict::Absent, "{before}");
    }
    assert_eq!(judge_finds(&rates, &[false; 6], 0.99999), DetectionVerdict::There);
}
