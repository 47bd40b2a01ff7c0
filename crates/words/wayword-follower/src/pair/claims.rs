//! The claims of a text that a film can support or contradict, and how well each fits a stretch of a walk.

use super::film::{FilmedPlace, FilmedWalk, NameSight};
use crate::alignment::PartedText;
use wayword_core::{ClimbDirection, Side};
use wayword_language::{
    lexicon::{ThingClass, find_thing},
    reading::steps::StepRelation,
};

/// A claim of a text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FilmClaim {
    /// Its byte range in the text.
    pub(super) span: [usize; 2],
    /// The number of its part.
    pub(super) part: usize,
    pub(super) kind: FilmClaimKind,
}

/// What a claim is about.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum FilmClaimKind {
    /// A turn to the left or to the right.
    Turn {
        /// Whether it is to the right.
        right: bool,
    },
    /// A turn around.
    Around,
    /// Stairs.
    Climb(ClimbDirection),
    /// A thing or a room, by its possible meanings.
    Place {
        /// The meanings: whether it is a room, and its name.
        meanings: Vec<(bool, String)>,
        /// Whether the walk comes out of it.
        leaves: bool,
        /// Whether an eye that lists what it sees would name it. Parts of the building are often left out.
        would_be_named: bool,
    },
}

/// How a claim fits a stretch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilmClaimFit {
    /// The stretch shows it.
    Fits,
    /// The stretch may show it: a slight bend for a turn, a thing that a witness was not sure of.
    Perhaps,
    /// The walk shows it, but elsewhere.
    Elsewhere,
    /// The walk shows it nowhere.
    Nowhere,
    /// The stretch shows the opposite: the other side, the other direction.
    Opposite,
    /// Nothing that is known decides it.
    Unknown,
}

impl FilmClaimFit {
    /// The natural logarithm of how much likelier a true claim fits in this way than a false one, roughly. It only serves to find the
    /// stretches; the weights of the score are fitted.
    pub(super) fn loose_weight(self) -> f64 {
        match self {
            Self::Fits => 1.2,
            Self::Perhaps => 0.4,
            Self::Elsewhere => -0.9,
            Self::Nowhere => -1.2,
            Self::Opposite => -2.5,
            Self::Unknown => 0.0,
        }
    }
}

/// A turn of at least this counts as one, radians (30 degrees).
pub(super) const TURN_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// A bend of at least this may be meant by a turn, radians (15 degrees).
const SLIGHT_RAD: f64 = std::f64::consts::FRAC_PI_6 / 2.0;
/// A turn of at least this is one around, radians (120 degrees).
const AROUND_RAD: f64 = 2.0 * std::f64::consts::FRAC_PI_3;
/// The rise of a few steps, metres.
const STEPS_M: f64 = 0.4;
/// So many places around a stretch belong to it: people and programs differ by one place in where a part begins.
const SLACK_PLACES: usize = 1;

/// The claims of a text.
pub(super) fn claims_of_text(text: &PartedText) -> Vec<FilmClaim> {
    let mut claims = Vec::new();
    for (part, described) in text.parts.iter().enumerate() {
        for step in &text.guide.steps[described.steps.clone()] {
            let mut add = |kind, span| claims.push(FilmClaim { span, part, kind });
            let span = step.step.turn_span.unwrap_or(step.step.span);
            match step.step.turn {
                Some(side @ (Side::Left | Side::Right)) => {
                    add(FilmClaimKind::Turn { right: side == Side::Right }, span);
                }
                Some(_) => add(FilmClaimKind::Around, span),
                None => {}
            }
            if let Some(climb) = step.step.climb {
                add(FilmClaimKind::Climb(climb), step.step.span);
            }
            for mention in &step.mentions {
                let Some(span) = mention.span else { continue };
                let meanings: Vec<(bool, String)> =
                    mention.meanings.iter().map(|meaning| (meaning.is_room, meaning.name.clone())).collect();
                let would_be_named = meanings.iter().any(|(is_room, name)| *is_room || is_often_named(name));
                let leaves = mention.relation == StepRelation::OutOf;
                add(FilmClaimKind::Place { meanings, leaves, would_be_named }, span);
            }
        }
    }
    claims
}

/// Whether an eye that lists what it sees names such a thing: no wall, floor or corner, and no door or stairs.
fn is_often_named(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| {
        !matches!(thing.class, ThingClass::Fabric | ThingClass::Floor | ThingClass::Door | ThingClass::Stairs)
    })
}

