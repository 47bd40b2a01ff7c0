//! The weights that ship with the program: how much a missing label means for a claim.

use super::claim_sight::{ClaimCase, MissedClaim, class_name};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::LazyLock,
};
use wayword_language::lexicon::{ThingClass, room_name};

/// The file of the weights. Its head names their source and the command that fitted them.
const WEIGHTS_FILE: &str = include_str!("weights.toml");

static SHIPPED_WEIGHTS: LazyLock<SilenceWeights> =
    LazyLock::new(|| SilenceWeights::read_weights(WEIGHTS_FILE).unwrap_or_default());

/// How much a missing label means for a claim.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SilenceWeights {
    /// Rooms by what makes them: fixtures, seats, desks, storing, ways, the open air.
    pub room_groups: BTreeMap<String, BTreeSet<String>>,
    /// For each class of objects, the rooms that list it more often than others.
    pub homes: BTreeMap<String, BTreeSet<String>>,
    /// One table per kind of claim.
    pub cases: BTreeMap<String, WeightTable>,
}

/// The weights of one kind of claim.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WeightTable {
    /// A claim fails where the evidence is likelier by this factor if the claim is wrong than if it is true.
    pub fails_at: f64,
    /// A weight per feature: their sum is the logarithm of that factor.
    pub weights: BTreeMap<String, f64>,
}

impl SilenceWeights {
    /// The weights that ship.
    #[must_use]
    pub fn shipped() -> &'static Self {
        &SHIPPED_WEIGHTS
    }

    /// Reads a file of weights.
    ///
    /// # Errors
    /// When its form is wrong.
    pub fn read_weights(file: &str) -> Result<Self, toml::de::Error> {
        toml::from_str(file)
    }

    /// The rooms that list a class more often than others do; `None` where the class has none.
    #[must_use]
    pub fn homes_of(&self, class: ThingClass) -> Option<&BTreeSet<String>> {
        self.homes.get(&class_name(class))
    }

    /// The group of a room; "other" where it has none.
    #[must_use]
    pub fn room_group(&self, room: &str) -> &str {
        let named = room_name(room).unwrap_or(room);
        let group = self.room_groups.iter().find(|(_, rooms)| rooms.contains(named));
        group.map_or("other", |(group, _)| group)
    }

    /// The logarithm of how much likelier the evidence is if the claim is wrong than if it is true; `None` where there
    /// is no table for claims of this kind.
    #[must_use]
    pub fn log_ratio(&self, missed: &MissedClaim) -> Option<f64> {
        let table = self.table_for(missed.case)?;
        let weight = |(name, value): &(String, f64)| table.weights.get(name).map_or(0.0, |weight| weight * value);
        Some(missed.features.iter().map(weight).sum())
    }

    /// The table of a kind of claim.
    #[must_use]
    pub fn table_for(&self, case: ClaimCase) -> Option<&WeightTable> {
        self.cases.get(case.name())
    }
}
