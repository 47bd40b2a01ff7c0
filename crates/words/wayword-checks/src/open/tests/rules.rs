//! Tests of single rules of the open world: climbs, distances, repetitions, numbers, relations and sides.

use super::{path, survey, told};
use crate::{
    BuildingInventory, CheckSubject, Evidence, PathSurroundings, TurnJudge, WorldReach, check_text,
    open::{WalkerRelation, read_claims},
    tests::style,
};
use std::{collections::BTreeSet, sync::Arc};
use wayword_core::{CheckKind, DVec3, Path, PathMotion, SceneId, Verdict, path::PathStop};
use wayword_language::reading::read_instruction;

/// The findings of a check on a text about a path through these points: verdict, words, reason.
fn found(check: CheckKind, text: &str, points: &[(f64, f64, f64)]) -> Vec<(Verdict, String, String)> {
    found_in(check, text, &evidence_along(points), WorldReach::default())
}

fn evidence_along(points: &[(f64, f64, f64)]) -> Evidence {
    Evidence::for_path_alone(&path_along(points))
}

fn path_along(points: &[(f64, f64, f64)]) -> Path {
    let stop =
        |(x, y, z): &(f64, f64, f64)| PathStop { position: DVec3::new(*x, *y, *z), viewpoint: None, level: Some(1) };
    Path {
        id: "1".into(),
        scene: SceneId::new("made-up").unwrap(),
        frames: Path::frames_along(points.iter().map(stop).collect(), None),
        motion: PathMotion::Known,
        target: None,
    }
}

fn found_in(
    check: CheckKind,
    text: &str,
    evidence: &Evidence,
    reach: WorldReach<'_>,
) -> Vec<(Verdict, String, String)> {
    let style = style(false);
    let subject =
        CheckSubject { turns: TurnJudge::JudgedElsewhere, ..CheckSubject::open_world(evidence, &style, reach) };
    let findings = check_text(text, subject).findings.into_iter().filter(|finding| finding.check == check);
    let words = |span: Option<[usize; 2]>| span.map_or("", |[from, to]| &text[from..to]).to_owned();
    findings.map(|finding| (finding.verdict, words(finding.span), finding.reason)).collect()
}

fn worst(check: CheckKind, text: &str, points: &[(f64, f64, f64)]) -> Verdict {
    found(check, text, points).iter().map(|found| found.0).max().unwrap()
}

/// A way along y with these heights, a frame every two metres.
fn heights(heights: &[f64]) -> Vec<(f64, f64, f64)> {
    heights.iter().zip(0..).map(|(z, at)| (0.0, 2.0 * f64::from(at), *z)).collect()
}

#[test]
fn a_climb_needs_a_step_and_no_stairs_the_other_way() {
    use Verdict::{Fail, Pass};
    let floors = |text: &str, of: &[f64]| worst(CheckKind::Floors, text, &heights(of));
    for (of, up, down) in [
        (&[0.0, 0.0][..], Fail, Fail),
        (&[0.0, 0.05], Fail, Fail),
        (&[0.0, 0.1], Pass, Fail),
        (&[0.1, 0.0], Fail, Pass),
        (&[0.0, 3.0], Pass, Fail),
        (&[3.0, 0.0], Fail, Pass),
        // Gains add up, and only what lies between two points counts.
        (&[0.0, 0.06, 0.12], Pass, Fail),
        (&[0.0, 0.06, 0.0, 0.06], Fail, Fail),
        (&[1.0, 0.5, 2.0], Pass, Fail),
    ] {
        assert_eq!((floors("Go up the stairs.", of), floors("Go down the stairs.", of)), (up, down), "{of:?}");
    }
}

