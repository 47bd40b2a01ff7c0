use super::*;
use crate::walk::{AgentWalkRecord, WalkEnd};
use std::collections::BTreeMap;
use wayword_core::SceneId;
use wayword_metrics::{SuccessOutcome, TrajectoryScore};

fn walk(agent: &str, set: &str, item: &str, text_index: usize) -> AgentWalkRecord {
    AgentWalkRecord {
        agent: agent.into(),
        set: set.into(),
        item: item.into(),
        text_index,
        text: "Go.".into(),
        scene: SceneId::new("s").unwrap(),
        directions: None,
        steps: Vec::new(),
        end: WalkEnd::Stopped,
        object: None,
        effort: None,
    }
}

fn score(success: bool) -> TrajectoryScore {
    let outcome = SuccessOutcome { success, oracle_success: true, spl: f64::from(u8::from(success)), sdtw: 0.0 };
    TrajectoryScore {
        length_m: 2.0,
        navigation_error_m: None,
        oracle_error_m: None,
        distance: outcome,
        visible: None,
        grounding: None,
        ndtw: 0.5,
        cls: 0.5,
    }
}

fn about() -> ComparisonInfo {
    ComparisonInfo {
        platform: "p".into(),
        episodes: "e.json".into(),
        grounder: "labels".into(),
        detector: "labels/detector".into(),
        detector_score: None,
        encoder: None,
        tools: None,
        splitter: "rules".into(),
        rule: TrajectorySuccessRule::Distance,
        level: 0.95,
        resamples: 200,
        seed: 0,
        items: 4,
        paths: 2,
        failed: 0,
        swept: true,
        prior: None,
        parameters: BTreeMap::new(),
        wayword: "0".into(),
    }
}

fn set(name: &str) -> InstructionSet {
    InstructionSet { name: name.into(), source: name.into(), texts: 4, left_out: 0, words: 3.0 }
}

fn compared(results: &WalkScores, swaps: &[InstructionSwap]) -> AgentComparison {
    let walker = |name: &str, kind, reads| ComparedAgent { name: name.into(), kind, reads, has_extra_rows: false };
    let walkers = [walker("reader", AgentKind::Agent, true), walker("blind", AgentKind::LowerBound, false)];
    compare_agents(about(), vec![set("original"), set("ours")], &walkers, swaps, results)
}

/// Four items on two paths; the first has two texts, one of which leads there.
fn results() -> WalkScores {
    let mut results = WalkScores::default();
    let mut add = |set: &str, item: &str, text, success| {
        let path = if item < "c" { "p1" } else { "p2" };
        results.add_walk(&walk("reader", set, item, text), path, score(success));
    };
    add("original", "a", 0, true);
    add("original", "a", 1, false);
    for item in ["b", "c", "d"] {
        add("original", item, 0, true);
    }
    for item in ["a", "b", "c", "d"] {
        add("ours", item, 0, item == "b");
    }
    results
}

#[test]
fn an_items_figure_is_the_mean_over_its_texts_and_a_rows_over_items() {
    let comparison = compared(&results(), &[]);
    let [original, ours, blind] = &comparison.rows[..] else { panic!("{:?}", comparison.rows) };
    let rate = |row: &ComparisonRow| row.figures[&TrajectoryMetric::SuccessRate];
    assert_eq!((rate(original).mean, rate(original).values, rate(original).clusters), (3.5 / 4.0, 4, 2));
    assert_eq!(rate(ours).mean, 0.25);
    assert!(blind.set.is_none() && blind.figures.is_empty() && blind.against_first.is_none());
    assert!(original.against_first.is_none());
    // No goal could be reached: there is no error to take a mean of.
    assert!(!original.figures.contains_key(&TrajectoryMetric::NavigationErrorM));
}

#[test]
fn differences_pair_items_and_mcnemar_their_first_texts() {
    let comparison = compared(&results(), &[]);
    let against = comparison.rows[1].against_first.as_ref().unwrap();
    assert_eq!(against.figures[&TrajectoryMetric::SuccessRate].mean, 0.25 - 3.5 / 4.0);
    assert_eq!((against.mcnemar.only_first, against.mcnemar.only_second), (0, 3));
}

#[test]
fn swap_is_compared_on_the_texts_that_it_changed() {
    let mut results = results();
    let swapped = swapped_set("original", InstructionSwap::Landmarks);
    // Of item a, the swap changed only the text that fails. It fails as before, so the item's difference is 0.
    results.add_walk(&walk("reader", &swapped, "a", 1), "p1", score(false));
    results.add_walk(&walk("reader", &swapped, "c", 0), "p2", score(false));
    let comparison = compared(&results, &[InstructionSwap::Landmarks]);
    let [swapped] = &comparison.swaps[..] else { panic!("{:?}", comparison.swaps) };
    assert_eq!((swapped.changed, swapped.texts), (2, 5));
    let lost = swapped.lost.figures[&TrajectoryMetric::SuccessRate];
    assert_eq!((lost.mean, lost.values), (0.5, 2));
    assert_eq!((swapped.lost.mcnemar.only_first, swapped.lost.mcnemar.only_second), (1, 0));
    assert_eq!(swapped.listening, ListeningVerdict::TooFew, "two paths show nothing");
}

/// Of 30 items on `paths` paths, `losers` items lose their success by the swap.
fn after_losing(losers: usize, paths: usize) -> ListeningVerdict {
    let mut results = WalkScores::default();
    let swapped = swapped_set("original", InstructionSwap::OtherPath);
    for item in 0..30 {
        let (name, path) = (item.to_string(), (item % paths).to_string());
        results.add_walk(&walk("reader", "original", &name, 0), &path, score(true));
        results.add_walk(&walk("reader", &swapped, &name, 0), &path, score(item >= losers));
    }
    compared(&results, &[InstructionSwap::OtherPath]).swaps[0].listening
}

#[test]
fn losing_by_a_swap_on_many_paths_shows_listening() {
    assert_eq!(after_losing(30, 30), ListeningVerdict::Shown);
    assert_eq!(after_losing(15, 30), ListeningVerdict::Shown);
    assert_eq!(after_losing(1, 30), ListeningVerdict::NotShown);
    assert_eq!(after_losing(30, MIN_PATHS - 1), ListeningVerdict::TooFew);
}

#[test]
fn informed_readers_have_rows_for_an_empty_text_and_another_paths() {
    let mut results = results();
    for (set, item) in [(empty_set("original"), "a"), (swapped_set("original", InstructionSwap::OtherPath), "b")] {
        results.add_walk(&walk("reader", &set, item, 0), "p1", score(item == "b"));
    }
    let walker = ComparedAgent { name: "reader".into(), kind: AgentKind::Informed, reads: true, has_extra_rows: true };
    let sets = vec![set("original"), set("ours")];
    let comparison = compare_agents(about(), sets, &[walker], &[InstructionSwap::OtherPath], &results);
    let rate = |row: &ComparisonRow| row.figures[&TrajectoryMetric::SuccessRate].mean;
    let rows: Vec<(&str, f64)> = comparison.rows.iter().map(|row| (row.set.as_deref().unwrap(), rate(row))).collect();
    let wanted = [("original", 3.5 / 4.0), ("ours", 0.25), ("original~empty", 0.0), ("original~other-path", 1.0)];
    assert_eq!(rows, wanted);
    assert_eq!(comparison.swaps.len(), 1, "swap tests apply to it too");
}
