//! Adds the data to VLN-CE episodes that the simulator Habitat needs: the scene's file, the corners of the path, and the distance
//! over the navmesh. A VLN-CE path consists of straight lines, but the way between two frames can bend around furniture: hence the
//! corners. In Habitat's scenes and in generated houses all positions have the navmesh's height, which is 0.1 to 0.2 m above the
//! drawn floor, because Habitat's agents walk at that height.

#[cfg(feature = "habitat")]
use crate::walking::WalkingScenes;
use std::path::{Path, PathBuf};
use wayword_core::{DVec3, GroundRoute, Path as Walk, Platform, PlatformError, SceneId};
use wayword_formats::{Episode, InHabitat, jsonl::InstructionRecord};
#[cfg(feature = "habitat")]
use wayword_habitat::NavMeshGround;
use wayword_house::seed_of;
use wayword_run::{error::CommandError, platforms, run_folder::read_run_settings, stores};

/// The folder in which habitat-lab keeps scenes; a `scene_id` is a path below it.
const SCENES_FOLDER: &str = "scene_datasets";
/// Corners closer together than this count as one, metres.
const SAME_CORNER_M: f64 = 1e-3;
/// Greatest distance of a position from the navmesh, seen from above, metres.
#[cfg(feature = "habitat")]
const MAX_BESIDE_NAVMESH_M: f64 = 0.5;

/// The generated houses, with their navmeshes where this build can bake them.
#[cfg(feature = "habitat")]
type HouseScenes = WalkingScenes;
#[cfg(not(feature = "habitat"))]
type HouseScenes = Box<dyn Platform>;

/// Where the scenes of a run can be looked up: its Habitat scenes and its generated houses.
pub(super) struct HabitatSceneSource {
    /// Habitat's own scenes, with the folder or file that they come from.
    scenes: Option<(Box<dyn Platform>, PathBuf)>,
    /// The generated houses, if the run has any.
    houses: Option<HouseScenes>,
    /// Why the first Habitat scene that failed could not be read.
    first_problem: Option<String>,
}

impl HabitatSceneSource {
    /// Opens the platforms of a run's records. If its Habitat scenes cannot be opened, they stay closed, and `warning` reports it.
    pub(super) fn from_run(run: &Path, records: &[InstructionRecord]) -> Self {
        let has = |platform: &str| records.iter().any(|record| record.platform == platform);
        let houses = has("house").then(open_houses).flatten();
        match has("habitat").then(|| open_scenes(run)).transpose() {
            Ok(scenes) => Self { scenes, houses, first_problem: None },
            Err(error) => Self { scenes: None, houses, first_problem: Some(first_line(&error)) },
        }
    }

    /// Adds the scene's file, the corners and the distance to an episode, as far as they are known.
    pub(super) fn describe_scene(&mut self, record: &InstructionRecord, episode: &mut Episode) {
        let scene = &record.path.scene;
        match (record.platform.as_str(), &self.scenes) {
            ("habitat", Some((platform, data))) => {
                if let Err(error) = add_scene_fields(&**platform, data, &record.path, episode) {
                    self.first_problem.get_or_insert_with(|| first_line(&error));
                    episode.in_habitat = without_scene(scene);
                }
            }
            ("habitat", None) => episode.in_habitat = without_scene(scene),
            ("matterport", _) => {}
            ("house", _) => {
                episode.in_habitat = in_generated_house(scene);
                if let Some(houses) = &self.houses {
                    lay_in_house(houses, &record.path, episode);
                }
            }
            (other, _) => episode.in_habitat = in_foreign_scene(other, scene),
        }
    }

    /// The warning if Habitat scenes could not be opened.
    pub(super) fn lack_warning(&self) -> Option<String> {
        let warning = |lack: &String| {
            format!(
                "warning: the Habitat scenes cannot be opened ({lack}), so the path corners and distances in their episodes \
                 come from the frames, not from the navmesh; make the scenes available and export again"
            )
        };
        self.first_problem.as_ref().map(warning)
    }
}

