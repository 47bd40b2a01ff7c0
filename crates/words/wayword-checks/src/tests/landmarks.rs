//! Tests of landmarks: which are shown, which are denied, on which side and in which colour.

use crate::{
    Evidence, EvidenceSource, SeenThing,
    tests::{fails, findings_of, finds, frame, has_no_mistake, is_unverified, on_video, passes, to_the_bedroom, walk},
};
use wayword_core::{CheckKind, Verdict};

fn verdict(text: &str, path: &Evidence) -> Verdict {
    findings_of(CheckKind::Landmarks, text, path).iter().map(|found| found.0).max().unwrap()
}

#[test]
fn a_landmark_passes_by_any_name_of_the_lexicon_and_fails_by_another() {
    let path = to_the_bedroom();
    for name in ["sofa", "couch", "settee", "loveseat"] {
        passes(&format!("Walk past the {name} into the bedroom."), &path);
    }
    for name in ["chair", "table", "piano"] {
        let text = format!("Walk past the {name} into the bedroom.");
        let reason = format!("no frame of the path shows {name:?}");
        finds(CheckKind::Landmarks, Verdict::Fail, name, &reason, &text, &path);
    }
    for name in ["hallway", "hall", "corridor"] {
        passes(&format!("Walk through the {name} into the bedroom."), &path);
    }
    fails(CheckKind::Landmarks, "Walk through the kitchen into the bedroom.", &path);
}

#[test]
fn each_wrong_landmark_has_a_finding_of_its_own() {
    let text = "Walk past the piano and past the chair into the bedroom.";
    let words: Vec<String> =
        findings_of(CheckKind::Landmarks, text, &to_the_bedroom()).into_iter().map(|found| found.1).collect();
    assert_eq!(words, ["piano", "chair"]);
}

#[test]
fn an_absent_landmark_is_open_where_one_frame_is_unknown() {
    let mut path = to_the_bedroom();
    path.frames[0].knows_things = false;
    let reason = "the program cannot check whether there is \"piano\"";
    finds(CheckKind::Landmarks, Verdict::Unverified, "piano", reason, "Walk past the piano.", &path);
    fails(CheckKind::Landmarks, "Walk through the kitchen.", &path);
    let mut rooms = to_the_bedroom();
    rooms.frames[0].rooms.clear();
    is_unverified(CheckKind::Landmarks, "Walk through the kitchen.", &rooms);
    fails(CheckKind::Landmarks, "Walk past the piano.", &rooms);
}

#[test]
fn a_path_without_any_evidence_is_unverified_even_if_no_place_is_named() {
    let blank = walk(vec![frame("", None, 1), frame("", None, 1)], &[(0.0, 0.0)]);
    let reason = "the program does not know what can be seen along the path";
    finds(CheckKind::Landmarks, Verdict::Unverified, "", reason, "Walk straight ahead.", &blank);
    let named = findings_of(CheckKind::Landmarks, "Walk past the sofa.", &blank);
    assert_eq!(named.len(), 1);
    assert_eq!(named[0].2, "the program cannot check whether there is \"sofa\"");
    has_no_mistake(CheckKind::Landmarks, "Walk straight ahead.", &to_the_bedroom());
}

#[test]
fn walls_floors_and_ceilings_are_in_every_building() {
    let path = to_the_bedroom();
    for name in ["wall", "floor", "ceiling"] {
        has_no_mistake(CheckKind::Landmarks, &format!("Walk along the {name} into the bedroom."), &path);
    }
    assert_ne!(verdict("Walk past the red wall into the bedroom.", &path), Verdict::Pass);
    assert_ne!(verdict("Walk past the wall on your left into the bedroom.", &path), Verdict::Pass);
}

#[test]
fn rooms_and_things_beyond_the_end_only_identify_something() {
    let mut path = to_the_bedroom();
    path.beyond.rooms = vec!["kitchen".into()];
    path.beyond.things = vec!["piano".into()];
    has_no_mistake(CheckKind::Landmarks, "Stop at the bed next to the kitchen.", &path);
    has_no_mistake(CheckKind::Landmarks, "Stop at the bed next to the piano.", &path);
    has_no_mistake(CheckKind::Landmarks, "Walk to the bedroom with the piano.", &path);
    // No walker goes past what lies beyond the end, and no other room or thing lies there.
    fails(CheckKind::Landmarks, "Walk past the piano into the bedroom.", &path);
    fails(CheckKind::Landmarks, "Walk through the kitchen into the bedroom.", &path);
    fails(CheckKind::Landmarks, "Stop at the bed next to the stove.", &path);
    is_unverified(CheckKind::Landmarks, "Stop at the bed next to the garage.", &path);
    // A side is a claim that the evidence does not hold.
    assert_ne!(verdict("Stop at the bed next to the piano on your left.", &path), Verdict::Pass);
}

#[test]
fn a_landmark_passes_on_its_side_and_fails_on_the_other() {
    let mut path = to_the_bedroom();
    for (rad, right, wrong) in [(-0.8, "left", "right"), (0.8, "right", "left")] {
        path.frames[1].things[0].turn_rad = Some(rad);
        // The move at that frame turns by 90 degrees, so seen when leaving, the sofa is behind on the left.
        path.moves[1].turn_rad = 0.0;
        passes(&format!("Walk past the sofa on your {right} into the bedroom."), &path);
        let text = format!("Walk past the sofa on your {wrong} into the bedroom.");
        let reason = format!("\"sofa\" is not on the {wrong} where the path passes it");
        finds(CheckKind::Landmarks, Verdict::Fail, "sofa", &reason, &text, &path);
    }
}

