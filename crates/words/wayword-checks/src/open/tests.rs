//! Tests of the open world, on an invented building.

mod judgement;
mod rules;

use crate::{
    BuildingInventory, CheckSubject, Evidence, PathSurroundings, Testimony, TurnJudge, WorldReach, check_text,
    lift_confirmed,
};
use std::sync::Arc;
use wayword_core::{
    CheckKind, DVec3, Frame, Heading, InstructionStyle, ObjectId, ObjectLabel, Path, PathMotion, PlacedObject, SceneId,
    Verdict, ViewpointGraph, ViewpointId, ViewpointSurvey, graph::GraphError, path::PathStop,
    survey::ViewpointKnowledge,
};

/// A hallway along y with a viewpoint every two metres, and rooms behind it: the room of each viewpoint, the things listed
/// there, and how high it lies.
const BUILDING: [(&str, &[&str], f64); 10] = [
    ("bedroom", &["bed", "lamp", "dresser"], 0.0),
    ("hallway", &["picture", "rug"], 0.0),
    ("hallway", &["sofa", "plant"], 0.0),
    ("hallway", &["chair", "table"], 0.0),
    ("living room", &["tv", "sofa", "coffee table"], 0.0),
    ("living room", &["fireplace", "chair"], 0.0),
    ("dining room", &["dining table", "chandelier"], 0.0),
    ("kitchen", &["refrigerator", "stove", "sink", "cabinet"], 0.0),
    ("bathroom", &["toilet", "bathtub", "mirror"], 0.0),
    ("stairs", &["stairs"], 1.5),
];

fn id(at: usize) -> ViewpointId {
    ViewpointId::new(format!("v{at}")).unwrap()
}

fn position(at: usize) -> DVec3 {
    DVec3::new(0.0, 2.0 * at as f64, 1.5 + BUILDING[at].2)
}

fn object(at: usize, name: &str) -> ObjectId {
    ObjectId::new(format!("{name}-{at}").replace(' ', "-")).unwrap()
}

fn survey() -> ViewpointSurvey {
    survey_with(None)
}

/// The building, where a floor may be known that is as high everywhere.
fn survey_with(floor_m: Option<f64>) -> ViewpointSurvey {
    let mut graph = ViewpointGraph::default();
    for at in 0..BUILDING.len() {
        graph.add_viewpoint(id(at), position(at), Some(1)).unwrap();
        if let Some(floor_m) = floor_m {
            graph.set_floor(&id(at), floor_m).unwrap();
        }
    }
    for at in 1..BUILDING.len() {
        graph.join_viewpoints(&id(at - 1), &id(at)).unwrap();
    }
    let known = |viewpoint: &ViewpointId, eye: DVec3| {
        let at: usize = viewpoint.as_str()[1..].parse().unwrap();
        let label = |name: &&str| ObjectLabel {
            object: object(at, name),
            name: (*name).to_owned(),
            heading: Heading::new(1.5).unwrap(),
            elevation_rad: 0.0,
            box_px: None,
            distance_m: None,
            position: Some(eye + DVec3::new(1.0, 0.0, 0.0)),
            colour: None,
            room: None,
        };
        let things = BUILDING[at].1.iter().map(label).collect();
        Ok::<_, GraphError>(ViewpointKnowledge { room: Some(BUILDING[at].0.to_owned()), things: Some(things) })
    };
    let hidden = PlacedObject { object: object(1, "piano"), name: "piano".into(), position: DVec3::new(1.0, 2.0, 1.0) };
    ViewpointSurvey::from_graph(&graph, known).unwrap().with_objects(vec![hidden])
}

/// The path between two viewpoints, with its evidence and surroundings.
fn path(from: usize, to: usize) -> (Path, Evidence, PathSurroundings) {
    let stop = |at: usize| PathStop { position: position(at), viewpoint: Some(id(at)), level: Some(1) };
    let frames: Vec<Frame> = Path::frames_along((from..=to).map(stop).collect(), None);
    let scene = SceneId::new("made-up").unwrap();
    let path = Path { id: "1".into(), scene, frames, motion: PathMotion::Known, target: None };
    let mut evidence = Evidence::for_path_alone(&path);
    for (frame, at) in evidence.frames.iter_mut().zip(from..) {
        frame.rooms = vec![BUILDING[at].0.to_owned()];
        frame.knows_things = true;
    }
    evidence.source = crate::EvidenceSource::Labels;
    let around = PathSurroundings::around_path(&Arc::new(BuildingInventory::from_survey(&survey())), &path).unwrap();
    (path, evidence, around)
}