/// The scenes that a run was made in, and where they come from.
fn open_scenes(run: &Path) -> Result<(Box<dyn Platform>, PathBuf), CommandError> {
    let settings = read_run_settings(run)?;
    let platform = platforms::open_platform(&settings)?;
    let data = settings.data.as_deref().map(stores::local_data).transpose()?.unwrap_or_default().into_owned();
    Ok((platform, data))
}

/// The first line of an error, without its hint, because a warning has one line.
fn first_line(error: &impl ToString) -> String {
    error.to_string().lines().next().unwrap_or_default().to_owned()
}

/// Adds file, corners and distance of a Habitat scene to an episode. On an error the positions on the floor are unchanged.
fn add_scene_fields(
    platform: &dyn Platform,
    data: &Path,
    walk: &Walk,
    episode: &mut Episode,
) -> Result<(), PlatformError> {
    let file = platform.files().scene_file(&walk.scene)?;
    let path = path_with_corners(platform, walk, episode)?;
    episode.in_habitat.geodesic_m = geodesic_m(platform, walk)?;
    episode.floor_positions = path;
    episode.in_habitat.scene_id = file.map(|file| below_scenes(&file, data));
    Ok(())
}

/// A scene's file as `scene_id` names it: below habitat-lab's folder of scenes if it is in one, else below the run's
/// data.
fn below_scenes(file: &Path, data: &Path) -> String {
    let parts: Vec<_> = file.iter().map(|part| part.to_string_lossy()).collect();
    let below = match parts.iter().rposition(|part| part == SCENES_FOLDER) {
        Some(at) => &parts[at + 1..],
        None => {
            let skipped = if data.is_dir() { data.iter().count() } else { parts.len().saturating_sub(1) };
            &parts[skipped.min(parts.len())..]
        }
    };
    below.join("/")
}

/// The fields for a generated house. Habitat can load it once the user has saved it.
fn in_generated_house(scene: &SceneId) -> InHabitat {
    let seed = seed_of(scene.as_str()).unwrap_or_default();
    InHabitat {
        scene_id: Some(format!("house/{scene}/{scene}.glb")),
        scene_needs: Some(format!("save the house: wayword house --seed {seed} --paths 0 --out SCENES/house")),
        geodesic_m: None,
    }
}

/// The fields for a Habitat scene without a file that can be found.
fn without_scene(scene: &SceneId) -> InHabitat {
    let scene_id = format!("habitat/{scene}/{scene}.glb");
    let needs = format!("put the scene's file at SCENES/{scene_id}, or export on a machine that has the run's scenes");
    InHabitat { scene_id: Some(scene_id), scene_needs: Some(needs), geodesic_m: None }
}

/// The fields for a platform with scenes that Habitat cannot read.
fn in_foreign_scene(platform: &str, scene: &SceneId) -> InHabitat {
    let scene_id = format!("{platform}/{scene}/{scene}.glb");
    let needs =
        format!("put your own scene at SCENES/{scene_id}, because platform {platform} has none that Habitat can read");
    InHabitat { scene_id: Some(scene_id), scene_needs: Some(needs), geodesic_m: None }
}

/// The generated houses for the paths of a run.
#[cfg(feature = "habitat")]
fn open_houses() -> Option<HouseScenes> {
    // No picture is taken.
    Some(WalkingScenes::generated_houses([16, 16]))
}

#[cfg(not(feature = "habitat"))]
fn open_houses() -> Option<HouseScenes> {
    platforms::open_named("house", None, None, None).ok()
}

/// Lays an episode on the ground of its house, as far as that is known.
#[cfg(feature = "habitat")]
fn lay_in_house(houses: &HouseScenes, walk: &Walk, episode: &mut Episode) {
    if let Ok(ground) = houses.ground(&walk.scene) {
        lay_on_navmesh(&ground, episode);
    }
}

