//! The check for a path that is walked in the opposite direction.

use super::{AnnotatedText, ExpectationOutcome};
use crate::facts::implied_turn;
use std::collections::BTreeSet;
use wayword_core::{ClimbDirection, Side, TextMention};
use wayword_language::{
    lexicon::room_name,
    reading::{EventContent, read_instruction},
};

/// Checks that on the way back the turns go to the other sides in reverse order, except that the side of a door may be told in one
/// direction alone, where several doors are ahead; that climbs are reversed too, and that rooms and
/// floors that each text names once come in reverse order.
#[must_use]
pub fn check_reversed_path(base: AnnotatedText<'_>, changed: AnnotatedText<'_>) -> ExpectationOutcome {
    let (there, back) = (WayDescription::from_text(base), WayDescription::from_text(changed));
    if there == WayDescription::default() && back == WayDescription::default() {
        return ExpectationOutcome::NotTold;
    }
    let whole = format!("\"{}\" there, \"{}\" back", base.text, changed.text);
    let turns: Vec<WayTurn> = there.turns.iter().rev().map(WayTurn::on_the_way_back).collect();
    if !are_same_turns(&turns, &back.turns) {
        return ExpectationOutcome::Differs(format!(
            "there one turns {:?}, and back {:?}: {whole}",
            sides_of(&there.turns),
            sides_of(&back.turns)
        ));
    }
    let climbs: Vec<ClimbDirection> = there.climbs.iter().rev().map(|climb| climb_back(*climb)).collect();
    if climbs != back.climbs {
        return ExpectationOutcome::Differs(format!(
            "there one climbs {:?}, and back {:?}: {whole}",
            there.climbs, back.climbs
        ));
    }
    let rooms = rooms_of_both(&there.rooms, &back.rooms, base.last_frame);
    let is_order_known = |one: &String, other: &String| {
        let is_apart = |rooms: &[WayRoom]| are_rooms_apart(rooms, one, other).unwrap_or(true);
        is_apart(&there.rooms) && is_apart(&back.rooms)
    };
    for [there, back] in [rooms, names_in_both(&there.floors, &back.floors)] {
        let place = |name: &String| back.iter().position(|other| other == name);
        let mut pairs =
            there.iter().enumerate().flat_map(|(at, one)| there[at + 1..].iter().map(move |other| (one, other)));
        if pairs.any(|(one, other)| place(one) < place(other) && is_order_known(one, other)) {
            return ExpectationOutcome::Differs(format!("there one gets by {there:?}, and back by {back:?}: {whole}"));
        }
    }
    ExpectationOutcome::Holds
}

/// The turns, climbs, rooms and floors that a text describes, in its order.
#[derive(Debug, Default, PartialEq, Eq)]
struct WayDescription {
    turns: Vec<WayTurn>,
    climbs: Vec<ClimbDirection>,
    rooms: Vec<WayRoom>,
    floors: Vec<String>,
}

/// A turn that a text tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct WayTurn {
    side: Side,
    /// Whether it is the side of a door or room.
    by_door: bool,
}

impl WayTurn {
    fn on_the_way_back(&self) -> Self {
        Self { side: side_back(self.side), ..*self }
    }
}

fn sides_of(turns: &[WayTurn]) -> Vec<Side> {
    turns.iter().map(|turn| turn.side).collect()
}

/// Whether two texts tell the same turns in the same order, without some that are sides of doors.
fn are_same_turns(one: &[WayTurn], other: &[WayTurn]) -> bool {
    let skips = |turns: &[WayTurn]| turns.first().is_some_and(|turn| turn.by_door);
    match (one.split_first(), other.split_first()) {
        (None, None) => true,
        (Some((a, rest)), Some((b, others))) if a.side == b.side && are_same_turns(rest, others) => true,
        _ => skips(one) && are_same_turns(&one[1..], other) || skips(other) && are_same_turns(one, &other[1..]),
    }
}

/// A room that a text names, and the frame of its mention.
#[derive(Debug, Clone, PartialEq, Eq)]
struct WayRoom {
    name: String,
    /// `None` if no mention of the checks covers the words.
    frame: Option<usize>,
}

impl WayDescription {
    fn from_text(written: AnnotatedText<'_>) -> Self {
        let (mut way, mut has_stopped) = (Self::default(), false);
        for event in read_instruction(written.text, &BTreeSet::new()).events.into_iter().filter(|event| !event.denied) {
            let by_door = matches!(event.what, EventContent::Place(_));
            way.turns.extend(implied_turn(&event.what).map(|side| WayTurn { side, by_door }));
            match event.what {
                EventContent::Stop => has_stopped = true,
                EventContent::Climb(climb) => way.climbs.push(climb),
                EventContent::Floor(floor) => way.floors.extend(floor.number.map(|number| number.to_string())),
                EventContent::Place(place) if place.is_room => {
                    let name = room_name(&place.name).unwrap_or(&place.name).to_owned();
                    // Stairs are already counted as a climb.
                    if name != "stairs" && way.rooms.last().is_none_or(|room| room.name != name) {
                        let overlaps_event =
                            |mention: &&TextMention| mention.span[0] < event.span[1] && event.span[0] < mention.span[1];
                        let mention_here = written.mentions.iter().find(overlaps_event);
                        let frame = if has_stopped {
                            Some(written.last_frame)
                        } else {
                            mention_here.map(|mention| mention.frame)
                        };
                        way.rooms.push(WayRoom { name, frame });
                    }
                }
                _ => {}
            }
        }
        way
    }
}

