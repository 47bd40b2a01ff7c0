use super::*;
use crate::{
    made_buildings::{make_corridor, random_weights},
    tests::surveyed,
};
use wayword_core::CheckKind;

const TEXT: &str = "Walk down the hallway and turn right. Walk into the kitchen and wait by the oven.";
const WALK: [usize; 5] = [0, 1, 2, 5, 6];

/// Weights so weak that many walks fit about as well.
fn weak_weights(seed: u64) -> FeatureWeights {
    let values: Vec<f64> = random_weights(seed).values().iter().map(|weight| 0.05 * weight).collect();
    FeatureWeights::from_values(&values)
}

fn change(kind: StepChangeKind, step: usize, gain: f64) -> StepChange {
    StepChange { kind, step, span: [step, step + 1], gain }
}

#[test]
fn reason_words_differ() {
    use UnfollowedReason::{NoGraph, TooFewSteps, TooManySteps};
    let words = [NoGraph, TooManySteps, TooFewSteps].map(UnfollowedReason::reason_words);
    assert!(words[0].contains("graph") && words[1].contains("too many steps") && words[2].contains("more hops"));
}

#[test]
fn wrong_steps_need_more_gain_than_their_thresholds() {
    let guide = Guide::read_text("Turn left. Go up the stairs. Turn right. Go down the stairs. Turn around.");
    let kinds: Vec<_> = guide.steps.iter().map(|told| (told.step.turn, told.step.climb)).collect();
    assert_eq!(
        kinds,
        [
            (Some(Side::Left), None),
            (None, Some(ClimbDirection::Up)),
            (Some(Side::Right), None),
            (None, Some(ClimbDirection::Down)),
            (Some(Side::Behind), None)
        ]
    );
    let thresholds = GainThresholds { turn: 1.0, no_turn: 2.0, climb: 3.0, swap: 0.0, route: 0.0 };
    let found = |changes: &[StepChange]| {
        let findings = wrong_steps(&guide, changes, thresholds).into_iter();
        assert!(findings.clone().all(|finding| finding.verdict == Verdict::Fail));
        findings.map(|finding| (finding.check, finding.reason, finding.span.unwrap()[0])).collect::<Vec<_>>()
    };
    use StepChangeKind::{Climb, NoStep, NoTurn, Side as OtherSide, Turn};
    let turns = |reason: &str, step| (CheckKind::Turns, reason.to_owned(), step);
    let floors = |reason: &str, step| (CheckKind::Floors, reason.to_owned(), step);
    let enough = [
        change(Turn, 2, 1.1),
        change(Turn, 0, 1.1),
        change(Climb, 3, 3.1),
        change(Climb, 1, 3.1),
        change(NoTurn, 4, 2.1),
    ];
    assert_eq!(
        found(&enough),
        [
            turns("the path turns right here, and not left", 0),
            floors("the path goes down here, and not up", 1),
            turns("the path turns left here, and not right", 2),
            floors("the path goes up here, and not down", 3),
            turns("the path does not turn like this here", 4)
        ]
    );
    let too_little = [change(Turn, 0, 1.0), change(Climb, 1, 3.0), change(NoTurn, 4, 2.0)];
    assert_eq!(found(&too_little), []);
    assert_eq!(found(&[change(NoStep, 0, 99.0), change(OtherSide, 0, 99.0)]), []);
    assert_eq!(
        found(&[change(NoTurn, 0, 9.0), change(Turn, 0, 8.0)]),
        [turns("the path does not turn like this here", 0)]
    );
}

#[test]
fn fault_span_is_that_of_the_best_change_with_a_gain() {
    assert_eq!(fault_span(&[]), None);
    assert_eq!(fault_span(&[change(StepChangeKind::Turn, 4, 0.0)]), None);
    assert_eq!(
        fault_span(&[change(StepChangeKind::Turn, 4, 0.1), change(StepChangeKind::Turn, 6, 0.05)]),
        Some([4, 5])
    );
}

#[test]
fn wrong_order_names_both_places_and_marks_the_first() {
    let swap = PlaceSwap { names: ["oven".into(), "plant".into()], spans: [[1, 5], [9, 14]], gain: 4.0 };
    let finding = wrong_order(swap);
    assert_eq!((finding.check, finding.verdict, finding.span), (CheckKind::Order, Verdict::Fail, Some([1, 5])));
    assert!(finding.reason.contains("if \"plant\" stands where") && finding.reason.contains("\"oven\", and"));
}

#[test]
fn judge_steps_reports_the_gain_of_the_best_turn_and_a_swap_above_its_threshold() {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &WALK, heading_rad: 0.0 };
    let text = "Walk past the oven, turn right, turn left and stop at the plant.";
    let guide = Guide::read_text(text);
    for seed in 0..5 {
        let weights = random_weights(seed);
        let changes = rank_changes(&guide, &building, &WALK, 0.0, &weights);
        let turns = changes.iter().filter(|change| change.kind == StepChangeKind::Turn).map(|change| change.gain);
        let swap = best_swap(&guide, &building, &WALK, 0.0, &weights).unwrap().gain;
        let at = |swap| GainThresholds { turn: 1e9, no_turn: 1e9, climb: 1e9, swap, route: 0.0 };
        let judged = judge_steps(&guide, known, &weights, at(swap));
        assert_eq!((judged.turn_gain, judged.wrong.len()), (turns.max_by(f64::total_cmp), 0));
        let judged = judge_steps(&guide, known, &weights, at(swap - 1e-9));
        assert_eq!(judged.wrong.iter().map(|finding| finding.check).collect::<Vec<_>>(), [CheckKind::Order]);
    }
    let straight = judge_steps(&Guide::read_text("Walk on."), known, &weak_weights(1), GainThresholds::default());
    assert_eq!(straight.turn_gain, None);
}