#[test]
fn a_small_gain_beside_stairs_the_other_way_is_no_climb() {
    use Verdict::{Fail, Pass};
    // Down by two metres, and up again by this much.
    let up = |text: &str, gain_m: f64| worst(CheckKind::Floors, text, &heights(&[2.0, 0.0, gain_m]));
    let one = "Go up the stairs.";
    assert_eq!((up(one, 0.89), up(one, 0.91)), (Fail, Pass));
    let both = "Go down the stairs. Go up the stairs.";
    assert_eq!((up(both, 0.29), up(both, 0.31)), (Fail, Pass));
    // A few steps count however many stairs there are the other way.
    assert_eq!((up("Walk up a few steps.", 0.2), up("Walk up a few steps.", 0.05)), (Pass, Fail));
    // Less than half a metre the other way is no flight.
    let low = |loss_m: f64| worst(CheckKind::Floors, one, &heights(&[loss_m, 0.0, 0.11]));
    assert_eq!((low(0.49), low(0.5)), (Pass, Fail));
}

#[test]
fn a_place_upstairs_fails_only_if_the_path_goes_down() {
    use Verdict::{Fail, Pass, Unverified};
    let floors = |text: &str, of: &[f64]| worst(CheckKind::Floors, text, &heights(of));
    let (up, down) = ("The bedroom upstairs is yours.", "The bedroom downstairs is yours.");
    for (of, wanted_up, wanted_down) in
        [([0.0, 3.0], Pass, Fail), ([3.0, 0.0], Fail, Pass), ([0.0, 0.0], Unverified, Unverified)]
    {
        assert_eq!((floors(up, &of), floors(down, &of)), (wanted_up, wanted_down), "{of:?}");
    }
}

#[test]
fn climbs_of_an_unknown_motion_are_unverified_in_an_open_world() {
    let mut evidence = evidence_along(&heights(&[0.0, 3.0]));
    evidence.motion = PathMotion::Unknown;
    evidence.moves.clear();
    let reason = "the program cannot check whether the path goes up or down";
    for text in ["Go up the stairs.", "Walk up a few steps.", "The bedroom upstairs is yours."] {
        let found = found_in(CheckKind::Floors, text, &evidence, WorldReach::default());
        assert_eq!((found[0].0, found[0].2.as_str()), (Verdict::Unverified, reason), "{text}");
    }
}

#[test]
fn a_climb_that_is_only_a_moment_or_a_description_is_not_checked() {
    let flat = heights(&[0.0, 0.0, 0.0]);
    let down = heights(&[3.0, 0.0, 0.0]);
    let floors = |text: &str, points: &[(f64, f64, f64)]| worst(CheckKind::Floors, text, points);
    // As a moment, a climb may be missing, but the path may not go the other way.
    for text in ["Once you are up the stairs, stop.", "Begin to climb the stairs."] {
        assert_eq!((floors(text, &flat), floors(text, &down)), (Verdict::Pass, Verdict::Fail), "{text}");
    }
    // Without stairs, "down" may be along a hallway.
    assert_eq!(floors("Walk all the way down.", &flat), Verdict::Pass);
    for text in
        ["Stop before you go up the stairs.", "Walk past the stairs going up.", "Walk past the ascending stairs."]
    {
        assert_eq!((floors(text, &flat), floors(text, &down)), (Verdict::Pass, Verdict::Pass), "{text}");
    }
    assert_eq!(floors("Go up the stairs.", &flat), Verdict::Fail);
    let reason = found(CheckKind::Floors, "Go up the stairs.", &flat);
    assert_eq!(reason, [(Verdict::Fail, "Go up the stairs".to_owned(), "the path nowhere goes up".to_owned())]);
    let reason = found(CheckKind::Floors, "Go down the stairs.", &flat);
    assert_eq!(reason[0].2, "the path nowhere goes down");
}

#[test]
fn storey_numbers_are_never_wrong_in_an_open_world() {
    let text = "Walk down the hallway on the third floor.";
    let reason = "the program does not know from where the text counts storeys";
    let found = found(CheckKind::Floors, text, &heights(&[0.0, 0.0]));
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].0, found[0].2.as_str()), (Verdict::Unverified, reason));
}