fn any() -> InstructionStyle {
    InstructionStyle { name: "any".into(), ..InstructionStyle::default() }
}

/// The verdict on a text about the path between two viewpoints, with the checks that have it.
fn told(text: &str, from: usize, to: usize) -> (Verdict, Vec<CheckKind>) {
    let (_, evidence, around) = path(from, to);
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    let style = any();
    let subject =
        CheckSubject { turns: TurnJudge::JudgedElsewhere, ..CheckSubject::open_world(&evidence, &style, reach) };
    let checked = check_text(text, subject);
    let verdict = checked.verdict();
    let of = checked.findings.iter().filter(|finding| finding.verdict == verdict && verdict != Verdict::Pass);
    let mut checks: Vec<CheckKind> = of.map(|finding| finding.check).collect();
    checks.dedup();
    (verdict, checks)
}

const PASSES: (Verdict, Vec<CheckKind>) = (Verdict::Pass, Vec::new());

#[test]
fn listed_objects_within_three_metres_pass_even_if_no_viewpoint_shows_them() {
    assert_eq!(told("Walk past the sofa and stop at the chair.", 0, 3), PASSES);
    assert_eq!(told("Walk past the piano in the hallway.", 0, 3), PASSES);
    assert_eq!(told("Walk along the wall to the corner and through the doorway.", 0, 3), PASSES);
}

#[test]
fn an_object_that_labels_merely_do_not_list_is_unverified() {
    for text in ["Walk past the cabinet and stop by the chair.", "Walk past the pillar."] {
        assert_eq!(told(text, 0, 3), (Verdict::Unverified, vec![CheckKind::Landmarks]), "{text}");
    }
    // Nor does the reader know this word.
    let unknown = (Verdict::Unverified, vec![CheckKind::Landmarks, CheckKind::Coverage]);
    assert_eq!(told("Walk past the xylorimba.", 0, 3), unknown);
}

#[test]
fn a_room_that_the_path_comes_nowhere_near_fails() {
    for text in ["Leave the bedroom and walk through the kitchen.", "Walk through the bathroom and stop by the chair."]
    {
        assert_eq!(told(text, 0, 3), (Verdict::Fail, vec![CheckKind::Landmarks]), "{text}");
    }
    assert_eq!(told("Leave the bedroom and walk down the hallway.", 0, 3), PASSES);
    // A room without a name may be any.
    let (path, mut evidence, around) = path(0, 3);
    evidence.frames[2].rooms.clear();
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    let checked = check_text("Walk into the kitchen.", CheckSubject::open_world(&evidence, &any(), reach));
    assert_eq!(checked.verdict(), Verdict::Unverified, "{}", path.id);
}

#[test]
fn climbs_are_checked_by_floor_heights() {
    for text in ["Go up the stairs.", "Walk up the first few steps of the stairs.", "Climb the stairs and stop."] {
        assert_eq!(told(text, 7, 9).0, Verdict::Pass, "{text}");
        assert_eq!(told(text, 0, 3).1, [CheckKind::Floors], "{text}");
    }
    assert_eq!(told("Go down the stairs.", 7, 9), (Verdict::Fail, vec![CheckKind::Floors]));
    for text in ["Walk past the stairs leading down.", "Stop before you go up the stairs."] {
        assert_ne!(told(text, 0, 3).1, [CheckKind::Floors], "{text}");
    }
    // The eye is higher at the end, but the floor is not.
    let (path, evidence, _) = path(7, 9);
    let around =
        PathSurroundings::around_path(&Arc::new(BuildingInventory::from_survey(&survey_with(Some(0.0)))), &path)
            .unwrap();
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    let checked = check_text("Walk up the stairs.", CheckSubject::open_world(&evidence, &any(), reach));
    let finding = checked.findings.iter().find(|finding| finding.check == CheckKind::Floors).unwrap();
    assert_eq!((finding.verdict, finding.span), (Verdict::Fail, Some([0, 18])));
    // People count storeys as they like.
    assert_eq!(told("Walk down the hallway on the third floor.", 0, 3), (Verdict::Unverified, vec![CheckKind::Floors]));
}

