//! Tests of reading turns, on wordings of people.

use crate::reading::{EventContent, read_instruction};
use std::collections::BTreeSet;
use wayword_core::Side;

fn turns(text: &str) -> Vec<Side> {
    let turn = |what: EventContent| if let EventContent::Turn(side) = what { Some(side) } else { None };
    read_instruction(text, &BTreeSet::new()).events.into_iter().filter_map(|event| turn(event.what)).collect()
}

#[test]
fn turns_are_found_in_many_wordings() {
    for text in [
        "Make a 90 degree left.",
        "Turn 90 degrees left.",
        "Turn to the immediate left.",
        "Go through the doorway and left.",
        "Exit and then left.",
        "Continue to the left.",
        "Continue left.",
        "Once past the table, go to your left.",
        "Turn about 90 degrees to your left.",
        "At the hallway, left.",
        "Hang left.",
        "Swing left.",
        "Round the corner to the left.",
        "Turn the corner to the left.",
        "Take the hallway left.",
        "Walk left.",
        "Pivot 90 degrees left.",
        "Turn sharply to the left.",
        "Rotate left.",
        "Your first left.",
        "Left turn.",
        "Take a left hand turn.",
        "Make the first available left.",
        "Turn your body left.",
        "Slight left.",
        "Then a left.",
        "Face left.",
        "Bend left.",
        "Veer off to the left.",
        "Take the second door on your left, turning left.",
        "Turn, heading left.",
        "Angle left.",
        "Keep left.",
        "Walk forward then left.",
        "Walk forward, left.",
        "Turn left hallway.",
        "Take the first left after the sofa.",
        "Turn left next to the sofa.",
        "Make your way left.",
        "Make your way to the left.",
        "Turn counterclockwise.",
        "Turn counter-clockwise 90 degrees.",
        "Rotate 90 degrees anticlockwise.",
        "Turn clockwise 270 degrees.",
        "Turn to your 9 o'clock.",
    ] {
        assert_eq!(turns(text), [Side::Left], "{text}");
    }
    assert_eq!(turns("Turn right through the door."), [Side::Right]);
    assert_eq!(turns("Go right into the kitchen, then left."), [Side::Right, Side::Left]);
}

#[test]
fn turns_around_are_found_in_many_wordings() {
    for text in [
        "Turn around.",
        "Turn all the way around.",
        "Turn completely around.",
        "Turn back around.",
        "Turn right around.",
        "Do a 180.",
        "Do a 180 degree turn.",
        "Make a u-turn.",
        "U-turn.",
        "Turn 180 degrees to the right.",
        "Rotate 180 degrees.",
        "Turn in the opposite direction.",
        "Turn and face the opposite direction.",
        "Spin around.",
        "About face.",
        "About-turn.",
        "Do an about face.",
        "Make a U-turn at the sofa.",
        "Do a one-eighty.",
        "Turn the other way.",
        "Reverse direction.",
        "Turn clockwise 180 degrees.",
        "Turn 180 degrees clockwise.",
    ] {
        assert_eq!(turns(text), [Side::Behind], "{text}");
    }
    for text in [
        "Walk clockwise around the table.",
        "Turn 360 degrees clockwise and stop.",
        "Take the door at 10 o'clock.",
        "Make your way to the left door.",
        "Go the other way.",
    ] {
        assert_eq!(turns(text), [], "{text}");
    }
    for text in ["Walk around the table.", "Turn around the corner.", "Turn back on the lamp."] {
        assert_eq!(turns(text), [], "{text}");
    }
}

#[test]
fn repeated_turns_are_counted() {
    use Side::{Left, Right};
    for (text, sides) in [
        ("Turn right twice.", &[Right, Right][..]),
        ("Turn left two times and stop.", &[Left, Left]),
        ("Take two left turns.", &[Left, Left]),
        ("Make two quick lefts, then a right.", &[Left, Left, Right]),
        ("Turn right, then right again.", &[Right, Right]),
        ("Take the first two lefts.", &[Left, Left]),
        ("Take the second left.", &[Left]),
        ("Turn left at the two doors.", &[Left]),
    ] {
        assert_eq!(turns(text), sides, "{text}");
    }
}

#[test]
fn a_side_of_a_place_is_no_turn() {
    for text in [
        "Walk through the door on the right.",
        "Use the right-hand door.",
        "Keep the table on your right.",
        "Go through the left door.",
        "Walk past the sofa to your left.",
        "Walk right up to the table.",
        "Go right through the doorway ahead.",
        "Leave the room you left before.",
        "Keep to the left of the table.",
        "Take the door on the left.",
        "Walk along the left wall.",
        "There is a table to the right.",
        "Stay left of the table.",
        "Walk straight, keeping the table on your left.",
        "Go straight past the hallway on the left and then right away stop.",
        "Head to the left side of the bed.",
        "Take the left doorway.",
        "Take left doorway.",
        "Walk to the far right end.",
        "Walk towards the bed, right past the table.",
        "Move to the right bed.",
        "Move to the right xylorimba.",
        "The bed should be on your left, stop.",
        "The doors are on your left and right.",
        "Enter the right bedroom.",
        "Face the right wall.",
        "Then right after the table stop.",
        "Exit the door to the left of the table.",
        "Proceed to the right of the bed.",
        "Continue right along the rug.",
        "Take two steps right in front of the rug.",
        "Take the staircase on the right.",
        "Move right the shower curtain.",
        "Go to the bathroom and move left a chair.",
    ] {
        assert_eq!(turns(text), [], "{text}");
    }
}

#[test]
fn a_long_text_takes_no_time_to_read() {
    let began = std::time::Instant::now();
    let text = "Pass the sofa on level 2 and turn left, ".repeat(5000);
    assert_eq!(turns(&text).len(), 5000);
    assert!(began.elapsed() < std::time::Duration::from_secs(20), "{:?}", began.elapsed());
}