#[test]
fn a_distance_fails_beyond_half_again_the_path_and_three_metres() {
    // The path is 10 metres long, so 18 metres are the limit.
    let points = [(0.0, 0.0, 0.0), (0.0, 4.0, 0.0), (0.0, 10.0, 0.0)];
    let order = |text: &str| found(CheckKind::Order, text, &points);
    assert_eq!(order("Walk 18 meters.")[0].0, Verdict::Pass);
    let far = order("Walk 19 meters.");
    assert_eq!((far[0].0, far[0].2.as_str()), (Verdict::Fail, "the whole path is 10 m long"));
    assert!(far[0].1.contains("19"), "{far:?}");
    assert_eq!(order("Walk 1 meter.")[0].0, Verdict::Pass);
    let mut unknown = evidence_along(&points);
    unknown.motion = PathMotion::Unknown;
    let found = found_in(CheckKind::Order, "Walk 1 meter.", &unknown, WorldReach::default());
    assert_eq!(
        (found[0].0, found[0].2.as_str()),
        (Verdict::Unverified, "the program cannot check how far the path goes")
    );
}

#[test]
fn a_sentence_twice_in_a_row_is_a_copy_and_later_needs_another_stretch() {
    let block = [(0.0, 0.0, 0.0), (0.0, 2.0, 0.0), (2.0, 2.0, 0.0), (2.0, 0.0, 0.0)];
    let order = |text: &str| found(CheckKind::Order, text, &block);
    let row = "Turn right. Turn right.";
    let twice = "the text says this sentence twice in a row";
    assert_eq!(order(row), [(Verdict::Fail, "Turn right".to_owned(), twice.to_owned())]);
    assert_eq!(order("Turn right. Walk on. Turn right.")[0].0, Verdict::Pass, "the path turns right twice");
    let often = order("Turn left. Walk on. Turn left.");
    let fewer = "the text says this sentence again, and the path has fewer stretches of it";
    assert_eq!((often[0].0, often[0].2.as_str()), (Verdict::Fail, fewer));
    let third = order("Turn right. Walk on. Turn right. Wait. Turn right.");
    assert_eq!((third[0].0, third[0].2.as_str()), (Verdict::Fail, fewer));
    // Sentences of eight words are never repeated for another stretch.
    let words = |count: usize| {
        let more = ["please", "now", "just", "there", "slowly", "carefully"][..count - 2].join(" ");
        format!("Turn right {more}. Walk on. Turn right {more}.")
    };
    assert_eq!((order(&words(7))[0].0, order(&words(8))[0].0), (Verdict::Pass, Verdict::Fail));
    // Marks and capitals make no other sentence.
    assert_eq!(order("Turn left. Walk on! turn LEFT?")[0].0, Verdict::Fail);
}

#[test]
fn repetitions_of_an_unknown_motion_are_not_judged() {
    let mut evidence = evidence_along(&heights(&[0.0, 0.0]));
    evidence.motion = PathMotion::Unknown;
    let found = found_in(CheckKind::Order, "Turn left. Turn left.", &evidence, WorldReach::default());
    assert_eq!(found[0].0, Verdict::Pass);
}

#[test]
fn repeated_climbs_need_as_many_rises() {
    let twice = "Go up the stairs. Walk on. Go up the stairs.";
    let order = |of: &[f64]| worst(CheckKind::Order, twice, &heights(of));
    assert_eq!((order(&[0.0, 0.2, 0.4]), order(&[0.0, 0.4, 0.4])), (Verdict::Pass, Verdict::Fail));
    assert_eq!(order(&[0.0, 0.4, 0.0]), Verdict::Fail, "the second move goes down");
    let down = "Go down the stairs. Walk on. Go down the stairs.";
    assert_eq!(worst(CheckKind::Order, down, &heights(&[0.4, 0.2, 0.0])), Verdict::Pass);
    assert_eq!(worst(CheckKind::Order, down, &heights(&[0.0, 0.2, 0.4])), Verdict::Fail);
}