/// The rooms that each text names exactly once, in the order of either text. If another room lies between the two mentions of a
/// name, these are two different rooms, and the name is left out.
fn rooms_of_both(there: &[WayRoom], back: &[WayRoom], last_frame: usize) -> [Vec<String>; 2] {
    let names = |rooms: &[WayRoom]| rooms.iter().map(|room| room.name.clone()).collect::<Vec<String>>();
    let frame_from_start = |room: &WayRoom| Some((room.name.clone(), last_frame.saturating_sub(room.frame?)));
    let back_frames: Vec<(String, usize)> = back.iter().filter_map(frame_from_start).collect();
    let frames: Vec<(String, usize)> = there.iter().filter_map(|room| Some((room.name.clone(), room.frame?))).collect();
    let is_same_room = |name: &String| {
        let frame = |rooms: &[(String, usize)]| rooms.iter().find(|(other, _)| other == name).map(|(_, frame)| *frame);
        let Some((one, other)) = frame(&frames).zip(frame(&back_frames)) else { return true };
        let between = one.min(other)..=one.max(other);
        let passes = |(other, frame): &(String, usize)| other != name && between.contains(frame);
        one.abs_diff(other) <= 1 || !frames.iter().chain(&back_frames).any(passes)
    };
    names_in_both(&names(there), &names(back)).map(|names| names.into_iter().filter(is_same_room).collect())
}

/// Whether a text mentions two rooms at frames that are not neighbours, if the frames are known. At neighbouring frames the order is
/// open, because a walker in a doorway may be in either room.
fn are_rooms_apart(rooms: &[WayRoom], one: &str, other: &str) -> Option<bool> {
    let frame = |name: &str| rooms.iter().find(|room| room.name == name)?.frame;
    Some(frame(one)?.abs_diff(frame(other)?) > 1)
}

/// The names that occur exactly once in each list, in the order of either list.
fn names_in_both(there: &[String], back: &[String]) -> [Vec<String>; 2] {
    let once = |list: &[String], name: &String| list.iter().filter(|other| *other == name).count() == 1;
    let shared = |list: &[String]| {
        list.iter().filter(|name| once(there, name) && once(back, name)).cloned().collect::<Vec<String>>()
    };
    [shared(there), shared(back)]
}

/// The side of a turn on the way back.
fn side_back(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
        other => other,
    }
}

/// The climb on the way back.
fn climb_back(climb: ClimbDirection) -> ClimbDirection {
    match climb {
        ClimbDirection::Up => ClimbDirection::Down,
        ClimbDirection::Down => ClimbDirection::Up,
        ClimbDirection::Level => ClimbDirection::Level,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::MentionKind;

    fn judged(there: &str, back: &str) -> ExpectationOutcome {
        let of = |text| AnnotatedText { text, mentions: &[], last_frame: 0 };
        check_reversed_path(of(there), of(back))
    }

    const THERE: &str =
        "Leave the bedroom and turn left. Walk up the stairs, turn right in the hallway and stop in the kitchen.";

    #[test]
    fn the_way_back_has_the_turns_the_rooms_and_the_climbs_in_reverse_order() {
        let back =
            "Leave the kitchen. Turn left in the hallway, go down the stairs, turn right and stop in the bedroom.";
        assert_eq!(judged(THERE, back), ExpectationOutcome::Holds);
        assert_eq!(judged("Stop by the lamp.", "Stop by the bed."), ExpectationOutcome::NotTold);
        let by_doors = "Leave the kitchen. Take the door on the left in the hallway, go down the stairs, turn right and stop \
                        in the bedroom.";
        assert_eq!(judged(THERE, by_doors), ExpectationOutcome::Holds);
        let one_door_more = "Leave the kitchen through the door on the right. Turn left in the hallway, go down the stairs, turn right \
                             and stop in the bedroom.";
        assert_eq!(judged(THERE, one_door_more), ExpectationOutcome::Holds);
    }

    #[test]
    fn two_rooms_of_one_name_are_not_taken_for_one() {
        let (there, back) =
            ("Go down the hallway and stop in the bedroom.", "Go down the hallway and stop in the bedroom.");
        let rooms = |hallway, bedroom| {
            let room = |name: &str, frame| {
                let from = there.find(name).unwrap();
                TextMention { span: [from, from + name.len()], kind: MentionKind::Room, frame }
            };
            vec![room("hallway", hallway), room("bedroom", bedroom)]
        };
        let judged = |mentions: Vec<TextMention>| {
            let base = rooms(3, 8);
            let of = |text, mentions| AnnotatedText { text, mentions, last_frame: 9 };
            check_reversed_path(of(there, base.as_slice()), of(back, &mentions))
        };
        // Back into the bedroom of the start, at the frame 0 of the way there, by the hallway; and by one that ends there.
        assert_eq!(judged(rooms(4, 9)), ExpectationOutcome::Holds);
        assert_eq!(judged(rooms(8, 9)), ExpectationOutcome::Holds);
    }

    #[test]
    fn check_reversed_path_names_what_differs_on_the_way_back() {
        let differs = [
            ("Leave the kitchen, go down the stairs, turn right and stop in the bedroom.", "turns"),
            ("Leave the kitchen. Turn left, go up the stairs, turn right and stop in the bedroom.", "climbs"),
            ("Leave the bedroom. Turn left, go down the stairs, turn right and stop in the kitchen.", "gets by"),
        ];
        for (back, why) in differs {
            assert!(matches!(judged(THERE, back), ExpectationOutcome::Differs(said) if said.contains(why)), "{back}");
        }
    }
}