#[cfg(not(feature = "habitat"))]
fn lay_in_house(houses: &HouseScenes, walk: &Walk, episode: &mut Episode) {
    if let Ok(path) = path_with_corners(&**houses, walk, episode) {
        episode.floor_positions = path;
    }
}

/// Lays an episode's path on a navmesh, where Habitat's agents walk: every position at its height, with the corners of the way
/// between two positions, and the distance from start to goal over it. An episode with a position beside the navmesh stays as it
/// is.
#[cfg(feature = "habitat")]
pub fn lay_on_navmesh(ground: &NavMeshGround, episode: &mut Episode) {
    let on_navmesh = |floor: &DVec3| {
        let place = ground.nearest_foothold(*floor)?.place;
        ((place - *floor).truncate().length() <= MAX_BESIDE_NAVMESH_M).then_some(place)
    };
    let Some(places) = episode.floor_positions.iter().map(on_navmesh).collect::<Option<Vec<_>>>() else { return };
    let (Some(start), Some(goal)) = (places.first(), places.last()) else { return };
    let path = join_by_corners(&places, |hop| ground.geodesic(places[hop], places[hop + 1]).map(Some));
    if let (Ok(path), Ok(way)) = (path, ground.geodesic(*start, *goal)) {
        episode.floor_positions = path;
        episode.in_habitat.geodesic_m = Some(way.length_m);
    }
}

/// The path of an episode with every corner of the way between two frames, so that each hop is a straight walk. It is
/// as before if the platform knows no ways.
fn path_with_corners(platform: &dyn Platform, walk: &Walk, episode: &Episode) -> Result<Vec<DVec3>, PlatformError> {
    let frames = &walk.frames;
    join_by_corners(&episode.floor_positions, |hop| match (frames.get(hop), frames.get(hop + 1)) {
        (Some(from), Some(to)) => platform.ground().ground_route(&walk.scene, from, to),
        _ => Ok(None),
    })
}

/// The places with the corners of the way from each to the next. `way` gives the way of a hop by its number, from 0.
fn join_by_corners<E>(
    places: &[DVec3],
    way: impl Fn(usize) -> Result<Option<GroundRoute>, E>,
) -> Result<Vec<DVec3>, E> {
    let mut path: Vec<DVec3> = places.first().copied().into_iter().collect();
    for (hop, place) in places.iter().skip(1).enumerate() {
        let route = way(hop)?;
        let corners = route.as_ref().map_or(&[][..], |route| &route.corners);
        // The first and the last corner are the two places themselves.
        for corner in corners.iter().skip(1).rev().skip(1).rev() {
            let is_new = path.last().is_none_or(|last| last.distance(*corner) > SAME_CORNER_M);
            if is_new && corner.distance(*place) > SAME_CORNER_M {
                path.push(*corner);
            }
        }
        path.push(*place);
    }
    Ok(path)
}

/// The distance from start to goal over the navmesh, metres; `None` if the platform knows no ways.
fn geodesic_m(platform: &dyn Platform, walk: &Walk) -> Result<Option<f64>, PlatformError> {
    let (Some(first), Some(last)) = (walk.frames.first(), walk.frames.last()) else { return Ok(None) };
    Ok(platform.ground().ground_route(&walk.scene, first, last)?.map(|way| way.length_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn below_scenes_strips_the_folder_of_scenes() {
        let folder = tempfile::tempdir().unwrap();
        let hm3d = Path::new("/x/scene_datasets/hm3d/val/00800-a/a.basis.glb");
        assert_eq!(below_scenes(hm3d, Path::new("/x/scene_datasets/hm3d")), "hm3d/val/00800-a/a.basis.glb");
        let own = folder.path().join("flats/flat.glb");
        assert_eq!(below_scenes(&own, folder.path()), "flats/flat.glb");
        assert_eq!(below_scenes(&own, &own), "flat.glb");
    }
}