#[test]
fn a_repeated_statement_needs_two_stretches_of_the_path() {
    for text in [
        "Walk past the piano. Turn left. Walk past the piano and stop.",
        "Enter the hallway. Enter the hallway. Wait there.",
        "Leave the bedroom and walk past the sofa to the chair. Leave the bedroom and walk past the sofa to the chair.",
    ] {
        assert_eq!(told(text, 0, 3), (Verdict::Fail, vec![CheckKind::Order]), "{text}");
    }
    for text in [
        "Walk past the piano. Once past the piano, stop.",
        "Walk down the hallway. In the hallway, walk to the chair.",
        "Leave the bedroom and turn left out of the bedroom.",
        "Walk past the sofa. The rug is just past the sofa.",
        "Walk past the long rug. Turn left and walk past the round rug.",
        "Walk around the sofa. Turn left and walk around the sofa.",
        "Walk past the wall. Turn left and walk past the wall.",
        "Leave the bedroom. Stop in the hallway.",
    ] {
        assert_eq!(told(text, 0, 3), PASSES, "{text}");
    }
}

/// The verdict on a text about a path through points two metres apart, each with its height; no objects or rooms are
/// known.
fn told_of(text: &str, points: &[(f64, f64, f64)]) -> (Verdict, Vec<String>) {
    let stop =
        |(x, y, z): &(f64, f64, f64)| PathStop { position: DVec3::new(*x, *y, *z), viewpoint: None, level: Some(1) };
    let frames = Path::frames_along(points.iter().map(stop).collect(), None);
    let scene = SceneId::new("made-up").unwrap();
    let path = Path { id: "1".into(), scene, frames, motion: PathMotion::Known, target: None };
    let evidence = Evidence::for_path_alone(&path);
    let checked = check_text(text, CheckSubject::open_world(&evidence, &any(), WorldReach::default()));
    let wrong = checked.findings.iter().filter(|finding| finding.verdict == Verdict::Fail);
    (checked.verdict(), wrong.map(|finding| finding.reason.clone()).collect())
}

#[test]
fn repeated_turns_pass_as_often_as_the_path_has_them() {
    // A walk around a block: three turns to one side.
    let around = [(0.0, 0.0, 1.5), (0.0, 2.0, 1.5), (2.0, 2.0, 1.5), (2.0, 0.0, 1.5), (0.0, 0.0, 1.5)];
    let fails = |text: &str| told_of(text, &around).0 == Verdict::Fail;
    assert!(!fails("Turn right. Walk on. Turn right. Walk along. Turn right. Stop."));
    assert!(fails("Turn right. Walk on. Turn right. Walk along. Turn right. Go on. Turn right."), "there are three");
    assert!(fails("Turn left. Walk on. Turn left."));
    assert!(fails("Walk on. Turn right. Turn right."), "twice in a row is a copy");
    assert!(fails("Walk straight on. Walk straight on."));
}

#[test]
fn stairs_down_and_up_again_are_two_motions() {
    let fails = |text: &str, heights: [f64; 4]| {
        let points: Vec<(f64, f64, f64)> =
            heights.iter().zip(0..).map(|(z, at)| (0.0, 2.0 * f64::from(at), *z)).collect();
        told_of(text, &points).0 == Verdict::Fail
    };
    let (down_and_up, once_up) = ([3.0, 1.5, 1.69, 1.88], [1.5, 3.0, 3.0, 3.0]);
    assert!(!fails("Go down steps, turn left and go up steps.", down_and_up));
    assert!(fails("Go up steps, turn left and go up steps.", once_up));
}

