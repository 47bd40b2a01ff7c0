//! Texts about one walk through an invented flat: each kind of claim where it holds, at another stretch, and left out.

use super::facts::WalkFacts;
use crate::{
    CheckSubject, EndSurroundings, Evidence, EvidenceSource, FrameEvidence, SeenThing, TextFindings, WalkMemory,
    align_with_walk, check_own_text, check_text,
};
use wayword_core::{
    CheckKind, DVec3, Heading, InstructionStyle, ObjectId, Path, PathMotion, SceneId, Side, StyleConstraints, Verdict,
    ViewpointId, path::PathStop,
};

/// The walk: up a hallway, right through a door into a bedroom, left at its far wall, and on to the window.
const STOPS: [[f64; 2]; 14] = [
    [0.0, 0.0],
    [0.0, 1.0],
    [0.0, 2.0],
    [0.0, 3.0],
    [0.0, 4.0],
    [0.0, 5.0],
    [1.0, 5.0],
    [2.0, 5.0],
    [3.0, 5.0],
    [4.0, 5.0],
    [5.0, 5.0],
    [5.0, 6.0],
    [5.0, 7.0],
    [5.0, 8.0],
];

/// The things of the flat, with their positions over the floor.
const THINGS: [(&str, [f64; 2]); 15] = [
    ("plant", [-1.0, 2.0]),
    ("bookshelf", [1.0, 3.0]),
    ("mirror", [-1.0, 4.0]),
    ("painting", [0.5, 5.8]),
    ("bed", [3.5, 6.2]),
    ("dresser", [6.0, 5.0]),
    ("rug", [5.0, 6.0]),
    ("lamp", [4.2, 7.0]),
    ("armchair", [6.0, 8.5]),
    ("window", [5.0, 9.0]),
    ("wardrobe", [2.0, 9.0]),
    ("door", [1.0, 2.0]),
    ("stove", [6.5, 7.5]),
    ("vase", [2.0, 4.3]),
    ("vase", [5.8, 8.3]),
];

/// The things of the flat that stand in a room into which the walk only looks.
const KITCHEN_THINGS: [&str; 1] = ["stove"];

/// How far a thing is seen, metres.
const SIGHT_M: f64 = 5.0;

fn flat_path() -> Path {
    let stop = |at: &[f64; 2]| PathStop { position: DVec3::new(at[0], at[1], 1.5), viewpoint: None, level: None };
    Path {
        id: "p".into(),
        scene: SceneId::new("s").unwrap(),
        frames: Path::frames_along(STOPS.iter().map(stop).collect(), None),
        motion: PathMotion::Known,
        target: None,
    }
}

fn flat_walk() -> (Evidence, WalkMemory) {
    flat_walk_with(&[])
}

/// The walk with further things.
fn flat_walk_with(more: &[(&str, [f64; 2])]) -> (Evidence, WalkMemory) {
    let path = flat_path();
    let frames = path.frames.iter().map(|frame| {
        let eye = frame.pose.position;
        let seen = THINGS.iter().chain(more).enumerate().map(|(number, (name, at))| {
            let position = DVec3::new(at[0], at[1], 1.0);
            SeenThing {
                name: (*name).to_owned(),
                object: Some(ObjectId::new(number.to_string()).unwrap()),
                position: Some(position),
                distance_m: Some((position - eye).length()),
                room: KITCHEN_THINGS.contains(name).then(|| "kitchen".to_owned()),
                turn_rad: Heading::towards(eye, position).map(|to| frame.pose.heading.turn_to(to)),
                ..SeenThing::default()
            }
        });
        FrameEvidence {
            rooms: vec![if eye.x < 1.5 { "hallway" } else { "bedroom" }.to_owned()],
            things: seen.filter(|thing| thing.distance_m.is_some_and(|far_m| far_m <= SIGHT_M)).collect(),
            knows_things: true,
            ..FrameEvidence::default()
        }
    });
    let evidence = Evidence {
        frames: frames.collect(),
        moves: path.moves(),
        motion: path.motion,
        source: EvidenceSource::Labels,
        has_witnesses: false,
        beyond: EndSurroundings::default(),
    };
    let memory = WalkMemory::from_path(&evidence, &path);
    (evidence, memory)
}