#[test]
fn judge_steps_and_judge_route_accept_sixty_steps() {
    let building = make_corridor(&["hallway"; 3]);
    let known = KnownWalk { building: &building, walk: &[0, 1, 2], heading_rad: 0.0 };
    let (weights, thresholds) = (FeatureWeights::by_hand(), GainThresholds::default());
    for (steps, is_followed) in [(60, true), (61, false)] {
        let guide = Guide::read_text(&"Turn left. ".repeat(steps));
        assert_eq!(guide.len(), steps);
        assert_eq!(judge_steps(&guide, known, &weights, thresholds).turn_gain.is_some(), is_followed);
        let route = judge_route(&guide, known, Some(WalkPrior::Shortest(8)), &weights, thresholds);
        assert_eq!(route.is_ok(), is_followed);
    }
    let guide = Guide::read_text(TEXT);
    assert_eq!(judge_route(&guide, known, None, &weights, thresholds), Err(UnfollowedReason::NoGraph));
    assert_eq!(goal_probability(&guide, known, None, &weights), Err(UnfollowedReason::NoGraph));
}

#[test]
fn judge_route_compares_the_walk_with_all_that_end_3_m_away() {
    let building = KnownBuilding::from_survey(&surveyed());
    let guide = Guide::read_text(TEXT);
    let mut counts = std::collections::BTreeSet::new();
    for (seed, walk) in (0..12).flat_map(|seed| [&WALK[..], &[0, 1, 2], &[0, 7]].map(|walk| (seed, walk))) {
        let weights = weak_weights(seed);
        let known = KnownWalk { building: &building, walk, heading_rad: 0.0 };
        let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(8));
        let own = tree.find_walk(walk).unwrap();
        let shares = walk_shares(&WalkFit::new(&GuideTrial::new(&guide, &building), &tree, &weights), &tree);
        let far = |a: usize, b: usize| building.distance_m(tree.end_viewpoint(a), tree.end_viewpoint(b));
        let elsewhere: Vec<usize> = (1..tree.len()).filter(|other| far(own, *other) >= 3.0).collect();
        let other = elsewhere.iter().map(|walk| shares[*walk]).fold(0.0, f64::max);
        // The ends that fit as well, from the likeliest on, without those near one that is there already.
        let mut likely: Vec<usize> = elsewhere.iter().copied().filter(|at| shares[*at] >= 0.8 * shares[own]).collect();
        likely.sort_by(|a, b| shares[*b].total_cmp(&shares[*a]));
        let mut ends = vec![own];
        while let Some(next) = likely.iter().find(|at| ends.iter().all(|end| far(*end, **at) >= 3.0)) {
            ends.push(*next);
        }
        let gain = (other / shares[own]).ln();
        for (route, verdict) in [(gain + 1e-6, Verdict::Pass), (gain - 1e-6, Verdict::Fail)] {
            let thresholds = GainThresholds { route, ..GainThresholds::default() };
            let judged = judge_route(&guide, known, Some(WalkPrior::Shortest(8)), &weights, thresholds).unwrap();
            assert!((judged.share - shares[own]).abs() < 1e-12 && (judged.other - other).abs() < 1e-12);
            assert_eq!(judged.ends, ends.iter().map(|walk| tree.end_viewpoint(*walk)).collect::<Vec<_>>());
            assert_eq!((judged.finding.check, judged.finding.verdict), (CheckKind::Route, verdict));
            let is_fail = verdict == Verdict::Fail;
            assert_eq!(judged.finding.reason.is_empty(), !is_fail);
            let span = fault_span(&rank_changes(&guide, &building, walk, 0.0, &weights));
            assert_eq!(judged.finding.span, span.filter(|_| is_fail));
        }
        let near: f64 = (1..tree.len()).filter(|other| far(own, *other) < 3.0).map(|walk| shares[walk]).sum();
        let leads = goal_probability(&guide, known, Some(WalkPrior::Shortest(8)), &weights).unwrap();
        assert!((leads - near).abs() < 1e-9, "{leads} {near}");
        counts.insert(ends.len());
    }
    assert!(counts.len() > 2, "some walks have more such ends than others: {counts:?}");
}

#[test]
fn judge_route_counts_an_unusual_walk_among_the_others() {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &[0, 1, 2, 1, 0], heading_rad: 0.0 };
    let guide = Guide::read_text(TEXT);
    let verdict = |walk: &[usize]| {
        let known = KnownWalk { walk, ..known };
        judge_route(&guide, known, Some(WalkPrior::Shortest(8)), &weak_weights(1), GainThresholds::default()).unwrap()
    };
    let judged = verdict(known.walk);
    assert!(judged.share > 0.0 && judged.ends[0] == 0);
    // Ends 3 m apart or more are different, and those 2.5 m away are not.
    assert!(!judged.ends[1..].contains(&1) && !judged.ends[1..].contains(&7));
}
