//! A walk as a film shows it: what was seen at each place, and how the camera moved from one to the next, as far as that is known.

use serde::{Deserialize, Serialize};
use wayword_language::lexicon::{names_agree, room_name, same_room};

/// A walk, place by place.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FilmedWalk {
    /// The places, in order.
    pub places: Vec<FilmedPlace>,
    /// The ways between them: one fewer than places.
    pub hops: Vec<FilmedHop>,
}

/// What was seen at a place.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FilmedPlace {
    /// The names of things.
    pub things: Vec<String>,
    /// The names of things that a witness was not sure of.
    pub perhaps: Vec<String>,
    /// The rooms that the place may lie in; empty where that is not known.
    pub rooms: Vec<String>,
    /// The rooms that are seen through openings, or were guessed.
    pub perhaps_rooms: Vec<String>,
    /// Whether anybody looked. If not, an empty list of things says nothing.
    pub knows_things: bool,
    /// The frame of the film that the place belongs to. Where a film turns between two frames, several places belong to one.
    pub frame: usize,
}

/// The way from a place to the next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FilmedHop {
    /// The turn on it, radians, positive right; `None` where it is not known.
    pub turn_rad: Option<f64>,
    /// By how much it goes up, metres; `None` where that is not known.
    pub rise_m: Option<f64>,
    /// Its length, metres; `None` where that is not known.
    pub length_m: Option<f64>,
}

/// What the motion of a film is known from. Each has weights of its own, because a film whose turns are not known says less.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairMotion {
    /// Poses: turns, lengths and heights.
    Poses,
    /// The pictures: turns, as far as they can be told.
    Pictures,
    /// Nothing.
    Unknown,
}

/// How well something that a text names was seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum NameSight {
    /// Nobody saw it.
    Unseen,
    /// Somebody may have seen it.
    Perhaps,
    /// It was seen.
    Seen,
}

impl FilmedPlace {
    /// How well a thing of a name was seen here.
    pub(super) fn thing_sight(&self, name: &str) -> NameSight {
        let has = |names: &[String]| names.iter().any(|seen| names_agree(seen, name));
        match (has(&self.things), has(&self.perhaps)) {
            (true, _) => NameSight::Seen,
            (false, true) => NameSight::Perhaps,
            (false, false) => NameSight::Unseen,
        }
    }

    /// How likely the place lies in a room of a name.
    pub(super) fn room_sight(&self, name: &str) -> NameSight {
        let exact = |room: &String| room_name(room).is_some() && room_name(room) == room_name(name);
        let alike = |room: &String| same_room(room, name);
        if self.rooms.iter().any(exact) {
            NameSight::Seen
        } else if self.rooms.iter().chain(&self.perhaps_rooms).any(alike) {
            NameSight::Perhaps
        } else {
            NameSight::Unseen
        }
    }
}

impl FilmedWalk {
    /// What its motion is known from.
    #[must_use]
    pub fn motion(&self) -> PairMotion {
        if !self.hops.is_empty() && self.hops.iter().all(|hop| hop.length_m.is_some()) {
            PairMotion::Poses
        } else if self.hops.iter().any(|hop| hop.turn_rad.is_some()) {
            PairMotion::Pictures
        } else {
            PairMotion::Unknown
        }
    }

    /// For each place, its share of the way from the start: by lengths where all are known, else by the number of hops.
    pub(super) fn way_shares(&self) -> Vec<f64> {
        let known: Option<Vec<f64>> = self.hops.iter().map(|hop| hop.length_m).collect();
        // A turn on the spot takes time too, and a text spends words on it.
        const TURN_M: f64 = 0.5;
        let lengths = known.filter(|lengths| lengths.iter().sum::<f64>() > TURN_M);
        let lengths = lengths.unwrap_or_else(|| vec![1.0; self.hops.len()]);
        let whole: f64 = lengths.iter().map(|length| length + TURN_M).sum::<f64>().max(f64::MIN_POSITIVE);
        let mut way = 0.0;
        let mut shares = vec![0.0];
        shares.extend(lengths.iter().map(|length| {
            way += length + TURN_M;
            way / whole
        }));
        shares
    }

    /// The largest turn to each side, left and right, of up to three consecutive hops in a range of hops, radians; the last value says
    /// whether every turn of the range is known.
    pub(super) fn largest_turns(&self, from: usize, to: usize) -> ([f64; 2], bool) {
        let hops = self.hops.get(from.min(self.hops.len())..to.min(self.hops.len())).unwrap_or_default();
        let mut largest = [0.0_f64; 2];
        for first in 0..hops.len() {
            let mut bend = 0.0;
            for hop in hops.iter().skip(first).take(MAX_BEND_HOPS) {
                let Some(turn) = hop.turn_rad else { break };
                if bend * turn < 0.0 && turn.abs() > MAX_SWAY_RAD {
                    break;
                }
                bend += turn;
                largest[0] = largest[0].max(-bend);
                largest[1] = largest[1].max(bend);
            }
        }
        (largest, hops.iter().all(|hop| hop.turn_rad.is_some()))
    }

    /// The rise over a range of hops, metres; `None` where it is not known.
    pub(super) fn rise_m(&self, from: usize, to: usize) -> Option<f64> {
        self.hops.get(from..to.min(self.hops.len()))?.iter().map(|hop| hop.rise_m).sum()
    }
}

/// A bend of so many hops at most is one turn.
const MAX_BEND_HOPS: usize = 3;
/// A turn back by less than this does not end a bend, radians.
const MAX_SWAY_RAD: f64 = 0.17;