#[test]
fn a_wrong_side_is_open_where_the_thing_may_be_elsewhere_too() {
    let mut path = to_the_bedroom();
    path.frames[1].things[0].turn_rad = Some(0.8);
    path.moves[1].turn_rad = 0.0;
    let text = "Walk past the sofa on your left into the bedroom.";
    fails(CheckKind::Landmarks, text, &path);
    let mut unknown = path.clone();
    unknown.frames[0].knows_things = false;
    is_unverified(CheckKind::Landmarks, text, &unknown);
    let captions = Evidence { source: EvidenceSource::Captions, ..path.clone() };
    is_unverified(CheckKind::Landmarks, text, &captions);
    // Without a direction there is nothing to compare the side with.
    path.frames[1].things[0].turn_rad = None;
    passes(text, &path);
}

#[test]
fn the_side_of_an_unknown_motion_has_a_reason_of_its_own() {
    let reason = "the program cannot check on which side of the walker \"sofa\" is";
    let text = "Walk past the sofa on your left into the bedroom.";
    finds(CheckKind::Landmarks, Verdict::Unverified, "sofa", reason, text, &on_video());
    has_no_mistake(CheckKind::Landmarks, "Walk past the sofa into the bedroom.", &on_video());
}

#[test]
fn a_colour_passes_fails_or_is_open() {
    let mut path = to_the_bedroom();
    let text = "Walk past the green sofa into the bedroom.";
    let open = "the program cannot check whether \"sofa\" is green";
    finds(CheckKind::Landmarks, Verdict::Unverified, "sofa", open, text, &path);
    path.frames[1].things[0].colour = Some("red".into());
    let wrong = "no \"sofa\" along the path is green";
    finds(CheckKind::Landmarks, Verdict::Fail, "sofa", wrong, text, &path);
    path.frames[1].things[0].more_colours = vec!["green".into()];
    passes(text, &path);
    path.frames[1].things[0].more_colours.clear();
    path.frames[0].knows_things = false;
    finds(CheckKind::Landmarks, Verdict::Unverified, "sofa", wrong, text, &path);
    // The colour of another thing does not count.
    path.frames[1].things.push(SeenThing { name: "rug".into(), colour: Some("green".into()), ..SeenThing::default() });
    is_unverified(CheckKind::Landmarks, text, &path);
    // What is said of a thing may have it.
    path.frames[1].things[1].detail = Some("under a green sofa".into());
    passes(text, &path);
    // A thing that is not there has one mistake, and not two.
    let absent = findings_of(CheckKind::Landmarks, "Walk past the green piano.", &to_the_bedroom());
    assert_eq!(absent.len(), 1, "{absent:?}");
}

#[test]
fn a_door_is_shown_by_a_change_of_rooms() {
    let path = to_the_bedroom();
    for name in ["door", "doorway", "opening", "entrance", "exit", "threshold"] {
        assert_eq!(verdict(&format!("Walk through the {name} into the bedroom."), &path), Verdict::Pass, "{name}");
    }
    let one_room = walk(vec![frame("hallway", Some(&["rug"]), 1), frame("hallway", Some(&[]), 1)], &[(0.0, 0.0)]);
    assert_eq!(verdict("Walk through the door.", &one_room), Verdict::Unverified);
    assert_eq!(verdict("Walk past the sofa.", &one_room), Verdict::Fail);
    // The door is where the rooms change, and not before.
    fails(CheckKind::Order, "Walk through the door. Walk past the rug.", &path);
}

#[test]
fn stairs_are_shown_by_a_climb() {
    let frames = || vec![frame("kitchen", Some(&["rug"]), 0), frame("kitchen", Some(&["lamp"]), 0)];
    let up = walk(frames(), &[(0.0, 1.0)]);
    assert_eq!(verdict("Walk past the rug to the stairs. Walk past the lamp.", &up), Verdict::Pass);
    assert_ne!(verdict("Walk past the staircase.", &walk(frames(), &[(0.0, 0.0)])), Verdict::Pass);
}

#[test]
fn a_name_of_a_room_or_a_thing_fails_only_where_the_thing_is_denied() {
    // "Bar" may be a counter or a room.
    let path = to_the_bedroom();
    fails(CheckKind::Landmarks, "Walk past the bar into the bedroom.", &path);
    let mut unknown = path;
    unknown.frames[0].knows_things = false;
    is_unverified(CheckKind::Landmarks, "Walk past the bar into the bedroom.", &unknown);
}

#[test]
fn a_room_near_something_need_not_be_on_the_path() {
    let path = to_the_bedroom();
    fails(CheckKind::Landmarks, "Walk past the kitchen into the bedroom.", &path);
    is_unverified(CheckKind::Landmarks, "Stop at the bed next to the kitchen.", &path);
}

#[test]
fn the_names_of_the_evidence_may_be_synonyms_too() {
    for name in ["sofa", "couch", "settee"] {
        let mut path = to_the_bedroom();
        path.frames[1].things[0].name = name.into();
        for text in ["Walk past the sofa into the bedroom.", "Walk past the couch into the bedroom."] {
            passes(text, &path);
        }
        fails(CheckKind::Order, "Walk past the sofa. Walk past the rug.", &path);
    }
}
