//! Whether the evidence shows a claimed place, and if not, the features by which its absence is weighed.

use wayword_language::lexicon::ThingClass;

/// The state of a claimed place in the evidence.
#[derive(Debug, Clone, PartialEq)]
pub enum ClaimSight {
    /// It is there.
    Shown,
    /// The evidence cannot decide.
    Unknown,
    /// It is not listed within reach. The weights decide how much that means.
    Missed(MissedClaim),
}

/// A claimed place that is not listed within reach.
#[derive(Debug, Clone, PartialEq)]
pub struct MissedClaim {
    /// Which table of weights applies to it.
    pub case: ClaimCase,
    /// Features by name.
    pub features: Vec<(String, f64)>,
    /// The distance to the nearest listed place of its name, metres; infinite where the building lists none.
    pub nearest_m: f64,
}

/// The kinds of claims that have a table of weights each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ClaimCase {
    /// An object along the path.
    Thing,
    /// An object at which the walker stops.
    ThingAtStop,
    /// A room along the path, which the building has elsewhere.
    Room,
    /// A room in which or at which the walker stops, which the building has elsewhere.
    RoomAtStop,
    /// A room that the building lacks.
    RoomLacking,
}

impl ClaimCase {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Thing, Self::ThingAtStop, Self::Room, Self::RoomAtStop, Self::RoomLacking];

    /// Its name in the file of weights.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Thing => "thing",
            Self::ThingAtStop => "thing_at_stop",
            Self::Room => "room",
            Self::RoomAtStop => "room_at_stop",
            Self::RoomLacking => "room_lacking",
        }
    }
}

/// The claim of an object along the path cannot fail if one of its name is listed nearer than this, metres: it may be
/// in sight.
const SEEN_M: f64 = 8.0;

impl MissedClaim {
    /// Whether the claim can fail at all. People name objects that they see across a room or through a door.
    #[must_use]
    pub fn can_fail(&self) -> bool {
        self.case != ClaimCase::Thing || self.nearest_m >= SEEN_M
    }

    /// Adds how the evidence treats the other places that the text claims: where the labels have those, they are
    /// good enough to miss this one too.
    pub fn add_company_features<'a>(&mut self, others: impl Iterator<Item = &'a ClaimSight>) {
        let (mut shown, mut missed) = (0.0, 0.0);
        for other in others {
            match other {
                ClaimSight::Shown => shown += 1.0,
                ClaimSight::Unknown => {}
                ClaimSight::Missed(_) => missed += 1.0,
            }
        }
        self.features.push(("others shown".into(), f64::ln_1p(shown)));
        self.features.push(("others missed".into(), f64::ln_1p(missed)));
    }
}

/// A class's name in the file of weights.
#[must_use]
pub fn class_name(class: ThingClass) -> String {
    format!("{class:?}").to_lowercase()
}