#[test]
fn a_turn_may_be_repeated_from_twenty_degrees_on() {
    let tan = |share: f64| [(0.0, 0.0, 0.0), (0.0, 10.0, 0.0), (10.0 * share, 20.0, 0.0), (30.0 * share, 20.0, 0.0)];
    // A turn by the angle of this slope, and then on to the right by more than 20 degrees.
    let order = |share: f64| worst(CheckKind::Order, "Turn right. Walk on. Turn right.", &tan(share));
    assert_eq!((order(0.37), order(0.36)), (Verdict::Pass, Verdict::Fail));
    let left = |share: f64| worst(CheckKind::Order, "Turn left. Walk on. Turn left.", &tan(-share));
    assert_eq!((left(0.37), left(0.36)), (Verdict::Pass, Verdict::Fail));
    let back = [(0.0, 0.0, 0.0), (0.0, 4.0, 0.0), (0.0, 0.0, 0.0), (0.0, 4.0, 0.0)];
    let around = "Turn around. Walk on. Turn around.";
    assert_eq!(worst(CheckKind::Order, around, &back), Verdict::Pass);
    assert_eq!(worst(CheckKind::Order, around, &tan(0.5)), Verdict::Fail);
}

#[test]
fn more_turns_than_the_path_has_are_wrong_from_three_on() {
    let square = [(0.0, 0.0, 0.0), (0.0, 2.0, 0.0), (2.0, 2.0, 0.0), (2.0, 0.0, 0.0), (0.0, 0.0, 0.0)];
    let turns = |text: &str| found(CheckKind::Turns, text, &square);
    let reason = "the text tells more turns to this side than the path has";
    assert_eq!(turns("Turn right three times.")[0].0, Verdict::Pass);
    let four = turns("Turn right four times.");
    assert!(four.iter().any(|(verdict, _, why)| *verdict == Verdict::Fail && why == reason), "{four:?}");
    assert_eq!(turns("Turn left three times.").iter().map(|found| found.0).max(), Some(Verdict::Fail));
    assert_ne!(turns("Turn left twice.").iter().map(|found| found.0).max(), Some(Verdict::Fail));
    let mut unknown = evidence_along(&square);
    unknown.motion = PathMotion::Unknown;
    let found = found_in(CheckKind::Turns, "Turn left three times.", &unknown, WorldReach::default());
    assert!(found.iter().all(|(verdict, ..)| *verdict == Verdict::Unverified), "{found:?}");
}

#[test]
fn numbers_are_a_claim_from_three_on() {
    use CheckKind::{Landmarks, Order, Turns};
    let pass = (Verdict::Pass, vec![]);
    for (text, check) in [
        ("Walk past the third door.", Landmarks),
        ("Walk down the hallway and take the third left.", Turns),
        ("Walk down the hallway and stop. Do it three times.", Order),
    ] {
        assert_eq!(told(text, 0, 3), (Verdict::Unverified, vec![check]), "{text}");
        let two = text.replace("third", "second").replace("three", "two");
        assert_eq!(told(&two, 0, 3), pass, "{two}");
    }
    // Two sofas are near the path.
    assert_eq!(told("Walk past three sofas.", 0, 5), (Verdict::Unverified, vec![Landmarks]));
    assert_eq!(told("Walk past two sofas.", 0, 5), pass);
}

#[test]
fn each_denied_clause_has_one_finding_of_its_own_check() {
    let points = heights(&[0.0, 0.0]);
    let reason = "the program does not check what a text denies";
    let turns = found(CheckKind::Turns, "Do not turn left. Do not turn right.", &points);
    assert_eq!(turns.len(), 2, "{turns:?}");
    assert!(turns.iter().all(|(verdict, _, why)| *verdict == Verdict::Unverified && why == reason), "{turns:?}");
    for (check, text) in [
        (CheckKind::Landmarks, "Do not pass the sofa."),
        (CheckKind::Turns, "Do not turn left."),
        (CheckKind::Floors, "Never go up the stairs."),
    ] {
        let denied = found(check, text, &points);
        assert!(denied.iter().any(|(.., why)| why == reason), "{text}: {denied:?}");
    }
    let far = found(CheckKind::Turns, "If you turn left, you have gone too far.", &points);
    assert!(far.iter().all(|(.., why)| why != reason), "{far:?}");
}

