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