/// The walk as a witness describes it that names what it sees, but knows no distances: what is farther than 3 m is far.
fn described_walk() -> (Evidence, WalkMemory) {
    let (mut evidence, _) = flat_walk();
    evidence.source = EvidenceSource::Captions;
    for frame in &mut evidence.frames {
        frame.lists_things = true;
        for thing in &mut frame.things {
            let is_far = thing.distance_m.is_some_and(|far_m| far_m > 3.0);
            *thing = SeenThing { name: thing.name.clone(), turn_rad: thing.turn_rad, is_far, ..SeenThing::default() };
        }
    }
    let memory = WalkMemory::from_path(&evidence, &flat_path());
    (evidence, memory)
}

/// A mistake in a text: the check, the verdict, the words and the reason.
type FoundMistake = (CheckKind, Verdict, String, String);

/// The mistakes in a text about the walk.
fn mistakes(text: &str) -> Vec<FoundMistake> {
    mistakes_by(&flat_walk(), text, check_text)
}

fn mistakes_by(
    (evidence, memory): &(Evidence, WalkMemory),
    text: &str,
    check: fn(&str, CheckSubject<'_>) -> TextFindings,
) -> Vec<FoundMistake> {
    let style = InstructionStyle {
        constraints: StyleConstraints { ends_in_task: false, ..StyleConstraints::default() },
        ..InstructionStyle::default()
    };
    let checked = check(text, CheckSubject::closed_world(evidence, &style, None).with_memory(memory));
    let wrong = checked.findings.into_iter().filter(|finding| finding.verdict != Verdict::Pass);
    wrong
        .map(|finding| {
            let words = finding.span.map_or("", |[from, to]| &text[from..to]).to_owned();
            (finding.check, finding.verdict, words, finding.reason)
        })
        .collect()
}

fn holds(text: &str) {
    assert_eq!(mistakes(text), [], "{text}");
}

/// Checks that exactly these words of a text are wrong.
fn fails(text: &str, check: CheckKind, words: &str) {
    let found = mistakes(text);
    let wrong: Vec<_> = found.iter().map(|found| (found.0, found.1, found.2.as_str())).collect();
    assert_eq!(wrong, [(check, Verdict::Fail, words)], "{text}: {found:?}");
}

const WHOLE: &str = "Walk down the hallway past the bookshelf on your right. Turn right and enter the bedroom. Walk past the bed, \
                     turn left at the dresser and stop by the armchair.";

#[test]
fn a_text_that_says_the_walk_in_its_order_holds() {
    holds(WHOLE);
    holds(
        "Pass the plant and the mirror. Turn right into the bedroom. Turn left before the dresser. Stop at the window.",
    );
    holds(
        "Go past the plant on the left, take a right, go past the bed on your left and turn left. Walk over the rug and wait near the armchair.",
    );
    holds(
        "Walk toward the mirror. Turn right at the painting, walk to the dresser and go left. Stop in the bedroom by the window.",
    );
}

#[test]
fn a_turn_to_the_other_side_fails() {
    for (turn, flipped) in [("Turn right", "Turn left"), ("turn left", "turn right")] {
        let found = mistakes(&WHOLE.replace(turn, flipped));
        let words = flipped.split(' ').next_back().unwrap();
        let wrong = found.iter().filter(|found| found.0 == CheckKind::Turns && found.2 == words);
        assert_eq!(wrong.count(), 1, "{found:?}");
        assert!(found.iter().all(|found| (found.0, found.1) == (CheckKind::Turns, Verdict::Fail)), "{found:?}");
    }
}

#[test]
fn a_room_before_the_turn_into_it_fails() {
    fails(
        &WHOLE.replace("Turn right and enter the bedroom", "Enter the bedroom and turn right"),
        CheckKind::Order,
        "bedroom",
    );
}

#[test]
fn a_turn_told_a_part_too_early_or_too_late_fails() {
    let early = "Walk down the hallway. Turn right. Walk past the bookshelf and enter the bedroom. Turn left and stop by the armchair.";
    fails(early, CheckKind::Order, "bookshelf");
    let late = "Walk down the hallway. Turn right and enter the bedroom. Turn left. Walk past the bed and stop by the armchair.";
    fails(late, CheckKind::Order, "bed");
}

#[test]
fn a_turn_that_is_left_out_fails_at_the_step_that_goes_over_it() {
    let found =
        mistakes("Walk down the hallway and enter the bedroom. Walk past the bed, turn left and stop by the armchair.");
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].0, found[0].1), (CheckKind::Turns, Verdict::Fail));
    assert_eq!(found[0].3, "the path turns right in this stretch, and the text does not say so");
}