#[test]
fn the_compass_belongs_to_turns_or_landmarks() {
    let points = heights(&[0.0, 0.0]);
    let reason = "the program does not know where north is";
    let has = |check, text: &str| found(check, text, &points).iter().any(|(.., why)| why == reason);
    assert!(has(CheckKind::Turns, "Head west.") && !has(CheckKind::Landmarks, "Head west."));
    let wall = "Stop at the east wall.";
    assert!(has(CheckKind::Landmarks, wall) && !has(CheckKind::Turns, wall));
}

#[test]
fn staying_is_unverified_on_a_path_of_more_than_three_metres() {
    let order = |length_m: f64, text: &str| {
        let found = found(CheckKind::Order, text, &[(0.0, 0.0, 0.0), (0.0, length_m, 0.0)]);
        (found[0].0, found[0].1.clone(), found[0].2.clone())
    };
    let pass = (Verdict::Pass, String::new(), String::new());
    assert_eq!(order(3.0, "Wait here."), pass);
    let (verdict, words, reason) = order(3.1, "Wait here.");
    assert_eq!((verdict, words.as_str()), (Verdict::Unverified, "Wait"));
    assert_eq!(reason, "the text only says to stop, and the path goes on");
    assert_eq!(order(3.1, "Walk straight on and wait."), pass);
    assert_eq!(order(3.1, "Walk straight on."), pass);
}

fn relations(text: &str) -> Vec<(String, WalkerRelation)> {
    let reading = read_instruction(text, &BTreeSet::new()).into_claims();
    read_claims(&reading).into_iter().map(|claim| (claim.name, claim.relation)).collect()
}

#[test]
fn relations_follow_the_words_of_motion() {
    use WalkerRelation::{Beside, Enter, Exit, Past, Stop, Through, Towards};
    for (text, wanted) in [
        ("Enter the kitchen.", Enter),
        ("Walk into the kitchen.", Enter),
        ("Leave the kitchen.", Exit),
        ("Walk through the kitchen.", Through),
        ("Walk along the hallway.", Through),
        ("Walk around the table.", Through),
        ("Walk past the sofa.", Past),
        ("Walk to the sofa.", Towards),
        ("Walk until you reach the sofa.", Towards),
        ("Stop at the sofa.", Stop),
        ("Wait in the kitchen.", Stop),
        ("Stop when you are back in the kitchen.", Stop),
        ("Stop once you get to the kitchen.", Stop),
        ("The sofa is green.", Beside),
        ("Wait facing the sofa.", Beside),
    ] {
        assert_eq!(relations(text).iter().map(|(_, relation)| *relation).collect::<Vec<_>>(), [wanted], "{text}");
    }
}

#[test]
fn only_the_place_of_the_last_stop_is_where_the_walk_ends() {
    use WalkerRelation::{Beside, Enter, Stop};
    let of = |text: &str| relations(text).into_iter().map(|(_, relation)| relation).collect::<Vec<_>>();
    assert_eq!(of("Stop at the bed. Walk into the kitchen."), [Beside, Enter]);
    assert_eq!(of("Walk into the kitchen. Stop at the bed."), [Enter, Stop]);
    assert_eq!(of("Stop at the bed. Go up the stairs.")[0], Beside);
    // What is beside the place of the stop only identifies it; but stairs are long.
    assert_eq!(of("Stop at the bed next to the window."), [Stop, Beside]);
    assert_eq!(of("Stop at the stairs next to the window."), [Stop, Stop]);
    assert_eq!(of("Stop next to the window."), [Stop]);
    // A clause of its own has its own stop.
    assert_eq!(of("Stop, the bed is green."), [Beside]);
}

#[test]
fn relations_have_the_names_of_the_weights() {
    use WalkerRelation::{Beside, Enter, Exit, Past, Stop, Through, Towards};
    let names = [Enter, Exit, Through, Stop, Towards, Past, Beside].map(WalkerRelation::name);
    assert_eq!(names, ["enter", "exit", "through", "stop", "towards", "past", "beside"]);
}

