//! The official splits of Matterport3D and HM3D. They are by scene: results on val or test are worthless if a model
//! was trained on their scenes.

use wayword_core::SceneId;

/// Matterport3D's scenes, one a line: the split, and the scene.
const MATTERPORT3D_SCENES: &str = include_str!("matterport3d.txt");
/// Names of splits that are held out for validation; for Matterport3D the field's name is val_unseen.
const VALIDATION_SPLITS: [&str; 4] = ["val_unseen", "val", "validation", "minival"];

/// An official split of scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum OfficialSplit {
    /// For training, and for `val_seen`, which has paths in the scenes of training.
    Train,
    /// Matterport3D's scenes for validation.
    ValUnseen,
    /// HM3D's scenes for validation.
    Val,
    /// For test.
    Test,
}

impl OfficialSplit {
    /// The official split of a scene; `None` where it is neither Matterport3D's nor HM3D's. It goes by the scene's name alone,
    /// because several platforms show the same scenes.
    #[must_use]
    pub fn for_scene(scene: &SceneId) -> Option<Self> {
        matterport3d_split(scene.as_str()).or_else(|| hm3d_split(scene.as_str()))
    }

    /// Its name in the names of files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::ValUnseen => "val_unseen",
            Self::Val => "val",
            Self::Test => "test",
        }
    }

    /// Whether its scenes must not be used for training.
    #[must_use]
    pub fn is_held_out(self) -> bool {
        self != Self::Train
    }

    /// Whether its scenes may be in a split of this name: scenes that are held out are only in splits of their own kind, which
    /// include parts of them (`val_unseen_half1`).
    #[must_use]
    pub fn may_be_in(self, split: &str) -> bool {
        let is_part_of = |whole: &str| split.strip_prefix(whole).is_some_and(|rest| rest.starts_with('_'));
        match self {
            Self::Train => true,
            Self::ValUnseen | Self::Val => VALIDATION_SPLITS.contains(&split) || is_part_of("val_unseen"),
            Self::Test => split == "test" || is_part_of("test"),
        }
    }
}

/// The split of a Matterport3D scene.
fn matterport3d_split(scene: &str) -> Option<OfficialSplit> {
    let mut lines = MATTERPORT3D_SCENES.lines().filter_map(|line| line.split_once(' '));
    let (split, _) = lines.find(|(_, name)| *name == scene)?;
    match split {
        "train" => Some(OfficialSplit::Train),
        "val" => Some(OfficialSplit::ValUnseen),
        "test" => Some(OfficialSplit::Test),
        _ => None,
    }
}

/// HM3D's scenes are numbered: `00800-TEEsavR23oF`. 800 are for training, 100 each for validation and test.
fn hm3d_split(scene: &str) -> Option<OfficialSplit> {
    let (number, name) = scene.split_once('-')?;
    let is_number = number.len() == 5 && number.bytes().all(|byte| byte.is_ascii_digit());
    let is_scene = is_number && name.len() == 11 && name.bytes().all(|byte| byte.is_ascii_alphanumeric());
    match number.parse::<u32>().ok().filter(|_| is_scene)? {
        0..=799 => Some(OfficialSplit::Train),
        800..=899 => Some(OfficialSplit::Val),
        900..=999 => Some(OfficialSplit::Test),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn of(scene: &str) -> Option<OfficialSplit> {
        OfficialSplit::for_scene(&SceneId::new(scene).unwrap())
    }

    #[test]
    fn matterport3d_has_ninety_scenes_in_three_splits() {
        let mut counts: BTreeMap<Option<OfficialSplit>, usize> = BTreeMap::new();
        let scenes = MATTERPORT3D_SCENES.lines().filter(|line| !line.starts_with('#'));
        for line in scenes {
            *counts.entry(of(line.split_once(' ').unwrap().1)).or_default() += 1;
        }
        let (train, val, test) = (OfficialSplit::Train, OfficialSplit::ValUnseen, OfficialSplit::Test);
        assert_eq!(counts, [(Some(train), 61), (Some(val), 11), (Some(test), 18)].into());
        assert_eq!((of("17DRP5sb8fy"), of("2azQ1b91cZZ"), of("2t7WUuJeko7")), (Some(train), Some(val), Some(test)));
    }

    #[test]
    fn hm3d_splits_go_by_scene_numbers() {
        assert_eq!(of("00000-kfPV7w3FaU5"), Some(OfficialSplit::Train));
        assert_eq!(of("00799-kfPV7w3FaU5"), Some(OfficialSplit::Train));
        assert_eq!(of("00800-TEEsavR23oF"), Some(OfficialSplit::Val));
        assert_eq!(of("00900-TEEsavR23oF"), Some(OfficialSplit::Test));
        for other in ["house2-7", "00800", "800-TEEsavR23oF", "01000-TEEsavR23oF", "00800-short", "+0800-TEEsavR23oF"] {
            assert!(!of(other).is_some_and(OfficialSplit::is_held_out), "{other}");
        }
    }

    #[test]
    fn scenes_that_are_held_out_stay_with_their_kind() {
        let (val, test) = (OfficialSplit::ValUnseen, OfficialSplit::Test);
        for (split, in_val, in_test) in [
            ("train", false, false),
            ("val_seen", false, false),
            ("val_train_seen", false, false),
            ("val_unseen", true, false),
            ("val_unseen_half1", true, false),
            ("validation", true, false),
            ("test", false, true),
            ("test_unseen", false, true),
            ("testing", false, false),
        ] {
            assert_eq!((val.may_be_in(split), test.may_be_in(split)), (in_val, in_test), "{split}");
            assert!(OfficialSplit::Train.may_be_in(split));
        }
    }
}