#[test]
fn storeys_are_checked_by_floor_heights() {
    let down = [(0.0, 0.0, 4.5), (0.0, 2.0, 3.0), (0.0, 4.0, 1.5)];
    for text in ["Take the stairs to the upper floor.", "Go to the floor above.", "Take the elevator up."] {
        assert_eq!(told_of(text, &down), (Verdict::Fail, vec!["the path nowhere goes up".to_owned()]), "{text}");
    }
    for text in ["Take the stairs to the lower floor.", "Take the elevator down.", "Start on the upper floor."] {
        assert_ne!(told_of(text, &down).0, Verdict::Fail, "{text}");
    }
}

#[test]
fn a_stop_is_checked_at_the_end_of_the_path() {
    for text in [
        "Walk down the hallway and stop when you are back in the bedroom.",
        "Walk down the hallway. Stop when you are in the bedroom.",
    ] {
        assert_ne!(told(text, 0, 5), PASSES, "{text}");
    }
    let by_stairs = |thing: &str| told(&format!("Stop at the foot of the stairs next to the {thing}."), 6, 9);
    assert_eq!(by_stairs("toilet"), PASSES);
    assert_ne!(by_stairs("chandelier"), PASSES);
    for text in ["Stay where you are.", "Wait here."] {
        assert_eq!(told(text, 1, 5), (Verdict::Unverified, vec![CheckKind::Order]), "{text}");
    }
    assert_eq!(told("Stay where you are and walk to the sofa.", 1, 5), PASSES);
}

#[test]
fn statements_that_no_rule_judges_are_unverified() {
    for (text, check) in [
        ("Walk down the hallway. Never go down the stairs.", CheckKind::Floors),
        ("Walk down the hallway. There is no toilet.", CheckKind::Landmarks),
        ("Walk down the hallway. Do not turn right.", CheckKind::Turns),
        ("Walk down the hallway and take the third left.", CheckKind::Turns),
        ("Walk down the hallway and stop at the fourth door on the right.", CheckKind::Landmarks),
        ("Walk past three sofas.", CheckKind::Landmarks),
        ("Walk down the hallway and stop. Do it three times.", CheckKind::Order),
        ("Head west down the hallway.", CheckKind::Turns),
        ("Walk down the hallway. Face north.", CheckKind::Turns),
    ] {
        assert_eq!(told(text, 0, 3), (Verdict::Unverified, vec![check]), "{text}");
    }
    for text in [
        "Walk down the hallway. If you see the stove, you have gone too far.",
        "Walk no further than the sofa.",
        "Walk past the first door.",
    ] {
        assert_eq!(told(text, 0, 3), PASSES, "{text}");
    }
    assert_eq!(told("Walk down the hallway. Turn right five times.", 0, 3), (Verdict::Fail, vec![CheckKind::Turns]));
}

#[test]
fn a_finding_about_a_motion_covers_its_verb() {
    let (_, evidence, around) = path(0, 3);
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    let wrong = |text: &str| {
        let checked = check_text(text, CheckSubject::open_world(&evidence, &any(), reach));
        let span = checked.findings.iter().find(|finding| finding.verdict == Verdict::Fail).and_then(|fail| fail.span);
        span.map(|[from, to]| text[from..to].to_owned())
    };
    let text = "Walk past the piano and turn left. Walk past the piano and wait.";
    assert_eq!(wrong(text).as_deref(), Some("Walk past the piano"));
    let text = "Leave the bedroom. Walk past the sofa and stop in front of the sofa.";
    assert_eq!(wrong(text).as_deref(), Some("Walk past"));
    let text = "Leave the bedroom. Walk past the closet and stop in the closet doorway.";
    assert_eq!(wrong(text).as_deref(), Some("Walk past"));
    assert_eq!(wrong("Leave the bedroom. Walk past the sofa and stop between the sofa and the chair."), None);
    assert_eq!(wrong("Leave the bedroom. Walk to the sofa and stop in front of the sofa."), None);
}

#[test]
fn only_the_last_stop_is_where_the_walk_ends() {
    assert_eq!(told("Stop at the bed. Then walk into the hallway and stop at the chair.", 0, 3), PASSES);
    assert_ne!(told("Walk into the hallway and stop at the bed.", 0, 3), PASSES);
}

