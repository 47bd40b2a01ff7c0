//! Tests of the checks, on texts about invented paths.

mod findings;
mod goal;
mod landmarks;
mod order;
mod storeys;
mod tasks;

use super::{CheckSubject, check_own_text, check_text, count_objects_meant};
use crate::evidence::{Evidence, EvidenceSource, FrameEvidence, SeenThing};
use wayword_core::{CheckKind, InstructionStyle, PathMotion, PathMove, StyleConstraints, Verdict};

/// A frame in a room (empty where it is not known), with things (`None` where they are not known), on a storey (0 where
/// it is not known).
pub(crate) fn frame(room: &str, things: Option<&[&str]>, level: u32) -> FrameEvidence {
    let seen = |name: &&str| SeenThing { name: (*name).to_owned(), ..SeenThing::default() };
    FrameEvidence {
        rooms: Some(room).filter(|room| !room.is_empty()).map(str::to_owned).into_iter().collect(),
        things: things.unwrap_or_default().iter().map(seen).collect(),
        knows_things: things.is_some(),
        level: Some(level).filter(|level| *level > 0),
        ..FrameEvidence::default()
    }
}

/// The evidence of a path: frames, with a turn (degrees) and a rise (metres) before each but the first.
pub(crate) fn walk(frames: Vec<FrameEvidence>, moves: &[(f64, f64)]) -> Evidence {
    let step = |(deg, rise_m): &(f64, f64)| PathMove { turn_rad: deg.to_radians(), distance_m: 2.0, rise_m: *rise_m };
    let knows = frames.iter().any(|frame| !frame.rooms.is_empty() || frame.knows_things);
    let source = if knows { EvidenceSource::Labels } else { EvidenceSource::Nothing };
    Evidence {
        frames,
        moves: moves.iter().map(step).collect(),
        motion: PathMotion::Known,
        source,
        has_witnesses: false,
        beyond: crate::EndSurroundings::default(),
    }
}

/// Through the hallway past a sofa, and right into the bedroom with a lamp and a bed.
pub(crate) fn to_the_bedroom() -> Evidence {
    let frames = vec![
        frame("hallway", Some(&["rug"]), 1),
        frame("hallway", Some(&["sofa"]), 1),
        frame("bedroom", Some(&["lamp", "bed"]), 1),
    ];
    walk(frames, &[(0.0, 0.0), (90.0, 0.0)])
}

/// The smallest angle that is at least this many degrees after the conversion back, for thresholds in degrees.
pub(crate) fn exact_rad(deg: f64) -> f64 {
    let near = deg.abs().to_radians();
    let found = [near.next_down(), near, near.next_up()].into_iter().find(|rad| rad.to_degrees() >= deg.abs());
    found.map_or(deg.to_radians(), |rad| rad.copysign(deg))
}

/// The findings of one check: the verdict, the words and the reason of each.
pub(crate) fn findings_of(check: CheckKind, text: &str, evidence: &Evidence) -> Vec<(Verdict, String, String)> {
    let checked = check_text(text, CheckSubject::closed_world(evidence, &style(false), None));
    let of_check = checked.findings.into_iter().filter(|finding| finding.check == check);
    let words = |span: Option<[usize; 2]>| span.map_or("", |[from, to]| &text[from..to]).to_owned();
    of_check.map(|finding| (finding.verdict, words(finding.span), finding.reason)).collect()
}

/// A text without a mistake of this check has one finding, which passes.
#[track_caller]
pub(crate) fn has_no_mistake(check: CheckKind, text: &str, evidence: &Evidence) {
    assert_eq!(findings_of(check, text, evidence), [(Verdict::Pass, String::new(), String::new())], "{text}");
}

/// The only finding of a check has this verdict, these words and this reason.
#[track_caller]
pub(crate) fn finds(check: CheckKind, verdict: Verdict, words: &str, reason: &str, text: &str, evidence: &Evidence) {
    assert_eq!(findings_of(check, text, evidence), [(verdict, words.to_owned(), reason.to_owned())], "{text}");
}

pub(crate) fn style(ends_in_task: bool) -> InstructionStyle {
    let constraints = StyleConstraints { ends_in_task, ..StyleConstraints::default() };
    InstructionStyle { name: "any".into(), constraints, ..InstructionStyle::default() }
}