#[test]
fn two_parts_in_the_wrong_order_fail() {
    let swapped =
        "Walk past the mirror, then past the plant. Turn right into the bedroom, turn left and stop by the armchair.";
    let found = mistakes(swapped);
    // Either of them is in the wrong place.
    assert!(
        matches!(&found[..], [(CheckKind::Order, Verdict::Fail, words, _)] if words == "mirror" || words == "plant"),
        "{found:?}"
    );
    fails(
        "Walk past the bed. Walk down the hallway, turn right into the bedroom, turn left and stop by the armchair.",
        CheckKind::Order,
        "bed",
    );
}

#[test]
fn a_thing_on_the_other_side_fails() {
    fails(&WHOLE.replace("on your right", "on your left"), CheckKind::Landmarks, "bookshelf");
}

#[test]
fn an_end_that_is_far_fails_whatever_else_the_clause_says() {
    let wardrobe = |end: &str| WHOLE.replace("stop by the armchair", end);
    fails(&wardrobe("stop by the wardrobe"), CheckKind::Landmarks, "wardrobe");
    fails(&wardrobe("stop in the bedroom next to the wardrobe"), CheckKind::Landmarks, "wardrobe");
    fails(&wardrobe("stop by the plant"), CheckKind::Landmarks, "plant");
}

#[test]
fn relations_counts_lengths_and_ends_of_rooms_are_decided_or_unverified() {
    let end = |end: &str| WHOLE.replace("stop by the armchair", end);
    holds(&end("stop between the armchair and the lamp"));
    fails(&end("stop between the armchair and the plant"), CheckKind::Landmarks, "armchair");
    fails(&end("stop by the armchair next to the bed"), CheckKind::Landmarks, "bed");
    fails(&end("stop by the four armchairs"), CheckKind::Landmarks, "armchairs");
    fails(
        &WHOLE.replace("Walk down the hallway", "Walk twenty meters down the hallway"),
        CheckKind::Turns,
        "twenty meters",
    );
    let extent = mistakes(&WHOLE.replace("Walk down the hallway", "Walk to the end of the hallway"));
    assert!(extent.iter().all(|found| found.1 == Verdict::Unverified) && !extent.is_empty(), "{extent:?}");
}

#[test]
fn a_turn_told_as_slight_fails_where_the_walk_turns_fully() {
    fails(&WHOLE.replace("Turn right and enter", "Turn slightly right and enter"), CheckKind::Turns, "right");
}

#[test]
fn a_turn_past_a_thing_comes_after_the_thing() {
    let turn = |place: &str| WHOLE.replace("Turn right and", &format!("Turn right past the {place} and"));
    holds(&turn("mirror"));
    let early = mistakes(&turn("bed"));
    assert!(early.iter().any(|found| found.3 == "the path turns before it passes \"bed\""), "{early:?}");
}

