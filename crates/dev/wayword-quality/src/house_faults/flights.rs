//! The fault of a flight that is left out, on a path that climbs.

use super::{claims::names_stairs, subject::FaultSubject};

/// A path climbs if its ends are this far above each other, metres.
const CLIMB_M: f64 = 1.5;
/// At least this many pieces remain.
const MIN_PIECES_LEFT: usize = 2;
/// Where stairs end, as a part of a piece that has a command of its own.
const STAIRS_ENDS: [&str; 4] = [
    "at the bottom of the stairs",
    "at the top of the stairs",
    "at the bottom of the steps",
    "at the top of the steps",
];

/// The text without a word about the stairs that the walk takes.
pub(super) fn leave_out_flights(subject: &FaultSubject<'_>) -> Vec<String> {
    let names_any = subject.pieces.iter().any(|piece| piece.claims.has_stairs);
    if !names_any || subject.walk.rise_m().abs() < CLIMB_M {
        return Vec::new();
    }
    let mut text = subject.text.clone();
    // From the end, so that the numbers of the pieces before stay the same.
    for (at, piece) in subject.text.pieces.iter().enumerate().rev().filter(|(_, piece)| names_stairs(piece)) {
        let left = match without_stairs(piece) {
            Some(rest) => text.with_piece(at, rest),
            None => text.without(at),
        };
        let Some(left) = left else { return Vec::new() };
        text = left;
    }
    let is_free = text.pieces.len() >= MIN_PIECES_LEFT && !text.pieces.iter().any(|piece| names_stairs(piece));
    is_free.then(|| text.render()).into_iter().collect()
}

/// The rest of a piece that names the end of the stairs only as a place: "at the top of the stairs turn left".
fn without_stairs(piece: &str) -> Option<String> {
    STAIRS_ENDS.iter().find_map(|end| {
        let rest = piece.strip_prefix(end).or_else(|| piece.strip_suffix(end))?.trim();
        (!rest.is_empty() && !names_stairs(rest)).then(|| rest.to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            plan::HousePlan,
            test_plan::{hallway_house, hallway_subject, hallway_walk},
        },
        *,
    };

    /// What remains of a text about the walk through the hallway, as if that ended this much higher, metres.
    fn left(text: &str, rise_m: f64) -> Vec<String> {
        let plan = HousePlan::new(hallway_house());
        let mut frames = hallway_walk();
        frames.last_mut().unwrap().pose.position.z += rise_m;
        leave_out_flights(&FaultSubject::new(&plan, &frames, text).unwrap())
    }

    #[test]
    fn leave_out_flights_needs_a_climb() {
        let text = "Turn left and go up the stairs. At the top of the stairs turn left. Stop.";
        assert_eq!(left(text, 2.0), ["Turn left. Turn left. Stop."]);
        assert!(left(text, 1.0).is_empty());
        let plan = HousePlan::new(hallway_house());
        assert!(leave_out_flights(&hallway_subject(&plan, "Turn left. Stop.")).is_empty());
    }

    #[test]
    fn leave_out_flights_takes_the_stairs_out_of_a_stop() {
        assert_eq!(left("Go downstairs, stop at the bottom of the stairs. Wait.", -2.0), ["Stop. Wait."]);
        assert!(left("Walk up the stairs. Stop.", 2.0).is_empty(), "only the stop would remain");
    }
}