impl FilmClaim {
    /// How well the thing or room that it names was seen at each place; empty for other claims.
    pub(super) fn sights(&self, walk: &FilmedWalk) -> Vec<NameSight> {
        let FilmClaimKind::Place { meanings, .. } = &self.kind else { return Vec::new() };
        let sight = |place: &FilmedPlace| {
            let each = meanings.iter().map(|(is_room, name)| match is_room {
                true => place.room_sight(name),
                false => place.thing_sight(name),
            });
            each.max().unwrap_or(NameSight::Unseen)
        };
        walk.places.iter().map(sight).collect()
    }

    /// How the claim fits the stretch between two places. `sights` are its own along the walk.
    pub(super) fn fit(&self, walk: &FilmedWalk, sights: &[NameSight], stretch: [usize; 2]) -> FilmClaimFit {
        match self.kind {
            FilmClaimKind::Turn { right } => turn_fit(walk, stretch, right),
            FilmClaimKind::Around => around_fit(walk, stretch),
            FilmClaimKind::Climb(climb) => climb_fit(walk, stretch, climb),
            FilmClaimKind::Place { leaves, would_be_named, .. } => {
                let is_decided = would_be_named && walk.places.iter().any(|place| place.knows_things);
                place_fit(sights, stretch, leaves, is_decided)
            }
        }
    }

    /// The same claim with its side turned over; `None` where it is no turn to a side.
    pub(super) fn flipped(&self) -> Option<Self> {
        let FilmClaimKind::Turn { right } = self.kind else { return None };
        Some(Self { kind: FilmClaimKind::Turn { right: !right }, ..self.clone() })
    }
}

/// The hops in which a part on a stretch may turn: those of the stretch, and the one that follows it, because a turn at a place belongs
/// to the part that ends there or to the one that begins there.
fn turn_hops([from, to]: [usize; 2]) -> (usize, usize) {
    (from, to + 1)
}

fn turn_fit(walk: &FilmedWalk, stretch: [usize; 2], right: bool) -> FilmClaimFit {
    let (first, end) = turn_hops(stretch);
    let (largest, is_known) = walk.largest_turns(first, end);
    let (to_side, to_other) = (largest[usize::from(right)], largest[usize::from(!right)]);
    // Nearly around to the other side ends up the same way.
    if to_side >= TURN_RAD || to_other >= std::f64::consts::PI - TURN_RAD {
        FilmClaimFit::Fits
    } else if !is_known {
        FilmClaimFit::Unknown
    } else if to_side >= SLIGHT_RAD {
        FilmClaimFit::Perhaps
    } else if to_other >= TURN_RAD {
        FilmClaimFit::Opposite
    } else {
        FilmClaimFit::Nowhere
    }
}

fn around_fit(walk: &FilmedWalk, stretch: [usize; 2]) -> FilmClaimFit {
    let (first, end) = turn_hops(stretch);
    let (largest, is_known) = walk.largest_turns(first, end);
    if largest[0].max(largest[1]) >= AROUND_RAD {
        FilmClaimFit::Fits
    } else if is_known {
        FilmClaimFit::Nowhere
    } else {
        FilmClaimFit::Unknown
    }
}

fn climb_fit(walk: &FilmedWalk, [from, to]: [usize; 2], climb: ClimbDirection) -> FilmClaimFit {
    let Some(rise) = walk.rise_m(from.saturating_sub(SLACK_PLACES), to + SLACK_PLACES) else {
        return FilmClaimFit::Unknown;
    };
    let rise = if climb == ClimbDirection::Up { rise } else { -rise };
    if rise >= STEPS_M {
        FilmClaimFit::Fits
    } else if rise <= -STEPS_M {
        FilmClaimFit::Opposite
    } else {
        FilmClaimFit::Nowhere
    }
}

/// `is_decided`: whether an eye looked that would have named it.
fn place_fit(sights: &[NameSight], [from, to]: [usize; 2], leaves: bool, is_decided: bool) -> FilmClaimFit {
    let first = from.saturating_sub(SLACK_PLACES);
    let last = (if leaves { from } else { to } + SLACK_PLACES).min(sights.len().saturating_sub(1));
    let here = sights.get(first..=last).unwrap_or_default().iter().max();
    match here.copied().unwrap_or(NameSight::Unseen) {
        NameSight::Seen => FilmClaimFit::Fits,
        NameSight::Perhaps => FilmClaimFit::Perhaps,
        NameSight::Unseen if sights.contains(&NameSight::Seen) => FilmClaimFit::Elsewhere,
        NameSight::Unseen if !is_decided => FilmClaimFit::Unknown,
        NameSight::Unseen => FilmClaimFit::Nowhere,
    }
}