#[test]
fn a_thing_in_another_room_is_no_place_to_stop_or_to_turn_at() {
    fails(&WHOLE.replace("stop by the armchair", "stop by the stove"), CheckKind::Landmarks, "stove");
    fails(&WHOLE.replace("past the bed, turn", "past the bed, go to the stove, turn"), CheckKind::Landmarks, "stove");
}

#[test]
fn a_turn_far_behind_the_last_thing_named_fails_where_a_door_comes_before_it() {
    let bare =
        "Turn right and enter the bedroom. Walk past the bed, turn left at the dresser and stop by the armchair.";
    fails(bare, CheckKind::Turns, "Turn right");
    holds(&bare.replace("Turn right and", "Walk straight. Turn right and"));
}

#[test]
fn a_door_is_the_one_of_its_number_on_its_side() {
    let walk = flat_walk_with(&[("door", [1.5, 5.0])]);
    let verdicts = |number: &str| {
        let text = format!(
            "Walk straight. Go through the {number} door on the right. Walk past the bed, turn left at the dresser and stop by the \
             armchair."
        );
        mistakes_by(&walk, &text, check_text).into_iter().map(|(_, verdict, ..)| verdict).collect::<Vec<_>>()
    };
    assert_eq!(verdicts("second"), []);
    assert!(verdicts("third").contains(&Verdict::Fail));
    assert!(verdicts("last").contains(&Verdict::Unverified));
}

#[test]
fn a_room_that_a_text_begins_from_is_left_in_the_next_step() {
    holds(&WHOLE.replace("Walk down the hallway past", "From the hallway, walk past"));
}

#[test]
fn two_things_with_words_behind_them_are_two() {
    let walk = flat_walk_with(&[("plant", [1.0, 2.0])]);
    let text = |behind: &str| {
        format!(
            "Walk past the plant in the red pot and past the plant{behind}. Turn right and enter the bedroom. Walk past the bed, turn left at the dresser and stop by the armchair."
        )
    };
    let repeats =
        |text: &str| mistakes_by(&walk, text, check_text).iter().any(|found| found.3.contains("a second time"));
    assert!(!repeats(&text(" in the blue pot")));
}

#[test]
fn a_door_stands_in_a_doorway() {
    let text = WHOLE.replace("Turn right and enter", "Turn right and go through the doorway into");
    let walk = flat_walk_with(&[("door", [1.5, 5.0])]);
    assert_eq!(mistakes_by(&walk, &text, check_text), []);
}

#[test]
fn a_walker_stops_beside_a_long_thing_whose_middle_is_behind() {
    let stop_by = |name: &str| {
        let walk = flat_walk_with(&[(name, [5.9, 6.6])]);
        mistakes_by(&walk, &WHOLE.replace("stop by the armchair", &format!("stop by the {name}")), check_text)
    };
    assert_eq!(stop_by("bathtub"), []);
    let found = stop_by("cabinet");
    assert!(found.iter().any(|found| found.3.contains("behind a walker")), "{found:?}");
}

#[test]
fn a_stop_that_names_nothing_fails_where_the_walk_goes_on() {
    fails(&WHOLE.replace(" and stop by the armchair", ". Stop"), CheckKind::Landmarks, "Stop");
    holds(&WHOLE.replace(" and stop by the armchair", ", walk past the rug and the lamp. Stop"));
}

#[test]
fn a_stop_at_one_of_several_alike_fails_where_the_walk_comes_to_another_first() {
    let stop = |place: &str| WHOLE.replace("stop by the armchair", &format!("stop by the {place}"));
    let found = mistakes(&stop("vase"));
    assert!(
        matches!(&found[..], [only] if only.3 == "the walk comes to another \"vase\" before this one"),
        "{found:?}"
    );
    holds(&stop("vase next to the armchair"));
    holds(&stop("vase on the right"));
    assert!(!mistakes(&stop("vase with a blue flower")).iter().any(|found| found.3.contains("comes to another")));
}