/// The verdict on a text, with the checks that it fails, or where it fails none, those that are unverified.
pub(crate) fn told(text: &str, evidence: &Evidence) -> (Verdict, Vec<CheckKind>) {
    told_in(text, evidence, &style(false))
}

pub(crate) fn told_in(text: &str, evidence: &Evidence, style: &InstructionStyle) -> (Verdict, Vec<CheckKind>) {
    let checked = check_text(text, CheckSubject::closed_world(evidence, style, None));
    let verdict = checked.verdict();
    let worst = checked.findings.iter().filter(|finding| finding.verdict == verdict && verdict != Verdict::Pass);
    let mut checks: Vec<CheckKind> = worst.map(|finding| finding.check).collect();
    checks.dedup();
    (verdict, checks)
}

#[track_caller]
pub(crate) fn passes(text: &str, evidence: &Evidence) {
    assert_eq!(told(text, evidence), (Verdict::Pass, vec![]), "{text}");
}

#[track_caller]
pub(crate) fn fails(check: CheckKind, text: &str, evidence: &Evidence) {
    assert_eq!(told(text, evidence), (Verdict::Fail, vec![check]), "{text}");
}

#[track_caller]
pub(crate) fn is_unverified(check: CheckKind, text: &str, evidence: &Evidence) {
    assert_eq!(told(text, evidence), (Verdict::Unverified, vec![check]), "{text}");
}

#[test]
fn the_object_of_an_unrequested_task_is_a_landmark() {
    let path = to_the_bedroom();
    passes("Walk to the bedroom and clean the lamp.", &path);
    fails(CheckKind::Landmarks, "Walk to the bedroom and clean the piano.", &path);
    fails(CheckKind::Order, "Walk to the bedroom and clean the sofa.", &path);
    // Where a task is asked for, only the check of the task speaks about its object.
    let task = told_in("Walk to the bedroom and clean the piano", &path, &style(true));
    assert_eq!(task, (Verdict::Fail, vec![CheckKind::Task]));
}

#[test]
fn a_place_may_be_at_a_frame_with_unknown_objects() {
    let known = to_the_bedroom();
    fails(CheckKind::Landmarks, "Walk past the piano into the bedroom.", &known);
    fails(CheckKind::Landmarks, "Walk through the kitchen into the bedroom.", &known);
    let mut unknown = known.clone();
    unknown.frames[1] = frame("", None, 1);
    is_unverified(CheckKind::Landmarks, "Walk past the piano into the bedroom.", &unknown);
    is_unverified(CheckKind::Landmarks, "Walk through the kitchen into the bedroom.", &unknown);
    // The final viewpoint is known, and that is all that its task needs.
    let task = |text: &str| told_in(text, &unknown, &style(true));
    assert_eq!(task("Go to the bedroom and clean the piano"), (Verdict::Fail, vec![CheckKind::Task]));
    // A viewpoint with an empty list of objects shows none.
    let mut bare = known;
    bare.frames[1] = frame("hallway", Some(&[]), 1);
    fails(CheckKind::Landmarks, "Walk past the piano into the bedroom.", &bare);
}

#[test]
fn an_order_that_the_unknown_may_save_is_not_denied() {
    let text = "Walk past the lamp and pass the rug, then stop.";
    fails(CheckKind::Order, text, &to_the_bedroom());
    let mut path = to_the_bedroom();
    path.frames.push(frame("", None, 1));
    path.moves.push(path.moves[0]);
    is_unverified(CheckKind::Order, text, &path);
}

#[test]
fn a_room_that_the_walker_is_in_has_to_be_on_the_path() {
    let path = to_the_bedroom();
    for text in [
        "Walk down the hallway and stop in the kitchen.",
        "Walk down the hallway. Stop inside the kitchen.",
        "Come from the kitchen and walk down the hallway.",
        "Walk down the hallway and wait at the kitchen.",
    ] {
        fails(CheckKind::Landmarks, text, &path);
    }
    for text in [
        "Walk to the bedroom next to the kitchen.",
        "Walk to the bedroom off the kitchen.",
        "Walk to the bedroom across from the kitchen.",
        "Walk to the bedroom near the kitchen.",
    ] {
        is_unverified(CheckKind::Landmarks, text, &path);
    }
}