#[test]
fn a_distance_is_checked_by_the_length_of_the_path() {
    assert_eq!(told("Walk 6 meters down the hallway.", 0, 3), PASSES);
    assert_eq!(told("Walk 500 meters down the hallway.", 0, 3), (Verdict::Fail, vec![CheckKind::Order]));
}

#[test]
fn turns_are_left_to_the_comparison_of_walks() {
    assert_eq!(told("Turn left and walk down the hallway.", 0, 3), PASSES);
    assert_eq!(told("Turn around and walk down the hallway.", 0, 3), PASSES);
    let (_, evidence, _) = path(0, 3);
    let style = any();
    let turns = |turns: TurnJudge| {
        let subject = CheckSubject { turns, ..CheckSubject::open_world(&evidence, &style, WorldReach::default()) };
        let checked = check_text("Turn left. Turn right.", subject);
        let of_turns = checked.findings.into_iter().filter(|finding| finding.check == CheckKind::Turns);
        of_turns.map(|finding| (finding.verdict, finding.reason)).collect::<Vec<_>>()
    };
    assert_eq!(turns(TurnJudge::JudgedElsewhere), [(Verdict::Pass, String::new())]);
    let unjudged = turns(TurnJudge::NotJudged("nobody looks"));
    assert_eq!(unjudged.len(), 2, "each turn is unverified: {unjudged:?}");
    assert!(unjudged.iter().all(|(verdict, why)| *verdict == Verdict::Unverified && why.ends_with("nobody looks")));
}

#[test]
fn the_distance_of_the_nearest_one_has_one_decimal() {
    let (_, evidence, around) = path(0, 3);
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    let checked = check_text("Walk through the kitchen.", CheckSubject::open_world(&evidence, &any(), reach));
    let reason = &checked.findings.iter().find(|finding| finding.verdict == Verdict::Fail).unwrap().reason;
    assert!(reason.contains("the nearest is 6.0 m off"), "{reason}");
}

#[test]
fn without_surroundings_an_absence_is_unverified() {
    let (_, evidence, _) = path(0, 3);
    let verdict =
        |text: &str| check_text(text, CheckSubject::open_world(&evidence, &any(), WorldReach::default())).verdict();
    for text in ["Walk into the kitchen.", "Walk past the toilet."] {
        assert_eq!(verdict(text), Verdict::Unverified, "{text}");
    }
    assert_eq!(verdict("Go up the stairs."), Verdict::Fail);
}

#[test]
fn lift_turns_a_confirmed_failure_into_unverified() {
    let (_, evidence, around) = path(0, 3);
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    let verdict = |text: &str, other: &str| {
        let mut checked = check_text(text, CheckSubject::open_world(&evidence, &any(), reach));
        lift_confirmed(
            &mut checked,
            &Testimony::from_text(text, &evidence),
            &[&Testimony::from_text(other, &evidence)],
        );
        checked.verdict()
    };
    assert_eq!(verdict("Walk through the kitchen.", "Go to the kitchen and stop."), Verdict::Unverified);
    assert_eq!(verdict("Walk through the kitchen.", "Go to the chair and stop."), Verdict::Fail);
    for copy in ["Go up the stairs.", "Go up the stairs. ", "go up  the stairs!"] {
        assert_eq!(verdict("Go up the stairs.", copy), Verdict::Fail, "a copy is no witness: {copy:?}");
    }
    assert_eq!(verdict("Go up the stairs.", "Climb the stairs."), Verdict::Unverified);
    assert_eq!(verdict("Go up the stairs.", "Go down the stairs."), Verdict::Fail);
    let twice = "Enter the hallway. Enter the hallway.";
    assert_eq!(verdict(twice, twice), Verdict::Fail, "what is said twice is the text's own fault");
}

#[test]
fn the_weights_that_ship_can_be_read_and_hold_every_case() {
    let weights = super::SilenceWeights::shipped();
    for case in super::ClaimCase::ALL {
        let table = weights.table_for(case).unwrap();
        assert!(table.fails_at >= 3.0 && table.weights.contains_key("bias"), "{case:?}");
    }
}