#[test]
fn parts_follow_one_another_from_the_first_to_the_last_frame() {
    let (evidence, memory) = flat_walk();
    let parts = align_with_walk(WHOLE, (&evidence, &memory)).unwrap();
    let frames: Vec<[usize; 2]> = parts.iter().map(|part| part.frames).collect();
    assert_eq!((frames[0][0], frames[frames.len() - 1][1]), (0, STOPS.len() - 1));
    assert!(frames.windows(2).all(|pair| pair[0][1] == pair[1][0]), "{frames:?}");
    assert!(parts.iter().all(|part| part.confidence.is_some_and(|share| (0.0..=1.0 + 1e-9).contains(&share))));
    let words: Vec<&str> = parts.iter().map(|part| &WHOLE[part.span[0]..part.span[1]]).collect();
    let turns: Vec<[usize; 2]> =
        words.iter().zip(&frames).filter(|(words, _)| words.contains("urn ")).map(|(_, frames)| *frames).collect();
    // The walk turns at the frames 5 and 10.
    assert!(turns[0][0] <= 5 && turns[0][1] > 5 && turns[1][0] <= 10 && turns[1][1] > 10, "{words:?} {frames:?}");
    let unknown = Evidence { source: EvidenceSource::Nothing, ..evidence };
    assert_eq!(align_with_walk(WHOLE, (&unknown, &memory)), None);
}

#[test]
fn a_text_said_twice_fails() {
    let twice = mistakes(&format!("{WHOLE} {WHOLE}"));
    assert!(twice.iter().any(|found| found.1 == Verdict::Fail), "{twice:?}");
    let sentence = mistakes(&WHOLE.replace(
        "Turn right and enter the bedroom.",
        "Turn right and enter the bedroom. Turn right and enter the bedroom.",
    ));
    assert!(sentence.iter().any(|found| found.1 == Verdict::Fail), "{sentence:?}");
}

#[test]
fn by_descriptions_motion_is_bound_to_the_walk_and_places_only_where_witnesses_can_tell() {
    let walk = described_walk();
    let own = |text: &str| mistakes_by(&walk, text, check_own_text);
    let end = |end: &str| WHOLE.replace("stop by the armchair", end);
    assert_eq!(own(WHOLE), []);
    for (text, check, words) in [
        (WHOLE.replace("Turn right and enter", "Enter"), CheckKind::Turns, ""),
        (WHOLE.replace("turn left at", "turn right at"), CheckKind::Turns, "right"),
        (WHOLE.replace("Walk down", "Walk twenty meters down"), CheckKind::Turns, "twenty meters"),
        (WHOLE.replace("on your right", "on your left"), CheckKind::Landmarks, "bookshelf"),
        (end("stop by the wardrobe"), CheckKind::Landmarks, "wardrobe"),
        (end("stop by the four armchairs"), CheckKind::Landmarks, "armchairs"),
        (end("stop by the armchair next to the bookshelf"), CheckKind::Landmarks, "bookshelf"),
        (end("stop between the armchair and the bookshelf"), CheckKind::Landmarks, "armchair"),
    ] {
        let found = own(&text);
        let is_it = |found: &FoundMistake| (found.0, found.1) == (check, Verdict::Fail) && found.2.contains(words);
        assert!(found.iter().any(is_it), "{text}: {found:?}");
    }
    let by_others = mistakes_by(&walk, &end("stop by the four armchairs"), check_text);
    assert!(by_others.iter().all(|found| found.1 == Verdict::Unverified) && !by_others.is_empty(), "{by_others:?}");
}

