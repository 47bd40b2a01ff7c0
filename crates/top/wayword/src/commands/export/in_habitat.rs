//! What VLN-CE is told of a run's world: the scene's file, the corners of the way, the distance over the navmesh.

use crate::{error::Error, run::settings_of, world};
use std::path::{Path, PathBuf};
use wayword_core::{DVec3, Path as Walk, Platform, SceneId};
use wayword_formats::{Episode, InHabitat, jsonl::Record};

/// Where habitat-lab keeps scenes: `scene_id` counts from there.
const SCENES: &str = "scene_datasets";
/// Corners that lie nearer to one another than this are one, metres.
const SAME_M: f64 = 1e-3;

/// The world that a run was made in, as far as Habitat knows it.
pub(super) struct World {
    /// Habitat's own scenes, with the folder or file that they come from.
    scenes: Option<(Box<dyn Platform>, PathBuf)>,
}

impl World {
    /// The world of a run's records.
    ///
    /// # Errors
    /// When the records are from Habitat's scenes, and these cannot be opened.
    pub(super) fn of(run: &Path, records: &[Record]) -> Result<Self, Error> {
        if !records.iter().any(|record| record.platform == "habitat") {
            return Ok(Self { scenes: None });
        }
        let settings = settings_of(run)?;
        let data = settings.data.clone().unwrap_or_default();
        Ok(Self { scenes: Some((world::open(&settings)?, data)) })
    }

    /// Tells an episode what Habitat needs of its world.
    ///
    /// # Errors
    /// When the scene cannot be read.
    pub(super) fn tell(&self, record: &Record, episode: &mut Episode) -> Result<(), Error> {
        let scene = &record.path.scene;
        match (&self.scenes, record.platform.as_str()) {
            (Some((platform, data)), "habitat") => {
                let file = platform.scene_file(scene)?;
                episode.in_habitat.scene_id = file.map(|file| below_scenes(&file, data));
                walk_around_corners(&**platform, &record.path, episode)?;
            }
            (_, "matterport") => {}
            (_, "house") => episode.in_habitat = house(scene),
            (_, other) => episode.in_habitat = unknown(other, scene),
        }
        Ok(())
    }
}

/// A scene's file as `scene_id` has it: below habitat-lab's folder of scenes where it lies in one, else below the run's data.
fn below_scenes(file: &Path, data: &Path) -> String {
    let parts: Vec<_> = file.iter().map(|part| part.to_string_lossy()).collect();
    let below = match parts.iter().rposition(|part| part == SCENES) {
        Some(at) => &parts[at + 1..],
        None => {
            let above = if data.is_dir() { data.iter().count() } else { parts.len().saturating_sub(1) };
            &parts[above.min(parts.len())..]
        }
    };
    below.join("/")
}

/// A generated house, which Habitat can draw once it is saved.
fn house(scene: &SceneId) -> InHabitat {
    let seed = scene.as_str().strip_prefix("house-").unwrap_or_default();
    InHabitat {
        scene_id: Some(format!("house/{scene}/{scene}.glb")),
        scene_needs: Some(format!("save the house: wayword house --seed {seed} --out SCENES/house/{scene}")),
        geodesic_m: None,
    }
}

/// A world of which Habitat has no scene.
fn unknown(platform: &str, scene: &SceneId) -> InHabitat {
    let scene_id = format!("{platform}/{scene}/{scene}.glb");
    let needs = format!("put a scene of yours at SCENES/{scene_id}: platform {platform} gives none that Habitat reads");
    InHabitat { scene_id: Some(scene_id), scene_needs: Some(needs), geodesic_m: None }
}

/// Puts every corner of the way between two frames into the path, so that each hop is a straight walk, and the distance from start
/// to goal over the navmesh beside it.
fn walk_around_corners(platform: &dyn Platform, walk: &Walk, episode: &mut Episode) -> Result<(), Error> {
    let floors = std::mem::take(&mut episode.floor_positions);
    let mut path: Vec<DVec3> = floors.first().copied().into_iter().collect();
    for (frames, floor) in walk.frames.windows(2).zip(floors.iter().skip(1)) {
        let way = platform.way(&walk.scene, &frames[0], &frames[1])?;
        let corners = way.as_ref().map_or(&[][..], |way| &way.corners);
        for corner in corners.iter().skip(1).rev().skip(1).rev() {
            let is_new = path.last().is_none_or(|last| last.distance(*corner) > SAME_M);
            if is_new && corner.distance(*floor) > SAME_M {
                path.push(*corner);
            }
        }
        path.push(*floor);
    }
    episode.floor_positions = path;
    if let (Some(first), Some(last)) = (walk.frames.first(), walk.frames.last()) {
        episode.in_habitat.geodesic_m = platform.way(&walk.scene, first, last)?.map(|way| way.length_m);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_named_below_the_folder_of_scenes() {
        let folder = tempfile::tempdir().unwrap();
        let hm3d = Path::new("/x/scene_datasets/hm3d/val/00800-a/a.basis.glb");
        assert_eq!(below_scenes(hm3d, Path::new("/x/scene_datasets/hm3d")), "hm3d/val/00800-a/a.basis.glb");
        let own = folder.path().join("flats/flat.glb");
        assert_eq!(below_scenes(&own, folder.path()), "flats/flat.glb");
        assert_eq!(below_scenes(&own, &own), "flat.glb");
    }
}
