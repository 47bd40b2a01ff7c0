use super::{
    testing::{any_case, graph, id, ids, object},
    *,
};
use proptest::prelude::*;

/// Five places in a row, 2 m apart, and a sixth that cannot be reached.
fn corridor() -> SceneDistances {
    let points = [[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [6.0, 0.0], [8.0, 0.0], [0.0, 9.0]];
    SceneDistances::new(&graph(&points, &[(0, 1), (1, 2), (2, 3), (3, 4)]))
}

fn demand(reference: &[usize], visible_from: &[usize]) -> EpisodeDemand {
    EpisodeDemand {
        reference: ids(reference),
        object: Some(object("lamp")),
        visible_from: Some(visible_from.iter().map(|n| id(*n)).collect()),
    }
}

fn walked(places: &[usize]) -> AgentTrajectory {
    AgentTrajectory { viewpoints: ids(places), object: None }
}

fn scored(reference: &[usize], visible_from: &[usize], places: &[usize]) -> TrajectoryScore {
    score_trajectory(&corridor(), &demand(reference, visible_from), &walked(places)).unwrap()
}

fn wrong(reference: &[usize], places: &[usize]) -> Vec<TrajectoryError> {
    let (demand, trajectory) = (demand(reference, &[]), walked(places));
    let found = find_problems(&corridor(), &demand, &trajectory);
    assert_eq!(score_trajectory(&corridor(), &demand, &trajectory).err().unwrap_or_default(), found);
    found
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-12
}

#[test]
fn the_annotated_path_itself_has_the_best_of_all_figures() {
    let found = scored(&[0, 1, 2, 3], &[3], &[0, 1, 2, 3]);
    let best = SuccessOutcome { success: true, oracle_success: true, spl: 1.0, sdtw: 1.0 };
    assert_eq!((found.distance, found.visible), (best, Some(best)));
    assert_eq!((found.ndtw, found.cls, found.length_m), (1.0, 1.0, 6.0));
    assert_eq!((found.navigation_error_m, found.oracle_error_m), (Some(0.0), Some(0.0)));
}

#[test]
fn passing_the_goal_gives_only_oracle_success() {
    let found = scored(&[0, 1], &[1], &[0, 1, 2, 3]);
    assert_eq!((found.navigation_error_m, found.oracle_error_m), (Some(4.0), Some(0.0)));
    let passed = |outcome: SuccessOutcome| {
        !outcome.success && outcome.oracle_success && outcome.spl == 0.0 && outcome.sdtw == 0.0
    };
    assert!(passed(found.distance) && passed(found.visible.unwrap()));
}

#[test]
fn success_by_distance_ends_before_three_metres() {
    let line = |last_m| {
        let distances = SceneDistances::new(&graph(&[[0.0, 0.0], [last_m, 0.0]], &[(0, 1)]));
        score_trajectory(&distances, &demand(&[0, 1], &[]), &walked(&[0])).unwrap().distance.success
    };
    assert!(line(2.999_999) && !line(3.0));
}

#[test]
fn rules_of_distance_and_visibility_are_independent() {
    let far = scored(&[0, 1, 2, 3, 4], &[0], &[0]);
    assert!(far.visible.unwrap().success && !far.distance.success);
    assert_eq!(far.visible.unwrap().spl, 1.0, "a nearer viewpoint that sees the object is no better than the goal");
    let near = scored(&[0, 1, 2], &[], &[0, 1]);
    assert!(near.distance.success && !near.visible.unwrap().oracle_success);
}

#[test]
fn a_detour_costs_its_length() {
    let found = scored(&[0, 1, 2], &[2], &[0, 1, 0, 1, 2]);
    assert_eq!((found.length_m, found.distance.spl, found.visible.unwrap().spl), (8.0, 0.5, 0.5));
}

#[test]
fn a_stay_has_no_length_but_counts_in_ndtw() {
    let (brisk, slow) = (scored(&[0, 1, 2, 3], &[3], &[0, 1, 2]), scored(&[0, 1, 2, 3], &[3], &[0, 1, 2, 2]));
    assert_eq!((brisk.length_m, brisk.distance.spl, brisk.cls), (slow.length_m, slow.distance.spl, slow.cls));
    assert!(close(brisk.ndtw, (-2.0f64 / 12.0).exp()) && close(slow.ndtw, brisk.ndtw));
    let late = scored(&[0, 1], &[], &[0, 1, 2, 2]);
    assert!(close(late.ndtw, (-4.0f64 / 6.0).exp()), "two stays off the path cost twice: {}", late.ndtw);
}

#[test]
fn coverage_is_weighted_by_the_length_that_it_expects() {
    let found = scored(&[0, 1, 2], &[], &[0, 1]);
    let coverage = (2.0 + (-2.0f64 / 3.0).exp()) / 3.0;
    let expected_m = coverage * 4.0;
    assert!(close(found.cls, coverage * expected_m / (expected_m + (expected_m - 2.0).abs())));
}

#[test]
fn staying_at_a_start_that_is_the_goal_has_the_best_figures() {
    let found = scored(&[0], &[0], &[0, 0]);
    assert_eq!((found.distance.spl, found.visible.unwrap().spl, found.cls, found.ndtw), (1.0, 1.0, 1.0, 1.0));
    let left = scored(&[0], &[1], &[0, 1]);
    assert_eq!((left.distance.success, left.distance.spl, left.visible.unwrap().spl, left.cls), (true, 0.0, 0.0, 0.0));
}

#[test]
fn a_goal_that_cannot_be_reached_has_no_errors_and_no_success_by_distance() {
    let found = scored(&[0, 5], &[0], &[0, 1, 0]);
    assert_eq!((found.navigation_error_m, found.oracle_error_m), (None, None));
    assert!(!found.distance.oracle_success);
    assert_eq!(found.visible.map(|visible| (visible.success, visible.spl)), Some((true, 0.0)));
    assert_eq!((found.ndtw, found.cls), (0.0, 0.0));
    assert_eq!(found.get(TrajectoryMetric::NavigationErrorM, TrajectorySuccessRule::Distance), None);
}

#[test]
fn the_right_object_counts_wherever_one_stands() {
    let grounded = |named: Option<&str>| {
        let trajectory = AgentTrajectory { object: named.map(object), ..walked(&[0, 1, 0]) };
        score_trajectory(&corridor(), &demand(&[0, 1, 2], &[2]), &trajectory).unwrap().grounding.unwrap()
    };
    assert_eq!(grounded(Some("lamp")), TargetGrounding { rgs: true, rgspl: 1.0 });
    assert_eq!(grounded(Some("door")), TargetGrounding { rgs: false, rgspl: 0.0 });
    assert_eq!(grounded(None), TargetGrounding { rgs: false, rgspl: 0.0 });
}

#[test]
fn an_episode_without_an_object_is_judged_by_distance_alone() {
    let demand = EpisodeDemand { object: None, ..demand(&[0, 1], &[1]) };
    let found = score_trajectory(&corridor(), &demand, &walked(&[0, 1])).unwrap();
    assert_eq!((found.visible, found.grounding), (None, None));
    assert_eq!(found.get(TrajectoryMetric::SuccessRate, TrajectorySuccessRule::Visible), None);
    assert_eq!(found.get(TrajectoryMetric::SuccessRate, TrajectorySuccessRule::Distance), Some(1.0));
}

#[test]
fn score_reports_every_problem() {
    let no_edge = |step, from, to| TrajectoryError::NoEdge { step, from: id(from), to: id(to) };
    assert_eq!(
        wrong(&[0, 1], &[0, 2, 2, 9, 1, 4]),
        [TrajectoryError::Unknown { step: 3, viewpoint: id(9).to_string() }, no_edge(1, 0, 2), no_edge(5, 1, 4),]
    );
    assert_eq!(wrong(&[0, 1], &[1]), [TrajectoryError::Start { found: id(1).to_string(), expected: id(0) }]);
    assert_eq!(wrong(&[0, 1], &[]), [TrajectoryError::Empty]);
    assert_eq!(wrong(&[], &[0]), [TrajectoryError::NoReference]);
    assert_eq!(wrong(&[0, 8], &[0]), [TrajectoryError::UnknownInReference { step: 1, viewpoint: id(8) }]);
    assert_eq!(wrong(&[0, 1], &[0, 0, 1]), []);
}

proptest! {
    #[test]
    fn figures_keep_to_their_ranges_and_to_each_other((graph, demand, trajectory) in any_case()) {
        let distances = SceneDistances::new(&graph);
        let found = score_trajectory(&distances, &demand, &trajectory).unwrap();
        prop_assert!((0.0..=1.0).contains(&found.ndtw) && (0.0..=1.0).contains(&found.cls), "{:?}", found);
        prop_assert!(found.length_m.is_finite() && found.length_m >= 0.0);
        prop_assert_eq!(found.visible.is_some(), demand.object.is_some());
        for outcome in [Some(found.distance), found.visible].into_iter().flatten() {
            let success = f64::from(u8::from(outcome.success));
            prop_assert!((0.0..=success).contains(&outcome.spl), "SPL beyond SR: {:?}", outcome);
            prop_assert!((0.0..=success).contains(&outcome.sdtw) && outcome.sdtw <= found.ndtw);
            prop_assert!(outcome.oracle_success >= outcome.success);
        }
        prop_assert!(found.oracle_error_m.zip(found.navigation_error_m).is_none_or(|(oracle, last)| oracle <= last));
        prop_assert_eq!(found.oracle_error_m.is_some(), found.navigation_error_m.is_some());
        if let Some(grounding) = found.grounding {
            prop_assert!((0.0..=f64::from(u8::from(grounding.rgs))).contains(&grounding.rgspl));
        }
    }

    #[test]
    fn walking_the_annotated_path_gives_full_fidelity((graph, demand, _) in any_case()) {
        let trajectory = AgentTrajectory { viewpoints: demand.reference.clone(), object: None };
        // A path with a hop that is no edge cannot be walked.
        if let Ok(found) = score_trajectory(&SceneDistances::new(&graph), &demand, &trajectory) {
            prop_assert_eq!(found.ndtw, 1.0);
            prop_assert!((found.cls - 1.0).abs() < 1e-12);
            prop_assert!(found.distance.success);
        }
    }

    #[test]
    fn a_stay_changes_only_ndtw((graph, demand, trajectory) in any_case(), at in 0..12usize) {
        let distances = SceneDistances::new(&graph);
        let brisk = score_trajectory(&distances, &demand, &trajectory).unwrap();
        let mut slow = trajectory;
        let at = at % slow.viewpoints.len();
        slow.viewpoints.insert(at, slow.viewpoints[at].clone());
        let slow = score_trajectory(&distances, &demand, &slow).unwrap();
        let but_ndtw = |of: &TrajectoryScore| {
            let outcome = |of: SuccessOutcome| (of.success, of.oracle_success, of.spl);
            (of.length_m, of.navigation_error_m, of.oracle_error_m, of.cls, outcome(of.distance), of.visible.map(outcome))
        };
        prop_assert_eq!(but_ndtw(&slow), but_ndtw(&brisk));
        prop_assert!(slow.ndtw <= brisk.ndtw);
    }
}