#[test]
fn claims_have_their_words_their_names_and_their_kinds() {
    let text = "Walk past the couch into the kitchen. Stop at the stairs.";
    let reading = read_instruction(text, &BTreeSet::new()).into_claims();
    let claims = read_claims(&reading);
    let words: Vec<&str> = claims.iter().map(|claim| &text[claim.span[0]..claim.span[1]]).collect();
    assert_eq!(words, ["couch", "kitchen", "stairs"]);
    let kinds: Vec<_> = claims.iter().map(|claim| (claim.is_room, claim.is_thing, claim.is_only_room())).collect();
    assert_eq!(kinds, [(false, true, false), (true, false, true), (true, true, false)]);
    let clauses: Vec<usize> = claims.iter().map(|claim| claim.clause_in(&reading)).collect();
    assert!(clauses[1] > 0 || clauses[2] > clauses[1], "{clauses:?}");
    assert_ne!(clauses[2], clauses[0]);
    assert_eq!(claims[2].clause_in(&reading), reading.events[claims[2].event].clause);
}

/// The findings about landmarks on a path between two viewpoints of the made-up building.
fn landmarks(text: &str, from: usize, to: usize) -> Vec<(Verdict, String, String)> {
    let (_, evidence, around) = path(from, to);
    found_in(CheckKind::Landmarks, text, &evidence, WorldReach { surroundings: Some(&around), calibration: None })
}

#[test]
fn a_side_is_in_doubt_where_each_listed_thing_is_on_the_other() {
    // All things lie one metre east of their viewpoints, and the path goes north: they are on the right.
    for (name, from, to) in [("plant", 1, 3), ("fireplace", 4, 6)] {
        for side in ["right", "left"] {
            let found = landmarks(&format!("Walk past the {name} on your {side}."), from, to);
            let reason = format!("every {name:?} that is listed near the path is on another side, which says little");
            match side {
                "right" => assert_eq!(found[0].0, Verdict::Pass, "{name}"),
                _ => assert_eq!(found, [(Verdict::Unverified, name.to_owned(), reason)]),
            }
        }
        // From two metres farther back or on, it is nearly straight ahead or behind.
        let left = format!("Walk past the {name} on your left.");
        assert_eq!(landmarks(&left, from - 1, to)[0].0, Verdict::Pass, "{name}");
        assert_eq!(landmarks(&left, from, to + 1)[0].0, Verdict::Pass, "{name}");
    }
    // Ahead and behind are not compared.
    assert_eq!(landmarks("Walk to the plant ahead of you.", 1, 3)[0].0, Verdict::Pass);
    // Nothing is known of a side without surroundings.
    let (_, mut evidence, _) = path(0, 5);
    evidence.frames[2].things.push(crate::SeenThing { name: "plant".into(), ..Default::default() });
    let alone = found_in(CheckKind::Landmarks, "Walk past the plant on your left.", &evidence, WorldReach::default());
    assert_eq!(alone[0].0, Verdict::Pass);
    evidence.motion = PathMotion::Unknown;
    let unknown =
        found_in(CheckKind::Landmarks, "Walk past the plant on your right.", &evidence, WorldReach::default());
    let reason = "the program cannot check on which side of the walker \"plant\" is";
    assert_eq!((unknown[0].0, unknown[0].2.as_str()), (Verdict::Unverified, reason));
}

