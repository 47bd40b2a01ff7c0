//! Selects the generated houses that a stand-in shows, and pairs them with the simulator's scene names.

use std::{collections::BTreeSet, fmt};
use thiserror::Error;
use wayword_house::{generate_house, scene_name};

/// Generated houses with one storey, in the order in which a stand-in shows them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StandInHouses(Vec<u64>);

/// Why houses cannot be shown.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum NotShown {
    /// There is no house to show.
    #[error("there is no house to show: name at least one by its seed")]
    None,
    /// A house is named twice.
    #[error("house {0} is named twice: leave one out")]
    Twice(u64),
    /// A house has more than one storey.
    #[error("house {0} has two storeys, and the simulators' homes have one: leave it out")]
    TwoStoreys(u64),
    /// The simulator has fewer scenes than there are houses.
    #[error("{houses} houses are too many: the simulator has {scenes} scenes")]
    TooMany {
        /// How many houses there are.
        houses: usize,
        /// How many scenes the simulator has.
        scenes: usize,
    },
}

/// A house, and the name of the scene under which a stand-in shows it: `house2-4=home_0`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShownAs {
    /// Seed of the house.
    pub seed: u64,
    /// Name of the simulator's scene.
    pub scene: String,
}

impl fmt::Display for ShownAs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", scene_name(self.seed), self.scene)
    }
}

/// Whether the generated house of a seed has one storey.
fn has_one_storey(seed: &u64) -> bool {
    generate_house(*seed).storeys == 1
}

impl StandInHouses {
    /// The houses of these seeds.
    ///
    /// # Errors
    /// When the list is empty, names a house twice, or contains a house with several storeys: VirtualHome's homes and
    /// ThreeDWorld's floor plans have no stairs.
    pub fn from_seeds(seeds: Vec<u64>) -> Result<Self, NotShown> {
        let mut named_seeds = BTreeSet::new();
        if let Some(seed) = seeds.iter().find(|seed| !named_seeds.insert(**seed)) {
            return Err(NotShown::Twice(*seed));
        }
        if let Some(seed) = seeds.iter().find(|seed| !has_one_storey(seed)) {
            return Err(NotShown::TwoStoreys(*seed));
        }
        if seeds.is_empty() { Err(NotShown::None) } else { Ok(Self(seeds)) }
    }

    /// The first houses with one storey from a seed on.
    #[must_use]
    pub fn with_one_storey(from: u64, count: usize) -> Self {
        Self((from..).filter(has_one_storey).take(count.max(1)).collect())
    }

    /// Their seeds.
    #[must_use]
    pub fn seeds(&self) -> &[u64] {
        &self.0
    }

    /// Each house with its scene, where a simulator has these scenes.
    ///
    /// # Errors
    /// When it has fewer scenes than there are houses.
    pub fn shown_as(&self, scenes: Vec<String>) -> Result<Vec<ShownAs>, NotShown> {
        if scenes.len() < self.0.len() {
            return Err(NotShown::TooMany { houses: self.0.len(), scenes: scenes.len() });
        }
        Ok(self.0.iter().zip(scenes).map(|(seed, scene)| ShownAs { seed: *seed, scene }).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn houses_with_stairs_are_refused_and_others_have_scenes_in_order() {
        let seeds = StandInHouses::with_one_storey(0, 2).seeds().to_vec();
        assert!(seeds.iter().all(has_one_storey) && seeds.len() == 2);
        let tall = (0..).find(|seed| !has_one_storey(seed)).unwrap();
        assert_eq!(StandInHouses::from_seeds(vec![seeds[0], tall]), Err(NotShown::TwoStoreys(tall)));
        assert_eq!(StandInHouses::from_seeds(vec![seeds[0]; 2]), Err(NotShown::Twice(seeds[0])));
        assert_eq!(StandInHouses::from_seeds(Vec::new()), Err(NotShown::None));
        let houses = StandInHouses::from_seeds(seeds.clone()).unwrap();
        let scenes = |count: usize| (0..count).map(|n| format!("home_{n}")).collect();
        let shown: Vec<String> = houses.shown_as(scenes(3)).unwrap().iter().map(ToString::to_string).collect();
        assert_eq!(shown, [format!("house2-{}=home_0", seeds[0]), format!("house2-{}=home_1", seeds[1])]);
        assert_eq!(houses.shown_as(scenes(1)), Err(NotShown::TooMany { houses: 2, scenes: 1 }));
    }
}
