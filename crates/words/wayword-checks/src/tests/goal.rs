//! Tests of the end of a text: where it stops, and how near the last landmark is.

use crate::{
    Evidence, EvidenceSource, SeenThing,
    tests::{fails, findings_of, finds, frame, has_no_mistake, is_unverified, passes, to_the_bedroom, walk},
};
use wayword_core::{CheckKind, Verdict};

/// The path to the bedroom, with one thing at its end that is so far away.
fn with_thing_at(name: &str, distance_m: f64) -> Evidence {
    let mut path = to_the_bedroom();
    path.frames[2].things = vec![SeenThing { name: name.into(), distance_m: Some(distance_m), ..SeenThing::default() }];
    path
}

#[test]
fn a_stop_is_near_up_to_two_and_a_half_metres() {
    let text = "Walk into the bedroom and stop by the desk.";
    passes(text, &with_thing_at("desk", 2.5));
    let reason = "the nearest \"desk\" is 2.6 m from where the path ends";
    finds(CheckKind::Landmarks, Verdict::Fail, "desk", reason, text, &with_thing_at("desk", 2.6));
    // The nearest one counts, and one at an unknown distance may be near.
    let mut two = with_thing_at("desk", 7.0);
    two.frames[2].things.push(SeenThing { name: "desk".into(), distance_m: Some(1.0), ..SeenThing::default() });
    passes(text, &two);
    two.frames[2].things[1].distance_m = None;
    passes(text, &two);
    two.frames[2].things[1].name = "chair".into();
    fails(CheckKind::Landmarks, text, &two);
}

#[test]
fn a_wide_thing_is_near_however_far_its_centre_is() {
    for name in ["stairs", "rug", "doorway", "zorble"] {
        let path = with_thing_at(name, 6.0);
        has_no_mistake(CheckKind::Landmarks, &format!("Walk into the bedroom and stop by the {name}."), &path);
    }
    for name in ["sofa", "lamp", "window", "door"] {
        let path = with_thing_at(name, 6.0);
        fails(CheckKind::Landmarks, &format!("Walk into the bedroom and stop by the {name}."), &path);
    }
}

#[test]
fn a_thing_may_be_far_where_the_text_does_not_stop_at_it() {
    let far = with_thing_at("desk", 6.0);
    passes("Walk into the bedroom to the desk.", &far);
    passes("Walk to the desk in the bedroom.", &far);
    fails(CheckKind::Landmarks, "Walk into the bedroom. Stop at the desk.", &far);
}

#[test]
fn the_last_room_is_that_of_the_last_frame() {
    let path = to_the_bedroom();
    has_no_mistake(CheckKind::Landmarks, "Stop in the bedroom.", &path);
    let reason = "the path does not end in \"hallway\"";
    finds(CheckKind::Landmarks, Verdict::Fail, "hallway", reason, "Stop in the hallway.", &path);
    // The stop may name another room than the sentence before it.
    has_no_mistake(CheckKind::Landmarks, "Walk into the hallway. Wait in the bedroom.", &path);
    finds(CheckKind::Landmarks, Verdict::Fail, "hallway", reason, "Walk into the hallway. Wait there.", &path);
    // A room that is only next to the place of the stop need not be the last one.
    has_no_mistake(CheckKind::Landmarks, "Stop next to the hallway.", &path);
    // People confuse some rooms, as a hallway and an entryway.
    let entry = walk(vec![frame("bedroom", Some(&[]), 1), frame("entryway", Some(&[]), 1)], &[(0.0, 0.0)]);
    has_no_mistake(CheckKind::Landmarks, "Stop in the hallway.", &entry);
}

#[test]
fn the_last_room_is_open_where_it_is_unknown_or_guessed() {
    let reason = "the program cannot check whether the path ends in \"hallway\"";
    let text = "Stop in the hallway.";
    let mut unknown = to_the_bedroom();
    unknown.frames[2].rooms.clear();
    finds(CheckKind::Landmarks, Verdict::Unverified, "hallway", reason, text, &unknown);
    let mut guessed = to_the_bedroom();
    guessed.frames[2].perhaps.rooms.push("hallway".into());
    finds(CheckKind::Landmarks, Verdict::Unverified, "hallway", reason, text, &guessed);
    // A guess from another frame does not count for the end.
    let mut before = to_the_bedroom();
    before.frames[1].perhaps.rooms.push("hallway".into());
    fails(CheckKind::Landmarks, text, &before);
}

