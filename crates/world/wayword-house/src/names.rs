//! The names of houses: `house2-7` is the house of seed 7, as the second version of the generator makes it.
//!
//! The house of a seed changes only together with the version in the name. So an old run never continues in a house with
//! other walls.

/// Before the seed: the name of the platform, and the version of the generator.
const SCENE_PREFIX: &str = "house2-";
/// The prefix of earlier versions; this version cannot make their houses.
const OLD_PREFIX: &str = "house-";

/// The name of the house of a seed, as a scene and as the stem of its files.
#[must_use]
pub fn scene_name(seed: u64) -> String {
    format!("{SCENE_PREFIX}{seed}")
}

/// The seed in a scene's name, if the name is written exactly as [`scene_name`] writes it.
#[must_use]
pub fn seed_of(scene: &str) -> Option<u64> {
    seed_after(SCENE_PREFIX, scene)
}

/// The seed in a name that an earlier version gave.
pub(super) fn old_seed_of(scene: &str) -> Option<u64> {
    seed_after(OLD_PREFIX, scene)
}

fn seed_after(prefix: &str, scene: &str) -> Option<u64> {
    let digits = scene.strip_prefix(prefix)?;
    let seed: u64 = digits.parse().ok()?;
    (seed.to_string() == digits).then_some(seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scene_names_contain_seed_and_version() {
        assert_eq!(seed_of(&scene_name(u64::MAX)), Some(u64::MAX));
        assert_eq!((seed_of("house2-07"), seed_of("house-7"), seed_of("house2-")), (None, None, None));
        assert_eq!((old_seed_of("house-7"), old_seed_of("house2-7")), (Some(7), None));
    }
}