#[test]
fn a_mirrored_path_mirrors_the_sides() {
    let along = |points: &[(f64, f64, f64)], text: &str| {
        let path = path_along(points);
        let mut evidence = Evidence::for_path_alone(&path);
        evidence.source = crate::EvidenceSource::Labels;
        let building = Arc::new(BuildingInventory::from_survey(&survey()));
        let around = PathSurroundings::around_path(&building, &path).unwrap();
        let reach = WorldReach { surroundings: Some(&around), calibration: None };
        found_in(CheckKind::Landmarks, text, &evidence, reach)[0].0
    };
    let (north, east) = ([(0.0, 2.0, 1.5), (0.0, 6.0, 1.5)], [(-2.0, 2.0, 1.5), (4.0, 2.0, 1.5)]);
    let back = |[first, last]: [(f64, f64, f64); 2]| [last, first];
    // The plant is one metre east of the way north, and two metres north of the way east.
    for (way, right, wrong) in [
        (north, "right", "left"),
        (back(north), "left", "right"),
        (east, "left", "right"),
        (back(east), "right", "left"),
    ] {
        assert_eq!(along(&way, &format!("Walk past the plant on your {right}.")), Verdict::Pass, "{way:?}");
        assert_eq!(along(&way, &format!("Walk past the plant on your {wrong}.")), Verdict::Unverified, "{way:?}");
    }
}

#[test]
fn stretches_of_rooms_and_doors_are_counted_for_repeated_motions() {
    // Through the bedroom into the hallway and on into the living room.
    let order = |text: &str, from: usize, to: usize| {
        let (_, evidence, around) = path(from, to);
        let reach = WorldReach { surroundings: Some(&around), calibration: None };
        found_in(CheckKind::Order, text, &evidence, reach).iter().map(|found| found.0).max().unwrap()
    };
    let doors = "Walk through the door. Turn left. Walk through the door.";
    assert_eq!((order(doors, 0, 3), order(doors, 1, 3)), (Verdict::Pass, Verdict::Fail));
    let rooms = "Walk into the living room. Turn left. Walk into the living room.";
    assert_eq!(order(rooms, 0, 5), Verdict::Fail);
    let sofas = "Walk past the sofa. Turn left. Walk past the sofa.";
    assert_eq!((order(sofas, 0, 2), order(sofas, 0, 3)), (Verdict::Fail, Verdict::Pass), "a second sofa is farther on");
    let stairs = "Walk past the stairs. Turn left. Walk past the stairs.";
    assert_eq!(order(stairs, 7, 9), Verdict::Fail);
}

#[test]
fn a_hallway_with_a_corner_may_be_two() {
    let twice = "Walk down the hallway. Turn right. Walk down the hallway.";
    let order = |points: &[(f64, f64, f64)], rooms: &[&str]| {
        let mut evidence = evidence_along(points);
        for (frame, room) in evidence.frames.iter_mut().zip(rooms) {
            frame.rooms = vec![(*room).to_owned()];
        }
        found_in(CheckKind::Order, twice, &evidence, WorldReach::default())[0].0
    };
    let corner = [(0.0, 0.0, 0.0), (0.0, 2.0, 0.0), (2.0, 2.0, 0.0)];
    let straight = [(0.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 4.0, 0.0)];
    assert_eq!(order(&corner, &["hallway"; 3]), Verdict::Pass);
    assert_eq!(order(&straight, &["hallway"; 3]), Verdict::Fail);
    assert_eq!(order(&straight, &["hallway", "den", "hallway"]), Verdict::Pass);
    assert_eq!(order(&corner, &["hallway", "bedroom", "bedroom"]), Verdict::Fail, "the corner is in the bedroom");
}

/// The worst finding about the order, on the path from the bedroom into the hallway: a plant, a rug and one sofa are there.
fn order_in_hallway(text: &str) -> Verdict {
    let (_, evidence, around) = path(0, 2);
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    found_in(CheckKind::Order, text, &evidence, reach).iter().map(|found| found.0).max().unwrap()
}

