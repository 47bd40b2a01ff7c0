//! Tests of reading climbs and storeys, on wordings of people.

use super::*;
use crate::reading::read_instruction;
use std::collections::BTreeSet;

fn told(text: &str) -> Vec<EventContent> {
    let events = read_instruction(text, &BTreeSet::new()).events.into_iter().map(|event| event.what);
    events
        .filter(|what| {
            matches!(
                what,
                EventContent::Climb(_) | EventContent::Steps(_) | EventContent::Storey(_) | EventContent::Floor(_)
            )
        })
        .collect()
}

#[test]
fn commands_to_climb_differ_from_places_up_there() {
    for text in [
        "Go upstairs.",
        "Walk back upstairs to the bedroom.",
        "Exit the bedroom and upstairs.",
        "Walk up the stairs.",
        "Turn left up the stairs.",
        "Walk past the sofa up the stairs.",
        "Take the stairs up.",
        "Take the elevator up.",
        "Ride the elevator up and stop.",
        "Climb the old wooden stairs.",
        "Go up one floor.",
        "Go up the first flight of stairs.",
        "Turn around and go all the way up the stairs.",
        "Go up.",
        "Go up and turn left.",
        "Keep going up until the sofa.",
        "Ascend.",
        "Ascend to the bedroom and wait.",
    ] {
        assert_eq!(told(text), [EventContent::Climb(ClimbDirection::Up)], "{text}");
    }
    for text in [
        "Go to the bathroom upstairs.",
        "Clean the upstairs bathroom.",
        "Go to the bathroom up the stairs.",
        "Take the stairs to the upper floor.",
        "Go to the floor above.",
        "Take the elevator to the level above and wait.",
    ] {
        assert_eq!(told(text), [EventContent::Storey(ClimbDirection::Up)], "{text}");
    }
    for text in ["Go down.", "Descend and turn left.", "Head back down.", "Descend the ramp."] {
        assert_eq!(told(text), [EventContent::Climb(ClimbDirection::Down)], "{text}");
    }
    for text in ["Walk down two steps.", "Go down the few steps to the sofa."] {
        assert_eq!(told(text), [EventContent::Steps(ClimbDirection::Down)], "{text}");
    }
    for text in [
        "Stop at the top of the stairs leading down to another floor.",
        "Wait by the stairs going up another flight.",
        "Go down the hall passing the stairs.",
        "Walk down the hallway to the stairs.",
        "Walk up to the stairs.",
        "Stop at the top of the stairs.",
        "Go up to the table.",
        "Walk down the hall.",
        "Sit down.",
        "Clean up.",
        "Pick the towel up and go to the sofa.",
        "Go down to the end of the hall.",
        "Climb into the tub.",
        "Walk past the stairs that go down.",
        "Stop at the foot of the stairs ascending to the attic.",
        "Walk down the tiled floor past the sofa.",
        "Walk down the wood floor hallway.",
        "Take a few steps down the hallway.",
        "Start on the upper floor.",
        "Walk past the stairs that lead to the upper floor.",
        "Stop at the stairs to the lower floor.",
        "Look at the floor below the window.",
        "Walk to the floor below the window.",
        "Go to the upper floor bedroom.",
        "Walk past the elevator up to the sofa.",
    ] {
        assert_eq!(told(text), [], "{text}");
    }
}

#[test]
fn floors_have_numbers_and_are_left_or_mentioned_aside() {
    let floor = |text: &str| match told(text).pop() {
        Some(EventContent::Floor(floor)) => (floor.number, floor.leaves),
        other => panic!("{text}: {other:?}"),
    };
    assert_eq!(floor("Go to the bedroom on the 7th floor"), (Some(7), false));
    assert_eq!(floor("Go to the bedroom on floor 12"), (Some(12), false));
    assert_eq!(floor("Go to the twelfth floor"), (Some(12), false));
    assert_eq!(floor("Go to the bedroom on the top floor"), (None, false));
    assert_eq!(floor("Walk down from the second floor"), (Some(2), true));
    assert_eq!(floor("Start on the second floor"), (Some(2), true));
    assert_eq!(told("Clean the rug on the floor"), []);
    let aside = told("Wait by the stairs going up to the second level.");
    assert_eq!(aside, [EventContent::Floor(StoreyMention { number: Some(2), leaves: false, aside: true })]);
}
