//! Saves the generated houses of a run as files that AI Habitat reads.

use crate::robustness::base::BaseRun;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path as FilePath, PathBuf},
};
use wayword_house::{generate_house, save_house, seed_of};
use wayword_run::error::CommandError;

/// Saves each house of a run into a folder of its own, unless it is there. Returns the folder that contains them.
///
/// # Errors
/// When a scene is no house, or its files cannot be written.
pub(super) fn save_houses(base: &BaseRun, folder: &FilePath) -> Result<PathBuf, CommandError> {
    let scenes: BTreeSet<&str> = base.paths.iter().map(|path| path.scene.as_str()).collect();
    for scene in scenes {
        let house = folder.join(scene);
        if house.is_dir() {
            continue;
        }
        let seed = seed_of(scene)
            .ok_or_else(|| CommandError::usage(format!("scene {scene} is no generated house"), "name data"))?;
        // A house that was half written when the program was stopped is written again.
        let unfinished = folder.join(format!(".{scene}"));
        let _ = fs::remove_dir_all(&unfinished);
        fs::create_dir_all(&unfinished).map_err(CommandError::io(&unfinished, "make the folder"))?;
        save_house(&generate_house(seed), &unfinished, None)?;
        fs::rename(&unfinished, &house).map_err(CommandError::io(&house, "name the folder"))?;
    }
    Ok(folder.to_owned())
}