#[test]
fn a_place_that_only_locates_a_goal_is_free_in_the_order() {
    let frames = vec![
        frame("bedroom", Some(&["bed"]), 1),
        frame("living room", Some(&["sofa"]), 1),
        frame("hallway", Some(&[]), 1),
        frame("bathroom", Some(&["sink"]), 1),
    ];
    let path = walk(frames, &[(0.0, 0.0); 3]);
    for text in [
        "Go to the bathroom near the living room and bedroom and clean the sink.",
        "Go to the bathroom past the living room.",
        "Go to the bathroom down the hallway.",
        "Go to the bathroom through the bedroom and living room.",
        "Go to the bathroom facing the bedroom.",
    ] {
        passes(text, &path);
    }
    fails(CheckKind::Order, "Walk past the sofa through the bedroom into the bathroom.", &path);
    fails(CheckKind::Order, "Go to the bathroom and walk past the sofa.", &path);
}

/// A level path on one storey.
pub(crate) fn flat(level: u32) -> Evidence {
    let frames = vec![frame("hallway", Some(&[]), level), frame("bathroom", Some(&["sink"]), level)];
    walk(frames, &[(0.0, 0.0)])
}

/// A path from one storey to the next by stairs.
pub(crate) fn by_stairs(from: u32, to: u32) -> Evidence {
    let rise_m = if to > from { 3.0 } else { -3.0 };
    let frames = vec![frame("hallway", Some(&[]), from), frame("bathroom", Some(&["sink"]), to)];
    walk(frames, &[(0.0, rise_m)])
}

#[test]
fn a_command_to_climb_needs_a_climb() {
    for text in ["Go upstairs and stop in the bathroom.", "Walk up one floor and stop in the bathroom."] {
        passes(text, &by_stairs(1, 2));
        fails(CheckKind::Floors, text, &flat(2));
    }
    fails(CheckKind::Floors, "Go downstairs. Wait in the bathroom.", &flat(1));
    let low = walk(flat(1).frames, &[(0.0, 0.3)]);
    passes("Walk up two steps and stop in the bathroom.", &low);
    fails(CheckKind::Floors, "Walk up the stairs and stop in the bathroom.", &low);
    fails(CheckKind::Floors, "Walk up two steps and stop in the bathroom.", &flat(1));
    // A text may say "upstairs" of a place when the walker is upstairs already.
    passes("Go to the bathroom upstairs.", &flat(2));
    passes("Go to the bathroom downstairs.", &flat(1));
    fails(CheckKind::Floors, "Go to the bathroom upstairs.", &flat(1));
    is_unverified(CheckKind::Floors, "Go to the bathroom upstairs.", &flat(0));
}

#[test]
fn floors_are_passed_in_their_order_up_to_the_last() {
    for (text, from, to) in [
        ("Walk from the second floor to the first floor.", 2, 1),
        ("Walk to the first floor from the second floor.", 2, 1),
        ("Start on the second floor and walk to the bathroom on the first floor.", 2, 1),
        ("Walk to the bathroom on the second floor.", 1, 2),
        ("Walk along the first floor hallway. Go up the stairs and stop.", 1, 2),
    ] {
        passes(text, &by_stairs(from, to));
    }
    fails(CheckKind::Floors, "Walk from the second floor to the first floor.", &by_stairs(1, 2));
    fails(
        CheckKind::Floors,
        "Start on the second floor and walk to the bathroom on the first floor.",
        &by_stairs(1, 2),
    );
    fails(CheckKind::Floors, "Walk to the bathroom on the first floor.", &by_stairs(1, 2));
    for text in ["Go to the bathroom on the 7th floor.", "Go to the bathroom on floor 12."] {
        fails(CheckKind::Floors, text, &flat(1));
        is_unverified(CheckKind::Floors, text, &flat(0));
    }
}

#[test]
fn how_many_floors_there_are_is_not_known() {
    is_unverified(CheckKind::Floors, "Go to the bathroom on the top floor.", &by_stairs(1, 2));
    fails(CheckKind::Floors, "Go to the bathroom on the top floor.", &by_stairs(2, 1));
    is_unverified(CheckKind::Landmarks, "Go to the basement.", &flat(1));
    fails(CheckKind::Landmarks, "Go to the basement.", &flat(2));
    is_unverified(CheckKind::Landmarks, "Go to the basement bathroom.", &flat(1));
}

#[test]
fn denied_actions_are_not_checked() {
    passes("Do not turn left. Walk past the sofa, don't enter the kitchen and stop in the bedroom.", &to_the_bedroom());
}

