//! Cuts a film into parts where the walk has a decision: a turn, stairs, another room, a halt; and where a part would become long.

use wayword_core::{CameraMotion, FilmTurn, FilmTurnRules, find_film_turns};

/// Why a part begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PartStart {
    /// The film begins.
    Beginning,
    /// The camera turns.
    Turn,
    /// Stairs begin or end.
    Stairs,
    /// The walk comes into another room.
    Room,
    /// The camera goes on after a halt.
    Halt,
    /// The part before is long enough.
    Length,
}

/// A part of a film.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FilmPart {
    /// Index of its first picture among those that the motion was told by.
    pub(super) from: usize,
    /// Index of the last one: the first of the next part, or the end.
    pub(super) to: usize,
    /// Why it begins.
    pub(super) start: PartStart,
    /// The sum of its turns of 30 degrees and more, radians, positive right; 0 where it has none.
    pub(super) turn_rad: f64,
    /// By how much it goes up, metres; 0 where that is not known.
    pub(super) rise_m: f64,
}

/// Parts that begin nearer to each other are one, seconds.
const MIN_PART_S: f64 = 1.0;
/// A part without a decision is cut after this time, seconds.
const MAX_PART_S: f64 = 20.0;
/// A halt lasts at least this long, seconds.
const MIN_HALT_S: f64 = 2.0;
/// A flight of stairs rises at least this much, metres.
const MIN_FLIGHT_M: f64 = 0.8;
/// The least slope (rise over run) of stairs.
const STAIRS_SLOPE: f64 = 0.2;

/// Cuts a film. `rooms` has the pictures, as indices among those that the motion was told by, at which another room begins.
pub(super) fn cut_film(film: &CameraMotion, rooms: &[usize]) -> Vec<FilmPart> {
    let last = film.pictures.len().saturating_sub(1);
    let turns = find_film_turns(&film.turns_rad(), FilmTurnRules::at_rate(film.pictures_per_s()));
    let mut starts: Vec<(usize, PartStart)> = vec![(0, PartStart::Beginning)];
    starts.extend(turns.iter().map(|turn| (turn.from_frame, PartStart::Turn)));
    starts.extend(flight_ends(film).into_iter().map(|at| (at, PartStart::Stairs)));
    starts.extend(rooms.iter().map(|at| (*at, PartStart::Room)));
    starts.extend(halt_ends(film).into_iter().map(|at| (at, PartStart::Halt)));
    let starts = spaced_starts(film, starts, last);
    let ends = starts.iter().skip(1).map(|(at, _)| *at).chain([last]);
    let parts = starts.iter().zip(ends).map(|((from, start), to)| FilmPart {
        from: *from,
        to,
        start: *start,
        turn_rad: turn_within(&turns, &starts, (*from, to)),
        rise_m: film.steps.get(*from..to).unwrap_or_default().iter().filter_map(|step| step.rise_m).sum(),
    });
    parts.collect()
}

/// The sum of the turns of a part: the one with which it begins, and those that lie mostly in it. `starts` are those of all parts.
fn turn_within(turns: &[FilmTurn], starts: &[(usize, PartStart)], (from, to): (usize, usize)) -> f64 {
    let begins_part = |turn: &FilmTurn| starts.iter().any(|(at, _)| *at == turn.from_frame);
    let place = |turn: &FilmTurn| match begins_part(turn) {
        true => turn.from_frame,
        false => turn.from_frame.midpoint(turn.to_frame),
    };
    let within = turns.iter().filter(|turn| (from..to).contains(&place(turn)));
    let signed = |turn: &FilmTurn| match turn.side {
        wayword_core::Side::Left => -turn.angle_rad,
        _ => turn.angle_rad,
    };
    within.map(signed).sum()
}

/// Where flights of stairs begin and end.
fn flight_ends(film: &CameraMotion) -> Vec<usize> {
    let climbs = |at: usize| {
        let step = film.steps.get(at)?;
        let (rise, run) = (step.rise_m?, step.length_m?);
        (rise.abs() > STAIRS_SLOPE * run && rise.abs() > 0.02).then_some(rise)
    };
    let mut ends = Vec::new();
    let mut at = 0;
    while at < film.steps.len() {
        let Some(first) = climbs(at) else {
            at += 1;
            continue;
        };
        let mut to = at;
        let mut rise = 0.0;
        // A landing of a few steps does not end a flight.
        let mut level = 0;
        while to < film.steps.len() && level < 4 {
            match climbs(to) {
                Some(step) if step * first > 0.0 => {
                    rise += step;
                    level = 0;
                }
                _ => level += 1,
            }
            to += 1;
        }
        if rise.abs() >= MIN_FLIGHT_M {
            ends.extend([at, to - level]);
        }
        at = to.max(at + 1);
    }
    ends
}

/// Where the camera goes on after a halt.
fn halt_ends(film: &CameraMotion) -> Vec<usize> {
    let mut ends = Vec::new();
    let mut since = None;
    for (at, step) in film.steps.iter().enumerate() {
        match (step.is_still, since) {
            (true, None) => since = Some(at),
            (false, Some(from)) => {
                if film.times_s[at] - film.times_s[from] >= MIN_HALT_S && from > 0 {
                    ends.push(at);
                }
                since = None;
            }
            _ => {}
        }
    }
    ends
}

