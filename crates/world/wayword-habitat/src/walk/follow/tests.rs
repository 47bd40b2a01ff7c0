//! Tests of the follower on small navmeshes: the actions are replayed, and have to end at the last place.

use super::*;
use crate::ground::tests::{paved, ring, two_storeys};
use proptest::prelude::*;

const TOLERANCE_M: f64 = 0.25;

fn place(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Replays a walk, and returns the place where it ends.
fn ends(ground: &NavMeshGround, walked: &ActionWalk, gait: AgentGait) -> DVec3 {
    let told: Vec<AgentStance> =
        replay_actions(ground, walked.stances[0], &walked.actions, gait).map(Option::unwrap).collect();
    assert_eq!(told[..walked.stances.len()], walked.stances);
    told.last().unwrap().foothold.place
}

#[test]
fn a_walk_round_a_hole_keeps_to_its_places_and_is_not_the_shortest_way() {
    let ground = NavMeshGround::new(&paved(&ring()));
    // The long way round: past three corners, though the end is near the start.
    let places =
        [place(0.5, 0.5, 0.0), place(2.5, 0.5, 0.0), place(2.5, 2.5, 0.0), place(0.5, 2.5, 0.0), place(0.5, 1.5, 0.0)];
    let gait = AgentGait::default();
    let walked = follow_places(&ground, &places, Heading::NORTH, gait, TOLERANCE_M).unwrap();
    assert!(ends(&ground, &walked, gait).distance(places[4]) < 0.4, "{}", walked.off_m);
    assert_eq!(walked.actions.last(), Some(&AgentAction::Stop));
    assert_eq!(walked.actions.iter().filter(|action| **action == AgentAction::Stop).count(), 1);
    let steps = walked.actions.iter().filter(|action| **action == AgentAction::Forward).count();
    assert!((26..=34).contains(&steps), "7 m are 28 steps, not {steps}");
    assert!(walked.reached.is_sorted() && walked.reached.len() == places.len());
    for (number, at) in walked.reached.iter().enumerate() {
        let off_m = walked.stances[*at].foothold.place.distance(places[number]);
        assert!(off_m < 0.45, "place {number}: {off_m} m off");
    }
    // Six turns to face east, six at each of three corners, and few to correct the direction.
    let turns = walked.actions.len() - steps - 1;
    assert!((24..40).contains(&turns), "{turns} turns");
}

#[test]
fn a_walk_that_leads_back_turns_round() {
    let ground = NavMeshGround::new(&paved(&ring()));
    let places = [place(0.5, 0.5, 0.0), place(2.5, 0.5, 0.0), place(0.5, 0.5, 0.0)];
    let walked =
        follow_places(&ground, &places, Heading::new(1.5).unwrap(), AgentGait::default(), TOLERANCE_M).unwrap();
    let end = walked.stances.last().unwrap();
    assert!(end.foothold.place.distance(places[2]) < 0.3);
    assert!(walked.stances.iter().any(|stance| stance.foothold.place.x > 2.2));
}

#[test]
fn a_walk_up_a_ramp_ends_a_storey_higher() {
    let ground = NavMeshGround::new(&paved(&two_storeys()));
    let places = [place(2.0, 0.5, 0.0), place(2.0, 0.5, 3.0)];
    let walked = follow_places(&ground, &places, Heading::NORTH, AgentGait::default(), TOLERANCE_M).unwrap();
    let end = walked.stances.last().unwrap().foothold.place;
    assert!(end.distance(places[1]) < 0.4, "{end}");
}

#[test]
fn follow_reports_the_place_that_blocks_a_walk() {
    let ground = NavMeshGround::new(&paved(&ring()));
    let nowhere = follow_places(
        &ground,
        &[place(0.5, 0.5, 0.0), place(40.0, 0.0, 0.0)],
        Heading::NORTH,
        AgentGait::default(),
        0.2,
    );
    assert!(nowhere.unwrap_err().to_string().starts_with("place 1 of the walk: there is no walkable ground"));
    // A step of 2 m fits nowhere on this ring.
    let gait = AgentGait::new(1.9, 90.0).unwrap();
    let around = [place(0.5, 0.2, 0.0), place(2.6, 0.9, 0.0), place(2.6, 2.9, 0.0)];
    let blocked = follow_places(&ground, &around, Heading::NORTH, gait, 0.2).unwrap_err();
    assert!(
        matches!(blocked, WalkFollowError::Blocked { .. }) && blocked.to_string().contains("m before the end"),
        "{blocked}"
    );
}

#[test]
fn a_walk_that_is_blocked_within_its_tolerance_of_the_end_is_taken() {
    let ground = NavMeshGround::new(&paved(&ring()));
    // The ninth step ends 0.18 m before the end, and the tenth would end beyond the border.
    let places = [place(0.5, 0.55, 0.0), place(0.5, 2.98, 0.0)];
    let gait = AgentGait::new(0.25, 90.0).unwrap();
    let walked = follow_places(&ground, &places, Heading::NORTH, gait, TOLERANCE_M).unwrap();
    assert_eq!((walked.actions.len(), walked.reached.len()), (10, 2));
    assert!((walked.off_m - 0.18).abs() < 1e-9, "{}", walked.off_m);
    let blocked = follow_places(&ground, &places, Heading::NORTH, gait, 0.15).unwrap_err();
    assert!(matches!(blocked, WalkFollowError::Blocked { actions: 9, .. }), "{blocked}");
}

proptest! {
    #[test]
    fn walks_end_near_their_end_whatever_the_gait(
        ends_at in prop::collection::vec((0.15..2.85, 0.15..2.85), 2..5),
        heading in 0.0..6.2, forward in 0.1..0.35, turn in prop::sample::select(vec![5.0, 10.0, 15.0, 30.0]),
    ) {
        let is_hole = |(x, y): &(f64, f64)| (0.9..2.1).contains(x) && (0.9..2.1).contains(y);
        prop_assume!(!ends_at.iter().any(is_hole));
        let ground = NavMeshGround::new(&paved(&ring()));
        let places: Vec<DVec3> = ends_at.iter().map(|(x, y)| place(*x, *y, 0.0)).collect();
        let gait = AgentGait::new(forward, turn).unwrap();
        if let Ok(walked) = follow_places(&ground, &places, Heading::new(heading).unwrap(), gait, TOLERANCE_M) {
            prop_assert!(super::tests::ends(&ground, &walked, gait).distance(*places.last().unwrap()) <= 0.5);
        }
    }
}