#[test]
fn a_path_of_one_place_decides_nothing() {
    let standing = walk(vec![frame("kitchen", Some(&["sink"]), 1)], &[]);
    let turned = walk(vec![frame("kitchen", Some(&["sink"]), 1); 2], &[]);
    let picture = Evidence { frames: vec![frame("kitchen", Some(&["sink"]), 0)], ..on_video() };
    for path in [&standing, &turned, &picture] {
        for text in
            ["Walk straight ahead and stop at the sink.", "Turn left at the piano. Go upstairs.", "Stop at the sink."]
        {
            let (verdict, wrong) = told_in(text, path, &style(false));
            assert_eq!(verdict, Verdict::Unverified, "{text} {wrong:?}");
            assert!(wrong.contains(&CheckKind::Landmarks) && wrong.contains(&CheckKind::Turns), "{text} {wrong:?}");
        }
        let task = |text: &str| told_in(text, path, &style(true)).1.contains(&CheckKind::Task);
        assert!(task("Go to the kitchen and wash the piano"));
    }
    // What a text lacks is seen without a path.
    let (verdict, _) = told_in("Stop at the sink.", &standing, &style(true));
    assert_eq!(verdict, Verdict::Fail);
}

/// The path to the bedroom as a video shows it: without poses.
pub(crate) fn on_video() -> Evidence {
    let mut path = to_the_bedroom();
    path.frames.iter_mut().for_each(|frame| frame.level = None);
    Evidence { moves: Vec::new(), motion: PathMotion::Unknown, ..path }
}

#[test]
fn turns_floors_and_sides_of_an_unknown_motion_are_unverified() {
    for text in [
        "Walk past the sofa and turn right into the bedroom.",
        "Walk past the sofa and turn left into the bedroom.",
        "Turn around and walk to the bedroom.",
    ] {
        is_unverified(CheckKind::Turns, text, &on_video());
    }
    for text in [
        "Go up the stairwell into the bedroom.",
        "Walk up two steps and stop in the bedroom.",
        "Go to the bedroom upstairs.",
        "Go to the bedroom on the second floor.",
    ] {
        is_unverified(CheckKind::Floors, text, &on_video());
    }
    let mut sided = on_video();
    sided.frames[1].things[0].turn_rad = Some(-0.3);
    for side in ["left", "right"] {
        is_unverified(CheckKind::Landmarks, &format!("Walk past the sofa on your {side} into the bedroom."), &sided);
    }
    let task = told_in("Go to the bedroom and clean the lamp on your left", &on_video(), &style(true));
    assert_eq!(task, (Verdict::Unverified, vec![CheckKind::Task]));
}

#[test]
fn places_of_an_unknown_motion_are_checked_in_their_order() {
    passes("Walk straight past the sofa into the bedroom and stop at the bed.", &on_video());
    fails(CheckKind::Landmarks, "Walk past the piano into the bedroom.", &on_video());
    fails(CheckKind::Order, "Walk past the lamp and pass the rug, then stop.", &on_video());
    fails(CheckKind::Order, "Turn left at the lamp and pass the rug, then stop.", &on_video());
}

#[test]
fn check_own_text_fails_statements_about_an_unknown_motion() {
    let own = |text: &str, evidence: &Evidence| {
        let checked = check_own_text(text, CheckSubject::closed_world(evidence, &style(false), None));
        let failed = checked.findings.into_iter().filter(|finding| finding.verdict == Verdict::Fail);
        failed
            .map(|finding| (finding.check, finding.span.map(|[from, to]| text[from..to].to_owned())))
            .collect::<Vec<_>>()
    };
    let video = on_video();
    for (text, check, words) in [
        ("Walk past the sofa and turn right into the bedroom.", CheckKind::Turns, "right"),
        ("Walk past the sofa, do not turn left, and stop at the bed.", CheckKind::Turns, "left"),
        ("Walk straight past the sofa into the bedroom.", CheckKind::Turns, "straight"),
        ("Walk past the sofa, go 3 metres and stop at the bed.", CheckKind::Turns, "3 metres"),
        ("Walk past the sofa, go 3m and stop at the bed.", CheckKind::Turns, "3m"),
        ("Walk past the sofa and a few steps on to the bed.", CheckKind::Turns, "few steps"),
        ("Walk past the sofa and go upstairs to the bed.", CheckKind::Floors, "upstairs"),
        ("Walk past the sofa to the bedroom on the second floor.", CheckKind::Floors, "second floor"),
        ("Walk past the sofa on your left into the bedroom.", CheckKind::Landmarks, "sofa"),
    ] {
        let told = own(text, &video);
        assert!(
            told.iter().any(|(by, span)| *by == check && span.as_ref().is_some_and(|span| span.contains(words))),
            "{text}: {told:?}"
        );
        assert!(own(text, &to_the_bedroom()).iter().all(|(by, _)| *by != CheckKind::Landmarks), "{text}");
    }
    for text in [
        "Walk past the sofa into the bedroom and stop at the foot of the bed.",
        "Walk past the sofa. Stop once you see the lamp.",
        "Leave the hallway and turn on the lamp.",
    ] {
        assert_eq!(own(text, &video), [], "{text}");
    }
    // Each check has one outcome: the finding before about the same words is gone.
    let checked = check_own_text("Turn left to the bed.", CheckSubject::closed_world(&video, &style(false), None));
    let turns = checked.findings.iter().filter(|finding| finding.check == CheckKind::Turns);
    assert_eq!(turns.map(|finding| finding.verdict).collect::<Vec<_>>(), [Verdict::Fail]);
}

