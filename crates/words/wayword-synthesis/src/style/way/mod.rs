//! How the texts of a style describe a way: the shapes of their clauses, the joints between clauses, and the names of
//! rooms and things, each with its number of texts.
//!
//! A shape is a clause with slots for its names: "turn {s} at the {l}".

mod kind;
pub(super) mod shapes;
#[cfg(test)]
mod tests;

pub use kind::{ClauseKind, is_door_word};
pub use shapes::{ClauseJoint, ShapeTraits, is_until};

use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::LazyLock,
};
use wayword_language::{
    lexicon::{find_thing, normalise_name, room_name},
    reading::{EventContent, TextReading},
};

/// How the texts of a style describe a way.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct WayWording {
    /// The shapes of each kind of clause, with how often they occur.
    pub shapes: BTreeMap<ClauseKind, BTreeMap<String, f64>>,
    /// How often each kind of clause occurs, whatever its words.
    pub kinds: BTreeMap<ClauseKind, f64>,
    /// What joins a clause to the one before it.
    pub joints: BTreeMap<ClauseJoint, f64>,
    /// The same after a turn without any other detail.
    pub turn_joints: BTreeMap<ClauseJoint, f64>,
    /// The same before the clause to stop.
    pub stop_joints: BTreeMap<ClauseJoint, f64>,
    /// Share of the texts that say to stop, from 0 to 1.
    pub stop_share: f64,
    /// Of a language beside English: the shapes of clauses at the beginning of a text; `shapes` has those of the other clauses then.
    pub first_shapes: BTreeMap<ClauseKind, BTreeMap<String, f64>>,
    /// Share of the turns at the start that texts leave out, where they leave out more than R2R's texts do.
    pub untold_first_turns: f64,
    /// Share of the doorways that such texts name by their room.
    pub named_doorways: f64,
    /// The names of each room, by its usual name.
    pub rooms: BTreeMap<String, BTreeMap<String, f64>>,
    /// What people call the rooms of a scan, by the usual name of their label: also names of other rooms, which they do not keep apart from
    /// it, and "room" for no name.
    pub rooms_by_label: BTreeMap<String, BTreeMap<String, f64>>,
    /// The names of each thing, by its usual name.
    pub things: BTreeMap<String, BTreeMap<String, f64>>,
}

/// The content of `builtin/way.toml`: constructions with counts that were measured on R2R's training split.
#[derive(Default, Deserialize)]
struct BuiltIn {
    /// The words of which shapes may consist, with spaces between them.
    words: String,
    #[serde(flatten)]
    way: WayWording,
}

static BUILT_IN: LazyLock<BuiltIn> =
    LazyLock::new(|| toml::from_str(include_str!("../builtin/way.toml")).unwrap_or_default());

/// The words of which shapes may consist.
pub(super) static ALLOWED_SHAPE_WORDS: LazyLock<BTreeSet<&'static str>> =
    LazyLock::new(|| BUILT_IN.words.split_whitespace().collect());

/// A shape is used if at least this many texts have it.
pub(super) const MIN_SHAPE_TEXTS: f64 = 3.0;
/// With this many clauses of one kind, or the square of this number of all kinds, the measured counts are preferred to
/// the built-in ones.
pub(super) const ENOUGH_CLAUSES: f64 = 40.0;
/// A name belongs to a room or thing if at least this share of the mentions of the room or thing use it.
pub(super) const MIN_NAME_SHARE: f64 = 0.04;