#[test]
fn captions_of_the_last_two_frames_count_for_the_end() {
    let mut captions = to_the_bedroom();
    captions.source = EvidenceSource::Captions;
    for frame in &mut captions.frames {
        frame.lists_things = true;
    }
    // The sofa is seen from the frame before the last one.
    passes("Walk down the hallway and stop at the sofa.", &captions);
    let reason = "\"rug\" is not seen from the end of the path";
    finds(CheckKind::Landmarks, Verdict::Fail, "rug", reason, "Stop at the rug.", &captions);
    is_unverified(CheckKind::Landmarks, "Stop in the hallway.", &captions);
    // A witness that only described the view may have left it out.
    captions.frames[2].lists_things = false;
    let open = "the program cannot check whether \"rug\" is at the end of the path";
    finds(CheckKind::Landmarks, Verdict::Unverified, "rug", open, "Stop at the rug.", &captions);
    // With labels, the last frame alone counts.
    fails(CheckKind::Landmarks, "Walk down the hallway and stop at the sofa.", &to_the_bedroom());
}

#[test]
fn a_thing_at_the_end_is_open_where_labels_may_lack_it() {
    let path = to_the_bedroom();
    let verdict = |text: &str, path: &Evidence| findings_of(CheckKind::Landmarks, text, path)[0].0;
    assert_eq!(verdict("Stop at the sofa.", &path), Verdict::Fail);
    let mut guessed = path.clone();
    guessed.frames[2].perhaps.things.push(SeenThing { name: "couch".into(), ..SeenThing::default() });
    assert_eq!(verdict("Stop at the sofa.", &guessed), Verdict::Unverified);
    let mut unknown = path.clone();
    unknown.frames[2].knows_things = false;
    assert_eq!(verdict("Stop at the sofa.", &unknown), Verdict::Unverified);
    // Doors, stairs, walls and words outside the lexicon are listed too rarely.
    let mut passed = path;
    for name in ["door", "stairs", "wall", "zorble"] {
        passed.frames[0].things.push(SeenThing { name: name.into(), ..SeenThing::default() });
    }
    // The last hop leads far beyond the door.
    passed.moves[1].distance_m = 4.0;
    for name in ["door", "zorble"] {
        assert_eq!(verdict(&format!("Stop at the {name}."), &passed), Verdict::Unverified, "{name}");
    }
}

#[test]
fn a_walk_ends_in_the_doorway_through_which_its_last_hop_leads() {
    let path = to_the_bedroom();
    for text in ["Stop in the doorway.", "Wait at the door.", "Turn right and stop in the doorway to the bedroom."] {
        has_no_mistake(CheckKind::Landmarks, text, &path);
    }
    let mut beyond = to_the_bedroom();
    beyond.moves[1].distance_m = 2.6;
    is_unverified(CheckKind::Landmarks, "Stop in the doorway.", &beyond);
    let mut open = to_the_bedroom();
    for (frame, room) in open.frames.iter_mut().zip(["kitchen", "kitchen", "dining room"]) {
        frame.rooms = vec![room.into()];
    }
    is_unverified(CheckKind::Landmarks, "Stop in the doorway.", &open);
}

#[test]
fn a_text_ends_at_its_last_goal_unless_it_goes_on() {
    let path = to_the_bedroom();
    for text in ["Go to the sofa.", "Walk to the hallway."] {
        fails(CheckKind::Landmarks, text, &path);
    }
    for text in [
        "Go to the sofa. Turn right.",
        "Walk to the hallway and turn right.",
        "Walk to the hallway. Walk past the lamp.",
        "Walk to the hallway. Walk straight ahead.",
    ] {
        has_no_mistake(CheckKind::Landmarks, text, &path);
    }
    // Where the text stops at a place, only a room counts as the place that it is sent to.
    has_no_mistake(CheckKind::Landmarks, "Walk to the sofa. Stop by the bed.", &path);
    fails(CheckKind::Landmarks, "Walk to the hallway and stop by the bed.", &path);
    // The last stop counts.
    has_no_mistake(CheckKind::Landmarks, "Stop at the sofa. Then go on and stop at the bed.", &path);
    let back = findings_of(CheckKind::Landmarks, "Walk on and stop at the bed. Then stop at the sofa.", &path);
    assert_eq!((back[0].0, back[0].1.as_str()), (Verdict::Fail, "sofa"));
}

#[test]
fn nothing_is_known_of_the_end_of_a_path_without_evidence() {
    let blank = walk(vec![frame("", None, 1), frame("", None, 1)], &[(0.0, 0.0)]);
    for text in ["Stop at the sofa.", "Stop in the hallway."] {
        is_unverified(CheckKind::Landmarks, text, &blank);
    }
    let basement = to_the_bedroom();
    is_unverified(CheckKind::Landmarks, "Stop in the basement.", &basement);
}