#[test]
fn count_objects_meant_counts_one_object_that_the_text_identifies() {
    let mut evidence = to_the_bedroom();
    let lamp = |colour: &str, turn_rad: f64| SeenThing {
        name: "lamp".into(),
        colour: Some(colour.into()),
        turn_rad: Some(turn_rad),
        ..SeenThing::default()
    };
    evidence.frames[2].things.extend([lamp("green", -1.0), lamp("white", 1.0)]);
    evidence.frames[2].things.retain(|thing| thing.name != "lamp" || thing.turn_rad.is_some());
    for (text, objects) in [
        ("Go to the bedroom and dust the lamp", 2),
        ("Go to the bedroom and dust the green lamp", 1),
        ("Go to the bedroom and dust the lamp on your right", 1),
        ("Go to the bedroom and dust the lamp next to the bed", 1),
        ("Go to the bedroom and dust the purple lamp", 1),
        ("Go to the bedroom and dust the piano", 0),
        ("Go to the bedroom", 0),
    ] {
        assert_eq!(count_objects_meant(text, &evidence), objects, "{text}");
    }
}

#[test]
fn a_text_stops_at_a_thing_that_is_near_the_end() {
    let mut path = to_the_bedroom();
    let at = |path: &mut Evidence, lamp_m: f64| path.frames[2].things[0].distance_m = Some(lamp_m);
    at(&mut path, 1.8);
    passes("Walk into the bedroom and stop by the lamp.", &path);
    at(&mut path, 3.4);
    fails(CheckKind::Landmarks, "Walk into the bedroom and stop by the lamp.", &path);
    passes("Walk into the bedroom, past the lamp.", &path);
    // A thing that is seen on the way, but not where the path ends.
    fails(CheckKind::Landmarks, "Walk down the hallway and stop at the sofa.", &path);
}

#[test]
fn the_room_that_is_the_goal_is_that_of_the_last_frame() {
    let path = to_the_bedroom();
    passes("Walk past the sofa and stop in the bedroom.", &path);
    passes("Walk down the hallway. Turn right and stop by the bed.", &path);
    fails(CheckKind::Landmarks, "Walk past the sofa and stop in the hallway.", &path);
    fails(CheckKind::Landmarks, "Go to the hallway and stop by the lamp.", &path);
}

#[test]
fn a_colour_before_a_thing_is_read_and_checked() {
    let mut path = to_the_bedroom();
    let dresser =
        |colour: &str| SeenThing { name: "dresser".into(), colour: Some(colour.into()), ..SeenThing::default() };
    path.frames[2].things.push(dresser("wooden"));
    for text in [
        "Walk past the sofa into the bedroom and stop at the wooden dresser.",
        "Walk past the sofa into the bedroom and stop at the brown dresser.",
        "Walk past the sofa into the bedroom and stop at the oak dresser.",
    ] {
        passes(text, &path);
    }
    fails(CheckKind::Landmarks, "Walk past the sofa into the bedroom and stop at the white dresser.", &path);
    path.frames[2].things.push(dresser("white"));
    passes("Walk past the sofa into the bedroom and stop at the white dresser.", &path);
    fails(CheckKind::Landmarks, "Walk past the sofa into the bedroom and stop at the green dresser.", &path);
}
