//! Paths that are walked the other way round.

use super::{Outcome, Written};
use std::collections::BTreeSet;
use wayword_core::{Climb, Side};
use wayword_language::{
    lexicon::room_name,
    reading::{What, read},
};

/// Back along the path one turns as often, to the other sides in reverse order; rooms and floors that both texts tell once come
/// in reverse order; and up is down.
#[must_use]
pub fn reverse(base: Written<'_>, changed: Written<'_>) -> Outcome {
    let (there, back) = (Told::of(base.text), Told::of(changed.text));
    if there == Told::default() && back == Told::default() {
        return Outcome::NotTold;
    }
    let whole = format!("\"{}\" there, \"{}\" back", base.text, changed.text);
    let turns: Vec<Side> = there.turns.iter().rev().map(|side| side_back(*side)).collect();
    if turns != back.turns {
        return Outcome::Differs(format!("there one turns {:?}, and back {:?}: {whole}", there.turns, back.turns));
    }
    let climbs: Vec<Climb> = there.climbs.iter().rev().map(|climb| climb_back(*climb)).collect();
    if climbs != back.climbs {
        return Outcome::Differs(format!("there one climbs {:?}, and back {:?}: {whole}", there.climbs, back.climbs));
    }
    let (rooms, floors) = (both(&there.rooms, &back.rooms), both(&there.floors, &back.floors));
    for [there, back] in [rooms, floors] {
        if !there.iter().eq(back.iter().rev()) {
            return Outcome::Differs(format!("there one gets by {there:?}, and back by {back:?}: {whole}"));
        }
    }
    Outcome::Holds
}

/// What a text tells of a way.
#[derive(Debug, Default, PartialEq, Eq)]
struct Told {
    turns: Vec<Side>,
    climbs: Vec<Climb>,
    rooms: Vec<String>,
    floors: Vec<String>,
}

impl Told {
    fn of(text: &str) -> Self {
        let mut told = Self::default();
        for event in read(text, &BTreeSet::new()).events.into_iter().filter(|event| !event.denied) {
            match event.what {
                What::Turn(side) => told.turns.push(side),
                What::Climb(climb) => told.climbs.push(climb),
                What::Floor(floor) => told.floors.extend(floor.number.map(|number| number.to_string())),
                What::Place(place) if place.is_room => {
                    let name = room_name(&place.name).unwrap_or(&place.name).to_owned();
                    // The stairs are told as a climb.
                    if name != "stairs" && told.rooms.last() != Some(&name) {
                        told.rooms.push(name);
                    }
                }
                _ => {}
            }
        }
        told
    }
}

/// What both lists hold just once, as either has it.
fn both(there: &[String], back: &[String]) -> [Vec<String>; 2] {
    let once = |list: &[String], name: &String| list.iter().filter(|other| *other == name).count() == 1;
    let shared = |list: &[String]| {
        list.iter().filter(|name| once(there, name) && once(back, name)).cloned().collect::<Vec<String>>()
    };
    [shared(there), shared(back)]
}

fn side_back(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
        other => other,
    }
}

fn climb_back(climb: Climb) -> Climb {
    match climb {
        Climb::Up => Climb::Down,
        Climb::Down => Climb::Up,
        Climb::Level => Climb::Level,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(there: &str, back: &str) -> Outcome {
        let of = |text| Written { text, mentions: &[] };
        reverse(of(there), of(back))
    }

    const THERE: &str =
        "Leave the bedroom and turn left. Walk up the stairs, turn right in the hallway and stop in the kitchen.";

    #[test]
    fn the_way_back_has_the_turns_the_rooms_and_the_climbs_in_reverse_order() {
        let back =
            "Leave the kitchen. Turn left in the hallway, go down the stairs, turn right and stop in the bedroom.";
        assert_eq!(judged(THERE, back), Outcome::Holds);
        assert_eq!(judged("Stop by the lamp.", "Stop by the bed."), Outcome::NotTold);
    }

    #[test]
    fn it_is_said_what_differs_on_the_way_back() {
        let differs = [
            ("Leave the kitchen, go down the stairs, turn right and stop in the bedroom.", "turns"),
            ("Leave the kitchen. Turn left, go up the stairs, turn right and stop in the bedroom.", "climbs"),
            ("Leave the bedroom. Turn left, go down the stairs, turn right and stop in the kitchen.", "gets by"),
        ];
        for (back, why) in differs {
            assert!(matches!(judged(THERE, back), Outcome::Differs(said) if said.contains(why)), "{back}");
        }
    }
}