/// A staircase with a landing: four hops up, right and right again on the landing, and on up.
fn landing_walk() -> (Evidence, WalkMemory) {
    const CLIMB: [[f64; 3]; 11] = [
        [0.0, 0.0, 1.5],
        [0.0, 1.0, 1.5],
        [0.0, 2.0, 2.0],
        [0.0, 3.0, 2.5],
        [0.0, 3.6, 2.8],
        [0.6, 3.6, 2.8],
        [0.6, 3.0, 3.1],
        [0.6, 2.0, 3.6],
        [0.6, 1.0, 4.1],
        [0.6, 0.0, 4.1],
        [0.6, -1.0, 4.1],
    ];
    let stop = |at: &[f64; 3]| PathStop { position: DVec3::from(*at), viewpoint: None, level: None };
    let path = Path { frames: Path::frames_along(CLIMB.iter().map(stop).collect(), None), ..flat_path() };
    let known = FrameEvidence { rooms: vec!["staircase".to_owned()], knows_things: true, ..FrameEvidence::default() };
    let (evidence, _) = flat_walk();
    let evidence = Evidence { frames: vec![known; CLIMB.len()], moves: path.moves(), ..evidence };
    let memory = WalkMemory::from_path(&evidence, &path);
    (evidence, memory)
}

/// A turn on a landing lies within a flight, which other steps tell; where none does, it is left out.
#[test]
fn a_turn_on_a_landing_leaves_no_flight_out_that_another_step_tells() {
    let floors = |text: &str| {
        let found = mistakes_by(&landing_walk(), text, check_text);
        found.into_iter().filter(|(check, ..)| *check == CheckKind::Floors).count()
    };
    for told in [
        "Climb the stairs. Turn right on the landing, then turn right again and climb on. Stop at the top.",
        "Go up the stairs. Turn right and right again. Go straight and stop.",
    ] {
        assert_eq!(floors(told), 0, "{told}");
    }
    assert!(floors("Go straight. Turn right, then turn right again. Go straight and stop.") > 0);
}

#[test]
fn a_bend_that_straightens_the_way_at_once_needs_no_word() {
    let decisions = |stops: &[[f64; 2]]| -> Vec<Side> {
        let stop = |at: &[f64; 2]| PathStop { position: DVec3::new(at[0], at[1], 1.5), viewpoint: None, level: None };
        let path = Path { frames: Path::frames_along(stops.iter().map(stop).collect(), None), ..flat_path() };
        let evidence = Evidence::for_path_alone(&path);
        let memory = WalkMemory::from_path(&evidence, &path);
        let facts = WalkFacts::new(&evidence, &memory);
        memory.bends.iter().filter(|bend| facts.is_decision(bend)).map(|bend| bend.side()).collect()
    };
    let aslant = [[0.0, 0.0], [0.0, 1.0], [0.0, 2.0], [0.8, 2.6], [0.9, 3.6], [1.0, 4.6]];
    assert_eq!(decisions(&aslant), [Side::Right]);
    let later = [[0.0, 0.0], [0.0, 1.0], [0.0, 2.0], [0.8, 2.6], [1.6, 3.2], [2.4, 3.8], [3.2, 4.4], [3.3, 5.4]];
    assert_eq!(decisions(&later), [Side::Right, Side::Left]);
    let square = [[0.0, 0.0], [0.0, 1.0], [0.0, 2.0], [1.0, 2.0], [1.0, 3.0], [1.0, 4.0]];
    assert_eq!(decisions(&square), [Side::Right, Side::Left]);
}

#[test]
fn the_frames_of_a_recording_are_no_graph_where_they_lie_close_together() {
    let mut path = flat_path();
    for (at, frame) in path.frames.iter_mut().enumerate() {
        frame.viewpoint = Some(ViewpointId::new(at.to_string()).unwrap());
    }
    let (mut evidence, _) = flat_walk();
    assert!(WalkMemory::from_path(&evidence, &path).is_on_graph());
    evidence.source = EvidenceSource::Captions;
    assert!(!WalkMemory::from_path(&evidence, &path).is_on_graph());
    evidence.moves.iter_mut().for_each(|step| step.distance_m *= 2.0);
    assert!(WalkMemory::from_path(&evidence, &path).is_on_graph());
}