impl WayWording {
    /// Measures texts with their readings. Where their clauses show too little, the built-in constructions fill in.
    #[must_use]
    pub fn from_texts<'a>(texts: impl IntoIterator<Item = (&'a str, &'a TextReading)>) -> Self {
        let mut way = Self::default();
        let (mut count, mut stops) = (0.0, 0.0);
        for (text, reading) in texts {
            way.add_text(text, reading);
            count += 1.0;
            stops += f64::from(u8::from(reading.events.iter().any(|event| event.what == EventContent::Stop)));
        }
        way.stop_share = if count < ENOUGH_CLAUSES { BUILT_IN.way.stop_share } else { stops / count };
        way.keep_common();
        way.fill_from_built_in();
        way
    }

    /// Counts the clauses, joints and names of one text.
    fn add_text(&mut self, text: &str, reading: &TextReading) {
        let mut seen = BTreeSet::new();
        let mut after_turn = false;
        for clause in shapes::shape_clauses(text, reading, &ALLOWED_SHAPE_WORDS) {
            let joints = match () {
                () if clause.stops => &mut self.stop_joints,
                () if after_turn => &mut self.turn_joints,
                () => &mut self.joints,
            };
            after_turn = clause.kind.is_some_and(ClauseKind::is_bare_turn);
            if !matches!(clause.joint, ClauseJoint::Start | ClauseJoint::Run) {
                *joints.entry(clause.joint).or_default() += 1.0;
            }
            if let Some(kind) = clause.kind {
                *self.kinds.entry(kind).or_default() += 1.0;
            }
            if let Some((kind, shape)) = clause.shape
                && seen.insert((kind, shape.clone()))
            {
                *self.shapes.entry(kind).or_default().entry(shape).or_default() += 1.0;
            }
        }
        for event in &reading.events {
            let EventContent::Place(place) = &event.what else { continue };
            let Some(said) = text.get(event.span[0]..event.span[1]).map(str::to_lowercase) else { continue };
            if place.several || said.contains(|c: char| !c.is_ascii_lowercase() && c != ' ') {
                continue;
            }
            if let Some(room) = room_name(&place.name).filter(|_| place.is_room) {
                *self.rooms.entry(room.to_owned()).or_default().entry(said).or_default() += 1.0;
            } else if let Some(thing) = find_thing(&place.name) {
                *self.things.entry(thing.name.to_owned()).or_default().entry(said).or_default() += 1.0;
            }
        }
    }

    /// Keeps the shapes that several texts have and that our reader understands as the same kind and shape; likewise
    /// the names.
    fn keep_common(&mut self) {
        for (kind, shapes) in &mut self.shapes {
            shapes.retain(|shape, texts| {
                *texts >= MIN_SHAPE_TEXTS && shapes::reads_the_same(*kind, shape, &ALLOWED_SHAPE_WORDS)
            });
        }
        self.shapes.retain(|_, shapes| !shapes.is_empty());
        for (usual, names) in self.rooms.iter_mut().chain(self.things.iter_mut()) {
            let total: f64 = names.values().sum();
            names.retain(|name, texts| {
                let is_plain = name == usual || !name.ends_with(&format!(" {usual}"));
                *texts >= MIN_SHAPE_TEXTS
                    && *texts >= total * MIN_NAME_SHARE
                    && is_plain
                    && normalise_name(name) == *name
            });
        }
        self.rooms.retain(|_, names| !names.is_empty());
        self.things.retain(|_, names| !names.is_empty());
    }

    /// Fills in the built-in constructions and names where these texts show too few.
    fn fill_from_built_in(&mut self) {
        let built_in = &BUILT_IN.way;
        if self.kinds.values().sum::<f64>() < ENOUGH_CLAUSES * ENOUGH_CLAUSES {
            self.kinds = built_in.kinds.clone();
        }
        for (kind, shapes) in &built_in.shapes {
            let measured = self.shapes.entry(*kind).or_default();
            if measured.values().sum::<f64>() < ENOUGH_CLAUSES {
                *measured = shapes.clone();
            }
            // An "until" clause is read together with the clause before it, so no measured clause shows it.
            let until = shapes.iter().filter(|(shape, _)| is_until(shape));
            measured.extend(until.map(|(shape, texts)| (shape.clone(), *texts)));
        }
        for (measured, built_in) in [
            (&mut self.joints, &built_in.joints),
            (&mut self.turn_joints, &built_in.turn_joints),
            (&mut self.stop_joints, &built_in.stop_joints),
        ] {
            if measured.values().sum::<f64>() < ENOUGH_CLAUSES {
                *measured = built_in.clone();
            }
        }
        // Texts alone do not tell how a room is labelled.
        self.rooms_by_label = built_in.rooms_by_label.clone();
        for (measured, built_in) in [(&mut self.rooms, &built_in.rooms), (&mut self.things, &built_in.things)] {
            let is_small = measured.values().flat_map(BTreeMap::values).sum::<f64>() < ENOUGH_CLAUSES * ENOUGH_CLAUSES;
            if is_small {
                *measured = built_in.clone();
            }
        }
    }

    /// The built-in constructions.
    #[must_use]
    pub fn built_in() -> &'static Self {
        &BUILT_IN.way
    }

    /// How often a kind of clause occurs.
    #[must_use]
    pub fn kind_count(&self, kind: ClauseKind) -> f64 {
        self.kinds.get(&kind).copied().unwrap_or_default()
    }

    /// How often texts have a kind of clause, as a share of how often R2R's texts have it; 1 where that is at least half, since a few texts
    /// show it only roughly.
    #[must_use]
    pub fn usual_share(&self, kind: ClauseKind) -> f64 {
        let share = |way: &Self| way.kind_count(kind) / way.kinds.values().sum::<f64>().max(1.0);
        let usual = share(&BUILT_IN.way);
        if usual > 0.0 && share(self) < usual / 2.0 { share(self) / usual } else { 1.0 }
    }

    /// Share of the plain orders to stop ("and stop") that is left out, so that as many texts as in the references say none.
    #[must_use]
    pub fn silent_stop_share(&self) -> f64 {
        let stops = |kind: &ClauseKind| {
            matches!(
                kind,
                ClauseKind::Stop
                    | ClauseKind::StopAt
                    | ClauseKind::StopAtIn
                    | ClauseKind::StopIn
                    | ClauseKind::StopInDoorway
                    | ClauseKind::StopInDoorwayOf
                    | ClauseKind::StopAtTop
                    | ClauseKind::StopAtBottom
            )
        };
        let all: f64 = self.kinds.iter().filter(|(kind, _)| stops(kind)).map(|(_, count)| count).sum();
        let plain = self.kind_count(ClauseKind::Stop) / all.max(1.0);
        ((1.0 - self.stop_share) / plain.max(f64::EPSILON)).clamp(0.0, 1.0)
    }

    /// How often things of that usual name are mentioned.
    #[must_use]
    pub fn thing_mentions(&self, usual: &str) -> f64 {
        self.things.get(usual).map_or(0.0, |names| names.values().sum())
    }
}