/// The starts in order, far enough from each other and from the end, with more where a part would be too long. Of two starts that are too
/// near, that for the better reason stays.
fn spaced_starts(film: &CameraMotion, mut starts: Vec<(usize, PartStart)>, last: usize) -> Vec<(usize, PartStart)> {
    let time_s = |at: usize| film.times_s.get(at).copied().unwrap_or_default();
    starts.sort_by_key(|(at, start)| (*start, *at));
    let mut kept: Vec<(usize, PartStart)> = Vec::new();
    for (at, start) in starts {
        let is_apart =
            kept.iter().all(|(other, _)| (time_s(*other) - time_s(at)).abs() >= MIN_PART_S && other.abs_diff(at) > 1);
        let is_before_end = time_s(last) - time_s(at) >= MIN_PART_S / 2.0;
        if start == PartStart::Beginning || (is_apart && is_before_end) {
            kept.push((at, start));
        }
    }
    kept.sort_by_key(|(at, _)| *at);
    let mut spaced = Vec::new();
    for (number, (at, start)) in kept.iter().enumerate() {
        spaced.push((*at, *start));
        let end = kept.get(number + 1).map_or(last, |(next, _)| *next);
        let pieces = ((time_s(end) - time_s(*at)) / MAX_PART_S).ceil() as usize;
        for piece in 1..pieces {
            spaced.push((at + (end - at) * piece / pieces, PartStart::Length));
        }
    }
    spaced
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use wayword_core::{CameraStep, MotionSource};

    /// A film of one picture each quarter of a second. Each step is a turn in degrees, a length and a rise in metres.
    fn film(steps: &[[f64; 3]]) -> CameraMotion {
        let step = |[turn, length, rise]: &[f64; 3]| CameraStep {
            turn_rad: Some(turn.to_radians()),
            length_m: Some(*length),
            rise_m: Some(*rise),
            is_still: *turn == 0.0 && *length == 0.0 && *rise == 0.0,
        };
        CameraMotion {
            source: MotionSource::Poses,
            pictures: (0..=steps.len()).collect(),
            times_s: (0..=steps.len()).map(|at| at as f64 / 4.0).collect(),
            steps: steps.iter().map(step).collect(),
            frames: BTreeMap::new(),
        }
    }

    fn starts(film: &CameraMotion, rooms: &[usize]) -> Vec<(usize, PartStart)> {
        cut_film(film, rooms).iter().map(|part| (part.from, part.start)).collect()
    }

    const AHEAD: [f64; 3] = [0.0, 0.25, 0.0];

    #[test]
    fn a_part_begins_where_a_turn_begins() {
        let steps = [vec![AHEAD; 8], vec![[15.0, 0.0, 0.0]; 6], vec![AHEAD; 8]].concat();
        let film = film(&steps);
        assert_eq!(starts(&film, &[]), [(0, PartStart::Beginning), (8, PartStart::Turn)]);
        let parts = cut_film(&film, &[]);
        assert!((parts[1].turn_rad - 90_f64.to_radians()).abs() < 1e-6 && parts[0].turn_rad == 0.0, "{parts:?}");
        assert_eq!(parts[1].to, 22);
    }

    #[test]
    fn a_room_counts_unless_a_turn_is_near() {
        let steps = [vec![AHEAD; 12], vec![[-15.0, 0.0, 0.0]; 6], vec![AHEAD; 12]].concat();
        let film = film(&steps);
        let turn = (12, PartStart::Turn);
        assert_eq!(starts(&film, &[6]), [(0, PartStart::Beginning), (6, PartStart::Room), turn]);
        assert_eq!(starts(&film, &[11]), [(0, PartStart::Beginning), turn]);
    }

    #[test]
    fn stairs_and_halts_begin_parts() {
        let climb = [0.0, 0.2, 0.15];
        let still = [0.0, 0.0, 0.0];
        let steps = [vec![AHEAD; 8], vec![climb; 10], vec![AHEAD; 8], vec![still; 10], vec![AHEAD; 8]].concat();
        let film = film(&steps);
        let expected =
            [(0, PartStart::Beginning), (8, PartStart::Stairs), (18, PartStart::Stairs), (36, PartStart::Halt)];
        assert_eq!(starts(&film, &[]), expected);
        assert!((cut_film(&film, &[])[1].rise_m - 1.5).abs() < 1e-6);
    }

    #[test]
    fn a_long_way_without_a_decision_is_cut_evenly() {
        let film = film(&vec![AHEAD; 200]);
        let starts = starts(&film, &[]);
        assert_eq!(starts, [(0, PartStart::Beginning), (66, PartStart::Length), (133, PartStart::Length)]);
    }

    #[test]
    fn what_is_not_known_cuts_nothing() {
        let mut film = film(&[[15.0, 0.0, 0.0]; 12]);
        film.steps.iter_mut().for_each(|step| *step = CameraStep::default());
        assert_eq!(starts(&film, &[]).len(), 1);
        assert_eq!(cut_film(&film, &[])[0].turn_rad, 0.0);
    }
}