#[test]
fn a_repeated_motion_fails_by_the_same_relation_to_the_same_place() {
    for text in [
        "Walk past the sofa. Turn left. Now walk past the sofa.",
        "Walk past the sofa. Stop. Now walk past the sofa.",
        "Walk past the sofa. Go on. Turn left past the sofa.",
        "Walk past the two plants. Walk past the sofa. Turn left. Now walk past the sofa.",
        "Walk out of the bedroom. Turn left. Now walk out of the bedroom.",
        "Walk past the chandelier. Turn left. Now walk past the chandelier.",
        "Go up the stairs. Turn left. Now go up the stairs.",
        "Walk into the hallway. Turn left. Now walk into the hallway.",
    ] {
        assert_eq!(order_in_hallway(text), Verdict::Fail, "{text}");
    }
    for text in [
        "Walk into the bedroom. Turn left. Walk out of the bedroom.",
        "Walk past the sofa. Turn left. Walk past the plant.",
        "Walk past the sofa and past the sofa.",
        "Go up the stairs. Turn left. Go down the stairs.",
        "Walk past the garage. Turn left. Now walk past the garage.",
        "Walk through the fountain. Turn left. Now walk through the fountain.",
    ] {
        assert_eq!(order_in_hallway(text), Verdict::Pass, "{text}");
    }
}

#[test]
fn words_that_only_locate_something_are_no_repeated_motion() {
    for again in [
        "Walk past the foot of the sofa.",
        "Walk just past the sofa.",
        "Walk two feet past the sofa.",
        "Take the second left past the sofa.",
        "The plant is past the sofa.",
        "Walk to the plant past the sofa.",
        "Stop past the sofa.",
        "Walk past the first sofa.",
        "Walk past the sofas.",
    ] {
        let text = format!("Walk past the sofa. Turn left. {again}");
        assert_ne!(order_in_hallway(&text), Verdict::Fail, "{text}");
    }
}

#[test]
fn a_room_may_be_entered_again_after_it_was_left() {
    for (text, wanted) in [
        ("Walk into the hallway. Leave the hallway. Now walk into the hallway.", Verdict::Pass),
        ("Walk into the hallway. Walk through the bedroom. Now walk into the hallway.", Verdict::Pass),
        ("Walk into the hallway. Walk past the sofa. Now walk into the hallway.", Verdict::Fail),
        ("Leave the bedroom. Enter the bedroom. Now leave the bedroom.", Verdict::Pass),
        ("Leave the bedroom. Walk into the hallway. Now leave the bedroom.", Verdict::Fail),
        // A thing stays one thing, however one goes.
        ("Walk past the sofa. Walk through the bedroom. Now walk past the sofa.", Verdict::Fail),
    ] {
        assert_eq!(order_in_hallway(text), wanted, "{text}");
    }
}

#[test]
fn going_past_the_place_of_the_stop_is_wrong() {
    let wrong = "Walk past the sofa. Stop by the sofa.";
    assert_eq!(order_in_hallway(wrong), Verdict::Fail);
    for text in [
        "Walk past the sofa. Turn left. Stop by the sofa.",
        "Walk past the first sofa. Stop by the first sofa.",
        "Walk past the sofa on your left. Stop by the sofa.",
        "Walk past the sofa. Stop by the sofa on your right.",
        "Walk past the plant. Stop by the sofa.",
        "Walk past the sofa and stop past the end of the sofa.",
        "Walk to the sofa. Stop by the sofa.",
    ] {
        assert_ne!(order_in_hallway(text), Verdict::Fail, "{text}");
    }
}

#[test]
fn one_repetition_has_one_finding() {
    let (_, evidence, around) = path(0, 2);
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    let found = |text: &str| found_in(CheckKind::Order, text, &evidence, reach);
    // The whole sentence is repeated, and the motion is a part of it.
    let sentence = found("Walk past the sofa. Walk past the sofa.");
    assert_eq!(sentence.len(), 1, "{sentence:?}");
    // Beside a repeated sentence, another motion has a finding of its own.
    let two = found("Walk past the plant. Walk past the sofa. Walk past the sofa. Turn left. Now walk past the plant.");
    assert_eq!(two.len(), 2, "{two:?}");
    // "Three times" is counted with its turn, and not again by itself.
    let turns = found("Turn right three times.");
    assert_eq!(turns, [(Verdict::Pass, String::new(), String::new())]);
    assert_eq!(found("Turn right. Do it three times.")[0].1, "three times");
    assert_eq!(found("Do it three times. Turn right.")[0].1, "three times");
}
